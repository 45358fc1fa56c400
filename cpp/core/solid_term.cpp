#include "solid_term.hpp"

#include <algorithm>
#include <cstdio>
#include <map>

#include "parallel.hpp"
#include "pattern.hpp"

namespace visviva {

namespace {

constexpr int L8 = solid_lanes, task_blocks = 16;

// From [element][row] to [block][row][8]; the last element fills the padding.
template <class To, class From>
void interleave(To& to, const From* from, std::int64_t rows, int n) {
    if (!from) return;
    const std::int64_t blocks = (n + L8 - 1) / L8;
    to.resize(blocks * rows * L8);
    for (std::int64_t b = 0; b < blocks; ++b)
        for (std::int64_t k = 0; k < rows; ++k)
            for (int l = 0; l < L8; ++l)
                to[(b * rows + k) * L8 + l] = from[std::min<std::int64_t>(b * L8 + l, n - 1) * rows + k];
}

}  // namespace

SolidTerm::SolidTerm(const SolidData& d) {
    const int na = d.n_nodes, nq = d.n_points;
    interleave(slots_, d.index, na + d.n_pressures, d.n);
    for (auto from = slots_.begin(); from != slots_.end(); from += (na + d.n_pressures) * L8) {
        index_.insert(index_.end(), from, from + na * L8);
        pressure_index_.insert(pressure_index_.end(), from + na * L8, from + (na + d.n_pressures) * L8);
    }
    interleave(G_, d.gradients, static_cast<std::int64_t>(nq) * na * d.dim, d.n);
    interleave(H_, d.hoop, static_cast<std::int64_t>(nq) * na, d.n);
    interleave(w_, d.volume, nq, d.n);
    interleave(mass_, d.mass, na * (na + 1) / 2, d.n);
    interleave(par_, d.par, d.n_par, d.n);
    interleave(damping_, d.damping, 3, d.n);
    auto data = [](const auto& a) { return a.empty() ? nullptr : a.data(); };
    SolidView& v = view_;
    v.n = d.n, v.n_blocks = (d.n + L8 - 1) / L8, v.n_nodes = na, v.n_points = nq, v.dim = d.dim;
    v.n_pressures = d.n_pressures, v.n_par = d.n_par, v.kind = d.kind, v.small = d.small,
    v.damped = d.damping != nullptr;
    v.index = data(index_), v.pressure_index = data(pressure_index_), v.G = data(G_), v.H = data(H_),
    v.w = data(w_), v.mass = data(mass_);
    v.par = data(par_), v.damping = data(damping_);
    out_.assign(static_cast<std::size_t>(solid_ledger_rows) * v.n_blocks * L8, 0.0);
    smallest_.assign(static_cast<std::size_t>(v.n_blocks) * L8, 1.0);
    v.smallest = smallest_.data();
    colour_tasks();
}

void SolidTerm::set_centre(const double* gradients, const double* hoop) {
    interleave(centre_G_, gradients, view_.n_nodes * view_.dim, view_.n);
    interleave(centre_H_, hoop, view_.n_nodes, view_.n);
    view_.centre_G = centre_G_.data(), view_.centre_H = hoop ? centre_H_.data() : nullptr;
    mixed_ = &mixed_kernels(view_.dim, true);
}

void SolidTerm::set_thermal(const double* strain) {
    interleave(thermal_, strain, view_.n_points, view_.n);
    view_.thermal = thermal_.data();
}

void SolidTerm::set_pressure(const double* shape, const double* compliance, int measure, bool multiplier) {
    const int np = view_.n_pressures;
    interleave(shape_, shape, view_.n_points * np, view_.n);
    interleave(compliance_, compliance, np * np, view_.n);
    view_.shape = shape_.data(), view_.compliance = compliance_.data();
    view_.measure = measure, view_.multiplier = multiplier;
    mixed_ = &mixed_kernels(view_.dim, false);
}

// Tasks of neighbouring blocks of elements; tasks that share a node get different colours.
void SolidTerm::colour_tasks() {
    const int n_tasks = (view_.n_blocks + task_blocks - 1) / task_blocks;
    std::map<int, std::vector<char>> used;  // per node: colours that touch it
    for (int t = 0; t < n_tasks; ++t) {
        const std::int64_t size = static_cast<std::int64_t>(n_slots()) * L8;
        std::vector<int> nodes(
            slots_.begin() + t * task_blocks * size,
            slots_.begin() + std::min<std::int64_t>((t + 1) * task_blocks, view_.n_blocks) * size);
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        std::vector<char> taken(colours_.size() + 1, 0);
        for (int node : nodes) {
            const auto at = used.find(node);
            for (std::size_t c = 0; at != used.end() && c < at->second.size(); ++c) taken[c] |= at->second[c];
        }
        const auto colour =
            static_cast<std::size_t>(std::find(taken.begin(), taken.end(), 0) - taken.begin());
        if (colour == colours_.size()) colours_.push_back({});
        colours_[colour].push_back(t * task_blocks);
        for (int node : nodes) {
            auto& c = used[node];
            c.resize(std::max(c.size(), colour + 1), 0);
            c[colour] = 1;
        }
    }
}

template <class F>
void SolidTerm::for_tasks(F f) const {
    for (const auto& colour : colours_)
        parallel_for(static_cast<int>(colour.size()),
                     [&](int i) { f(colour[i], std::min(colour[i] + task_blocks, view_.n_blocks)); });
}

void SolidTerm::couple(Pattern& pattern) const {
    const int na = n_slots();
    for (int e = 0; e < view_.n; ++e) {
        const int* index = &slots_[(static_cast<std::size_t>(e / L8) * na) * L8 + e % L8];
        for (int a = 0; a < na; ++a)
            for (int b = 0; b < na; ++b) pattern.couple(index[a * L8], index[b * L8]);
    }
}

void SolidTerm::connect(const Pattern& pattern) {
    const int na = n_slots();
    const std::size_t lanes = static_cast<std::size_t>(view_.n_blocks) * na * L8;
    row_.assign(lanes, -1), length_.assign(lanes, 0), offset_.assign(lanes * na, 0xffff);
    for (int block = 0; block < view_.n_blocks; ++block)
        for (int a = 0; a < na; ++a)
            for (int l = 0; l < L8; ++l) {
                const std::size_t at = (static_cast<std::size_t>(block) * na + a) * L8 + l;
                const int u = slots_[at];
                const bool filler = block * L8 + l >= view_.n;  // of the last block
                if (filler || pattern.position(u, u) < 0) continue;
                length_[at] = pattern.row_length(u);
                row_[at] = pattern.row_start(u);
                for (int b = 0; b < na; ++b) {
                    const auto p =
                        pattern.position(u, slots_[(static_cast<std::size_t>(block) * na + b) * L8 + l]);
                    if (p >= 0)
                        offset_[((static_cast<std::size_t>(block) * na + a) * na + b) * L8 + l] =
                            static_cast<std::uint16_t>(p - row_[at]);
                }
            }
    view_.row = row_.data(), view_.length = length_.data(), view_.offset = offset_.data();
}

void SolidTerm::set_callback(LawCallback f) {
    callback_ = std::move(f);
    const std::size_t n = static_cast<std::size_t>(view_.n_blocks) * view_.n_points * L8;
    for (auto* a : {&c0_, &ct_, &c1_, &user_S_}) a->assign(6 * n, 0.0);
    user_W_.assign(n, 0.0), user_D_.assign(36 * n, 0.0);
    view_.user_W = user_W_.data(), view_.user_S = user_S_.data(), view_.user_D = user_D_.data();
}

void SolidTerm::call_back(const Context& c, bool want_tangent) {
    if (!callback_) return;
    solid_kernels().strains(view_, c.step, c.vectors, c0_.data(), ct_.data(), c1_.data());
    const int n = view_.n_blocks * view_.n_points * L8;
    callback_({n,
               n,
               6,
               0,
               want_tangent,
               c.step.te,
               c.step.h,
               c.step.stress,
               c0_.data(),
               c1_.data(),
               ct_.data(),
               nullptr,
               nullptr,
               user_S_.data(),
               user_D_.data(),
               nullptr,
               nullptr,
               nullptr,
               nullptr,
               user_W_.data()});
}

void SolidTerm::residual(const Context& c, double* r) {
    call_back(c, false);
    const auto kernel = mixed_ ? mixed_->residual : solid_kernels().residual;
    for_tasks([&](int begin, int end) { kernel(view_, c.step, c.vectors, begin, end, r); });
}

void SolidTerm::tangent(const Context& c, double* values) {
    if (!mixed_) return linearise(c, nullptr, values);
    for_tasks([&](int begin, int end) { mixed_->tangent(view_, c.step, c.vectors, begin, end, values); });
}

void SolidTerm::linearise(const Context& c, double* r, double* values) {
    call_back(c, true);
    const auto kernel = solid_kernels().tangent;
    for_tasks([&](int begin, int end) { kernel(view_, c.step, c.vectors, begin, end, r, values); });
}

void SolidTerm::ledger(const Context& c, const double* v1, LedgerSums& sums) {
    call_back(c, false);
    for_tasks([&](int begin, int end) {
        solid_kernels().ledger(view_, c.step, c.vectors, v1, begin, end, out_.data());
        if (mixed_) mixed_->energy(view_, c.step, c.vectors, begin, end, out_.data());  // instead of row 0
    });
    const std::size_t stride = static_cast<std::size_t>(view_.n_blocks) * L8;
    double total[solid_ledger_rows] = {};
    for (int k = 0; k < 9; ++k)
        for (int e = 0; e < view_.n; ++e) total[k] += out_[k * stride + e];
    sums.energy[strain_account] += total[0];
    if (kinetic_account >= 0) sums.energy[kinetic_account] += total[1];
    if (damping_account >= 0) sums.work[damping_account] += total[2];
    for (int k = 0; k < 6; ++k) sums.momentum[6 * static_cast<std::size_t>(owner) + k] += total[3 + k];
}

void SolidTerm::at_rest(At kernel, const double* x, int begin, int end, std::int64_t per_element,
                        double* out) {
    const Step step;
    const Vectors vectors{x, x, nullptr, nullptr};
    call_back({step, vectors, {}}, false);
    Aligned<double> smallest(smallest_.size());
    SolidView still = view_;
    still.mass = nullptr, still.damped = false, still.smallest = smallest.data();
    const int first = begin / L8, last = (end + L8 - 1) / L8;
    parallel_for((last - first + task_blocks - 1) / task_blocks, [&](int task) {
        const int from = first + task * task_blocks;
        kernel(still, step, vectors, from, std::min(from + task_blocks, last),
               out + (from - first) * L8 * per_element);
    });
}

void SolidTerm::fields(const double* x, int begin, int end, double* out) {
    at_rest(mixed_ ? mixed_->fields : solid_kernels().fields, x, begin, end,
            std::int64_t{view_.n_points} * solid_field_rows, out);
}

void SolidTerm::forces(const double* x, int begin, int end, double* out) {
    at_rest(mixed_ ? mixed_->forces : solid_kernels().forces, x, begin, end,
            std::int64_t{view_.n_nodes} * view_.dim, out);
}

// Inverted elements: their energy is finite, but no body is like that.
Refusal SolidTerm::refuse(const Context& c) {
    for (int e = 0; e < view_.n; ++e) {
        if (smallest_[e] > 0) continue;
        const int* index = &slots_[(static_cast<std::size_t>(e / L8) * n_slots()) * L8 + e % L8];
        double place[3] = {};
        for (int a = 0; a < view_.n_nodes; ++a)
            for (int k = 0; k < view_.dim; ++k) place[k] += c.vectors.x0[index[a * L8] + k] / view_.n_nodes;
        char text[160];
        std::snprintf(text, sizeof text,
                      "element %d of %s near (%.4g, %.4g, %.4g) is inverted (smallest det F = %.3g)",
                      first_element + e, name.c_str(), place[0], place[1], place[2], smallest_[e]);
        return {index[0], text};
    }
    return {};
}

}  // namespace visviva
