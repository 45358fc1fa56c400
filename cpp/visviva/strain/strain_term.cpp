#include "visviva/strain/strain_term.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "visviva/strain/strain_dispatch.hpp"

namespace visviva {

namespace {

constexpr int pad = 8;  // widest lane count: every array can be read by whole vectors of any kernel
int padded(int n) { return (n + pad - 1) / pad * pad; }

// Copy [rows][n] to [rows][stride]; the last element fills the padding, so that laws see sane numbers there.
template <class To, class From>
void pad_rows(To& to, const From* from, int rows, int n, int stride) {
    to.resize(static_cast<std::size_t>(rows) * stride);
    for (int k = 0; k < rows; ++k)
        for (int e = 0; e < stride; ++e)
            to[static_cast<std::size_t>(k) * stride + e] = from[k * n + std::min(e, n - 1)];
}

// Strains that the law's D couples to strain i.
bool coupled(const StrainShape& s) {
    return s.law != LawKind::linear && s.law != LawKind::constraint && s.law != LawKind::servo &&
           s.law != LawKind::load;
}

bool column_couples(const StrainShape& s, int e, int m) {
    if (s.law == LawKind::constraint) return e == m;
    if (s.law == LawKind::servo) return e == s.n_m + m;
    return true;
}
bool row_couples(const StrainShape& s, int e, int m) {
    if (s.law == LawKind::constraint || s.law == LawKind::servo) return e == m;
    return true;
}

ShapeView view_of(const StrainShape& s) {
    return {s.n_x,
            s.n_y,
            s.n_e,
            s.n_m,
            s.law,
            static_cast<int>(s.form_row.size()),
            static_cast<int>(s.quad_e.size()),
            static_cast<int>(s.lin_e.size()),
            s.form_row.data(),
            s.form_col.data(),
            s.quad_e.data(),
            s.quad_a.data(),
            s.quad_b.data(),
            s.lin_e.data(),
            s.lin_a.data(),
            s.quad_coef.data(),
            s.lin_coef.data()};
}

std::vector<std::set<int>> supports(const StrainShape& s) {
    std::vector<std::set<int>> support(s.n_e);
    for (std::size_t k = 0; k < s.quad_e.size(); ++k) {
        support[s.quad_e[k]].insert(s.quad_a[k]);
        support[s.quad_e[k]].insert(s.quad_b[k]);
    }
    for (std::size_t k = 0; k < s.lin_e.size(); ++k) support[s.lin_e[k]].insert(s.lin_a[k]);
    return support;
}

// (a, b) entries of Ky that can be nonzero.
std::set<std::pair<int, int>> form_pairs(const StrainShape& s) {
    std::set<std::pair<int, int>> pairs;
    for (std::size_t k = 0; k < s.quad_e.size(); ++k) {
        pairs.insert({s.quad_a[k], s.quad_b[k]});
        pairs.insert({s.quad_b[k], s.quad_a[k]});
    }
    if (!coupled(s)) return pairs;
    const auto support = supports(s);
    for (int i = 0; i < s.n_e; ++i)
        for (int j = 0; j < s.n_e; ++j)
            for (int a : support[i])
                for (int b : support[j]) pairs.insert({a, b});
    return pairs;
}

}  // namespace

StrainTerm::StrainTerm(StrainShape shape, int n, const int* index, const double* weight,
                       const double* y_const, const double* e_const, const double* par, int n_par,
                       const int* signal)
    : shape_(std::move(shape)) {
    needs_rates = traits(shape_.law).needs_rate;
    const StrainShape& s = shape_;
    const int stride = padded(n);
    auto zeros = [stride](Aligned<double>& a, int rows) {
        a.assign(static_cast<std::size_t>(rows) * stride, 0.0);
    };
    pad_rows(index_, index, s.n_local(), n, stride);
    pad_rows(weight_, weight, static_cast<int>(s.form_row.size()), n, stride);
    pad_rows(y_const_, y_const, s.n_y, n, stride);
    pad_rows(e_const_, e_const, s.n_e, n, stride);
    pad_rows(par_, par, n_par, n, stride);
    pad_rows(signal_, signal, std::max(s.n_m, 1), n, stride);
    zeros(y0_, s.n_y), zeros(e0_, s.n_e), zeros(out_, 4);
    if (traits(s.law).is_callback) {
        zeros(e_eval_, s.n_e), zeros(e_rate_, s.n_e), zeros(e1_, s.n_e), zeros(lambda_, s.n_m);
        zeros(cb_S_, s.n_e), zeros(cb_D_, s.n_e * s.n_e), zeros(cb_R_, s.n_e * s.n_e), zeros(cb_W_, 1);
        zeros(cb_Phi_, s.n_m), zeros(cb_J_, s.n_m * s.n_e), zeros(cb_Jt_, s.n_m * s.n_e);
    }
    const int work = 4 * s.n_y + 5 * s.n_e + 2 * s.n_m + 2 * s.n_e * s.n_e + 2 * s.n_m * s.n_e +
                     4 * s.n_e * s.n_y + s.n_y * s.n_y;
    scratch_.assign(static_cast<std::size_t>(work) * pad, 0.0);

    StrainView& v = view_;
    v.shape = view_of(s), v.n = n, v.stride = stride;
    v.index = index_.data(), v.weight = weight_.data(), v.y_const = y_const_.data();
    v.e_const = e_const_.data(), v.par = par_.data(), v.signal = signal_.data();
    v.y0 = y0_.data(), v.e0 = e0_.data(), v.e_eval = e_eval_.data(), v.e_rate = e_rate_.data();
    v.e1 = e1_.data(), v.scratch = scratch_.data();
    v.cb_S = cb_S_.data(), v.cb_D = cb_D_.data(), v.cb_R = cb_R_.data(), v.cb_Phi = cb_Phi_.data();
    v.cb_J = cb_J_.data(), v.cb_Jt = cb_Jt_.data(), v.cb_W = cb_W_.data();
    make_program();
}

// Expand B^T Ky B and the multiplier borders into flat lists over the structurally nonzero entries. Entries
// across the diagonal are summed in the same order, so that what cancels leaves the same rounding in both.
void StrainTerm::make_program() {
    const StrainShape& s = shape_;
    std::vector<std::vector<int>> entries(s.n_y);  // of B, by form
    for (std::size_t k = 0; k < s.form_row.size(); ++k) entries[s.form_row[k]].push_back(static_cast<int>(k));

    std::map<std::pair<int, int>, std::vector<Product>> blocks;
    int pair = 0;
    for (auto [a, b] : form_pairs(s)) {
        pairs_.insert(pairs_.end(), {a, b});
        for (int k1 : entries[a])
            for (int k2 : entries[b]) blocks[{s.form_col[k1], s.form_col[k2]}].push_back({0, k1, pair, k2});
        ++pair;
    }
    for (auto& [local, products] : blocks) {
        std::stable_sort(products.begin(), products.end(), [](const Product& p, const Product& q) {
            return std::minmax(p.k1, p.k2) < std::minmax(q.k1, q.k2);
        });
        for (Product& p : products) {
            p.slot = static_cast<int>(slots_.size());
            products_.push_back(p);
        }
        slots_.push_back(local);
    }
    const auto support = supports(s);
    std::map<std::pair<int, int>, int> border_slot;
    auto slot_of = [&](int row, int col) {
        auto [it, fresh] = border_slot.try_emplace({row, col}, static_cast<int>(slots_.size()));
        if (fresh) slots_.push_back({row, col});
        return it->second;
    };
    for (int m = 0; m < s.n_m; ++m)
        for (int e = 0; e < s.n_e; ++e)
            for (int a : support[e])
                for (int k : entries[a]) {
                    const int x = s.form_col[k], l = s.n_x + m;
                    if (column_couples(s, e, m)) columns_.push_back({slot_of(x, l), k, e, a, m});
                    if (row_couples(s, e, m)) rows_.push_back({slot_of(l, x), k, e, a, m});
                }
    StrainView& v = view_;
    v.n_pairs = pair, v.n_slots = static_cast<int>(slots_.size());
    v.n_products = static_cast<int>(products_.size());
    v.n_columns = static_cast<int>(columns_.size()), v.n_rows = static_cast<int>(rows_.size());
    v.pairs = pairs_.data(), v.products = products_.data();
    v.columns = columns_.data(), v.rows = rows_.data();
}

void StrainTerm::list_entries(std::vector<std::pair<int, int>>& entries) const {
    for (auto [row, col] : slots_)
        for (int e = 0; e < view_.n; ++e)
            entries.push_back({index_[static_cast<std::size_t>(row) * view_.stride + e],
                               index_[static_cast<std::size_t>(col) * view_.stride + e]});
}

void StrainTerm::set_positions(const std::vector<std::int64_t>& positions) {
    pad_rows(position_, positions.data(), static_cast<int>(slots_.size()), view_.n, view_.stride);
    view_.position = position_.data();
}

// An angle is one of its direction (e0, e1) only up to half turns, and Newton's method may have found
// another: one that is opposite, or that went on by more than half a turn, which no step resolves.
Refusal StrainTerm::refuse(const Context& c) {
    if (shape_.law != LawKind::angle) return {};
    constexpr double pi = 3.141592653589793;
    Aligned<double> y1(y0_.size()), e1(e0_.size());
    StrainView end = view_;
    end.y0 = y1.data(), end.e0 = e1.data();
    strain_kernels().begin(end, c.vectors.x1);
    const auto row = [&](int k) { return e1.data() + static_cast<std::size_t>(k) * view_.stride; };
    for (int i = 0; i < view_.n; ++i) {
        const double angle = row(2)[i], turned = angle - e0_[static_cast<std::size_t>(2) * view_.stride + i];
        if (std::cos(angle) * row(0)[i] + std::sin(angle) * row(1)[i] > 0 && std::abs(turned) < pi) continue;
        const int unknown = index_[static_cast<std::size_t>(shape_.n_x) * view_.stride + i];
        return {unknown, "the step turns a joint by so much that its angle is no longer known"};
    }
    return {};
}

void StrainTerm::begin(const double* x0) { strain_kernels().begin(view_, x0); }

void StrainTerm::call_back(const Context& c, bool want_tangent) {
    if (!callback_) return;
    strain_kernels().strains(view_, c.step, c.vectors);
    for (int m = 0; m < shape_.n_m; ++m)
        for (int e = 0; e < view_.stride; ++e) {
            const std::size_t k = static_cast<std::size_t>(m) * view_.stride + e;
            lambda_[k] = c.vectors.x1[index_[static_cast<std::size_t>(shape_.n_x + m) * view_.stride + e]];
        }
    callback_({view_.n,        view_.stride,   shape_.n_e,     shape_.n_m,    want_tangent,
               c.step.te,      c.step.h,       c.step.stress,  e0_.data(),    e1_.data(),
               e_eval_.data(), e_rate_.data(), lambda_.data(), cb_S_.data(),  cb_D_.data(),
               cb_R_.data(),   cb_Phi_.data(), cb_J_.data(),   cb_Jt_.data(), cb_W_.data()});
}

void StrainTerm::residual(const Context& c, double* r) {
    call_back(c, false);
    strain_kernels().residual(view_, c.step, c.vectors, c.signals, r);
}

void StrainTerm::tangent(const Context& c, double* values) {
    call_back(c, true);
    StrainView view = view_;
    if (is_rigidity && c.keeps_rigidity) view.n_columns = view.n_rows = 0;
    strain_kernels().tangent(view, c.step, c.vectors, c.signals, values);
}

void StrainTerm::ledger(const Context& c, const double* v1, LedgerSums& sums) {
    call_back(c, false);
    const int stride = view_.stride;
    double* out = out_.data();
    strain_kernels().ledger(view_, c.step, c.vectors, c.signals, v1,
                            {out, out + stride, out + 2 * stride, out + 3 * stride});
    const bool potential = traits(shape_.law).is_potential;
    for (int e = 0; e < view_.n; ++e) {
        if (potential) sums.energy[account[e]] += out[e];
        if (!potential) sums.work[account[e]] += out[stride + e];
        double* defect = &sums.defect[2 * static_cast<std::size_t>(component[e])];
        defect[0] = std::max(defect[0], out[2 * stride + e]);
        defect[1] = std::max(defect[1], out[3 * stride + e]);
    }
}

}  // namespace visviva
