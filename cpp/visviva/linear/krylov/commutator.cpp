// Preconditioner of flows [F B; C E]: block triangular, [F B; 0 -S] with incomplete factors of the
// velocities' F. The Schur complement S = C F^-1 B - E of the pressures is taken as
//     S^-1 = P^-1 (C D^-1 F D^-1 B) P^-1 with P = C D^-1 B and the diagonal D of F,
// the least-squares commutator (Elman, Howle, Shadid, Shuttleworth & Tuminaro 2006), which is right for long
// steps and short ones; with stabilised elements (E is not zero) as P = C D^-1 B - E (SIMPLE). P is factored.
#include <algorithm>

#include "visviva/linear/krylov/incomplete.hpp"
#include "visviva/linear/krylov/precondition.hpp"

namespace visviva {

namespace {

// Breadth first from a node of low degree (Cuthill & McKee 1969): incomplete factors lose less.
std::vector<int> ordered(const BlockRows<double>& a, const std::vector<char>& left_out) {
    std::vector<int> order, seeds, near;
    std::vector<char> seen = left_out;
    auto degree = [&](int i) { return a.row[i + 1] - a.row[i]; };
    for (int i = 0; i < a.n(); ++i)
        if (!left_out[i]) seeds.push_back(i);
    std::sort(seeds.begin(), seeds.end(), [&](int i, int j) { return degree(i) < degree(j); });
    for (int seed : seeds) {
        if (seen[seed]) continue;
        seen[seed] = 1;
        order.push_back(seed);
        for (std::size_t at = order.size() - 1; at < order.size(); ++at) {
            near.clear();
            for (auto k = a.row[order[at]]; k < a.row[order[at] + 1]; ++k)
                if (!seen[a.col[k]]) seen[a.col[k]] = 1, near.push_back(a.col[k]);
            std::sort(near.begin(), near.end(), [&](int i, int j) { return degree(i) < degree(j); });
            order.insert(order.end(), near.begin(), near.end());
        }
    }
    return order;
}

class Commutator : public Preconditioning {
  public:
    explicit Commutator(const LinearChoice& choice) : choice_(choice) {}

    bool build(const NodeMatrix& matrix) override {
        matrix_ = &matrix, a_ = &matrix.blocks();
        if (order_.empty()) number();
        take_diagonal();
        if (!factors_.build(velocities())) return message = "incomplete LU met a zero pivot", false;
        take_pressures();
        return factor();
    }

    void apply(const double* r, double* z) override {
        const int m = a_->rows;
        for (std::size_t i = 0; i < pressure_.size(); ++i) s_[i] = r[slot(pressure_[i])];
        complement();
        std::copy(r, r + a_->size(), rest_.begin());
        add_gradient(-1.0, rest_);
        for (std::size_t k = 0; k < order_.size(); ++k)
            std::copy_n(&rest_[slot(order_[k])], m, &in_order_[k * m]);
        factors_.apply(in_order_.data(), solved_.data());
        for (std::size_t k = 0; k < order_.size(); ++k) std::copy_n(&solved_[k * m], m, z + slot(order_[k]));
        for (std::size_t i = 0; i < pressure_.size(); ++i) {
            std::copy_n(r + slot(pressure_[i]), m, z + slot(pressure_[i]));  // padding
            z[slot(pressure_[i])] = s_[i];
        }
    }

    double memory() const override {
        return factors_.memory() + 16.0 * static_cast<double>(row_.size()) +
               (solver_ ? solver_->report().memory : 0);
    }
    const char* name() const override {
        return is_stabilised_ ? "velocities by incomplete factors, pressures by SIMPLE"
                              : "velocities by incomplete factors, pressures by the commutator";
    }

  private:
    std::size_t slot(int node) const { return static_cast<std::size_t>(node) * a_->rows; }

    void number() {
        const std::vector<char>& algebraic = matrix_->algebraic();
        order_ = ordered(*a_, algebraic);
        number_.assign(a_->n(), -1);
        for (std::size_t k = 0; k < order_.size(); ++k) number_[order_[k]] = static_cast<int>(k);
        for (int i = 0; i < a_->n(); ++i)
            if (algebraic[i]) number_[i] = static_cast<int>(pressure_.size()), pressure_.push_back(i);
        for (auto* v : {&rest_, &image_}) v->assign(a_->size(), 0.0);
        in_order_.assign(order_.size() * a_->rows, 0.0), solved_ = in_order_;
        s_.assign(pressure_.size(), 0.0), t_ = s_;
    }

    bool is_pressure(int node) const { return matrix_->algebraic()[node]; }

    void take_diagonal() {
        const int m = a_->rows;
        inverse_.assign(a_->size(), 0.0);
        for (int i : order_) {
            const auto k =
                std::lower_bound(a_->col.begin() + a_->row[i], a_->col.begin() + a_->row[i + 1], i) -
                a_->col.begin();
            for (int c = 0; c < m; ++c)
                if (const double d = a_->block(k)[c * m + c]; d != 0) inverse_[slot(i) + c] = 1 / d;
        }
    }

    // F in its order
    BlockRows<double> velocities() const {
        BlockRows<double> f;
        const int m = a_->rows;
        f.rows = f.cols = m;
        std::vector<std::int64_t> from;
        std::vector<std::pair<int, std::int64_t>> row;
        for (int i : order_) {
            row.clear();
            for (auto k = a_->row[i]; k < a_->row[i + 1]; ++k)
                if (!is_pressure(a_->col[k])) row.emplace_back(number_[a_->col[k]], k);
            std::sort(row.begin(), row.end());
            for (const auto& [j, k] : row) f.col.push_back(j), from.push_back(k);
            f.row.push_back(static_cast<std::int64_t>(f.col.size()));
        }
        f.allocate();
        for (std::size_t k = 0; k < from.size(); ++k) std::copy_n(a_->block(from[k]), m * m, f.block(k));
        return f;
    }

    // Per pressure: the nodes of velocities that it touches, its row C and its column B.
    void take_pressures() {
        const int m = a_->rows;
        start_.assign(1, 0), node_.clear(), row_.clear(), column_.clear();
        for (int i : pressure_) {
            for (auto k = a_->row[i]; k < a_->row[i + 1]; ++k) {
                const int j = a_->col[k];
                if (is_pressure(j)) continue;
                const auto begin = a_->col.begin() + a_->row[j], end = a_->col.begin() + a_->row[j + 1];
                const auto at = std::lower_bound(begin, end, i);
                if (at == end || *at != i) continue;
                const double* column = a_->block(at - a_->col.begin());
                node_.push_back(j);
                column_.insert(column_.end(), column, column + m);
                for (int c = 0; c < m; ++c) row_.push_back(a_->block(k)[c * m]);
            }
            start_.push_back(static_cast<std::int64_t>(node_.size()));
        }
    }

    // P, and its factors
    bool factor() {
        Csr pattern;
        assemble(pattern, values_);
        const bool again = pattern.row == pattern_.row && pattern.col == pattern_.col;
        if (!again || !solver_) {
            pattern_ = std::move(pattern);
            solver_ = make_linear(choices());
            solver_->analyze(pattern_, blocks_);
        }
        if (pattern_.n == 0 || solver_->factor(values_.data(), {})) return true;
        return message = "the pressures: " + solver_->report().message, false;
    }

    std::vector<LinearChoice> choices() {
        blocks_.multiplier.assign(pattern_.n, 0);
        LinearChoice definite, general;
        const bool mkl = missing_pardiso(choice_.library).empty();
        for (LinearChoice* c : {&definite, &general})
            c->library = choice_.library, c->backend = Backend::pardiso, c->matching = false;
        if (!mkl) definite.backend = Backend::cholesky, general.backend = Backend::sparse_lu;
        definite.kind = MatrixKind::definite;
        if (is_stabilised_) return {general};
        return {definite, general};
    }

    void assemble(Csr& p, std::vector<double>& values) {
        const int n = static_cast<int>(pressure_.size()), m = a_->rows;
        std::vector<std::vector<std::pair<int, std::int64_t>>> at(a_->n());  // per node: pressures and places
        for (int i = 0; i < n; ++i)
            for (auto k = start_[i]; k < start_[i + 1]; ++k) at[node_[k]].push_back({i, k});
        is_stabilised_ = false;
        std::vector<double> sum(n, 0.0);
        std::vector<int> seen(n, -1), cols;
        p.n = n, p.row.assign(1, 0);
        for (int i = 0; i < n; ++i) {
            cols.clear();
            auto add = [&](int j, double value) {
                if (seen[j] != i) seen[j] = i, sum[j] = 0, cols.push_back(j);
                sum[j] += value;
            };
            for (auto k = start_[i]; k < start_[i + 1]; ++k)
                for (const auto& [j, place] : at[node_[k]]) {
                    double value = 0;
                    for (int c = 0; c < m; ++c)
                        value += row_[k * m + c] * inverse_[slot(node_[k]) + c] * column_[place * m + c];
                    add(j, value);
                }
            for (auto k = a_->row[pressure_[i]]; k < a_->row[pressure_[i] + 1]; ++k)
                if (const double e = a_->block(k)[0]; is_pressure(a_->col[k]) && e != 0)
                    add(number_[a_->col[k]], -e), is_stabilised_ = true;
            std::sort(cols.begin(), cols.end());
            for (int j : cols) p.col.push_back(j), values.push_back(sum[j]);
            p.row.push_back(static_cast<std::int64_t>(p.col.size()));
            p.equation.push_back(i), p.unknown.push_back(i);
        }
    }

    // s becomes -S^-1 s
    void complement() {
        if (pressure_.empty()) return;
        solver_->solve(s_.data(), {}, t_.data(), 0);  // -P^-1 s
        s_ = t_;
        if (is_stabilised_) return;
        std::fill(rest_.begin(), rest_.end(), 0.0);
        add_gradient(1.0, rest_);
        for (std::size_t i = 0; i < rest_.size(); ++i) rest_[i] *= inverse_[i];
        matrix_->multiply(rest_.data(), image_.data());
        const int m = a_->rows;
        for (std::size_t i = 0; i < pressure_.size(); ++i) {
            s_[i] = 0;
            for (auto k = start_[i]; k < start_[i + 1]; ++k)
                for (int c = 0; c < m; ++c)
                    s_[i] += row_[k * m + c] * inverse_[slot(node_[k]) + c] * image_[slot(node_[k]) + c];
        }
        solver_->solve(s_.data(), {}, t_.data(), 0);
        for (std::size_t i = 0; i < s_.size(); ++i) s_[i] = -t_[i];
    }

    // v += factor B s
    void add_gradient(double factor, std::vector<double>& v) const {
        const int m = a_->rows;
        for (std::size_t i = 0; i < pressure_.size(); ++i)
            for (auto k = start_[i]; k < start_[i + 1]; ++k)
                for (int c = 0; c < m; ++c) v[slot(node_[k]) + c] += factor * column_[k * m + c] * s_[i];
    }

    LinearChoice choice_;
    const NodeMatrix* matrix_ = nullptr;
    const BlockRows<double>* a_ = nullptr;
    std::vector<int> order_, pressure_, number_;  // block rows of velocities and pressures, and back
    std::vector<std::int64_t> start_;
    std::vector<int> node_;
    std::vector<double> row_, column_, inverse_;
    IncompleteFactors factors_;
    std::vector<double> values_;  // of P, for as long as its factors may be made again
    Csr pattern_;
    Blocks blocks_;
    std::unique_ptr<LinearSolver> solver_;
    bool is_stabilised_ = false;
    std::vector<double> rest_, image_, in_order_, solved_, s_, t_;
};

}  // namespace

std::unique_ptr<Preconditioning> make_commutator(const LinearChoice& choice) {
    return std::make_unique<Commutator>(choice);
}

}  // namespace visviva
