#include "visviva/linear/krylov/pressures.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

namespace {

constexpr int few = 2000;        // pressures that are factored sooner than coarsened
constexpr double strong = 0.02;  // couplings, of what the diagonals of both rows have

// Of a cavity in space of 62,423 equations with elements of Taylor and Hood GMRES takes 5.0 iterations, 9.5
// with aggregates of all that are coupled, 5.3 at thresholds of 0.01 and 0.05, and 49 at 0.1, which leaves
// nodes at boundaries alone (benchmarks/growth.py).
BlockRows<double> strongly_coupled(const BlockRows<double>& p) {
    std::vector<double> diagonal(p.n());
    for (int i = 0; i < p.n(); ++i)
        for (auto k = p.row[i]; k < p.row[i + 1]; ++k)
            if (p.col[k] == i) diagonal[i] = std::abs(p.value[k]);
    BlockRows<double> s;
    for (int i = 0; i < p.n(); ++i) {
        for (auto k = p.row[i]; k < p.row[i + 1]; ++k) {
            const int j = p.col[k];
            if (i == j || p.value[k] * p.value[k] > strong * strong * diagonal[i] * diagonal[j])
                s.col.push_back(j);
        }
        s.row.push_back(static_cast<std::int64_t>(s.col.size()));
    }
    return s;
}

}  // namespace

void Pressures::number(const NodeMatrix& matrix) {
    const auto& algebraic = matrix.algebraic();
    block_row_.clear(), number_.assign(algebraic.size(), -1);
    for (std::size_t i = 0; i < algebraic.size(); ++i)
        if (algebraic[i])
            number_[i] = static_cast<int>(block_row_.size()), block_row_.push_back(static_cast<int>(i));
}

bool Pressures::build(const NodeMatrix& matrix, const std::vector<double>& inverse) {
    a_ = &matrix.blocks();
    take();
    if (n() == 0) return true;
    return choice_.aggregator && n() > few ? make_grids(inverse) : factor(inverse);
}

void Pressures::take() {
    const BlockRows<double>& a = *a_;
    const int m = a.rows;
    start_.assign(1, 0), node_.clear(), row_.clear(), column_.clear();
    is_stabilised_ = false;
    for (int i : block_row_) {
        for (auto k = a.row[i]; k < a.row[i + 1]; ++k) {
            const int j = a.col[k];
            if (number_[j] >= 0) {
                is_stabilised_ = is_stabilised_ || a.block(k)[0] != 0;
                continue;
            }
            const auto begin = a.col.begin() + a.row[j], end = a.col.begin() + a.row[j + 1];
            const auto at = std::lower_bound(begin, end, i);
            if (at == end || *at != i) continue;
            const double* column = a.block(at - a.col.begin());
            node_.push_back(j);
            for (int c = 0; c < m; ++c) {
                column_.push_back(static_cast<float>(column[c]));
                row_.push_back(static_cast<float>(a.block(k)[c * m]));
            }
        }
        start_.push_back(static_cast<std::int64_t>(node_.size()));
    }
}

bool Pressures::make_grids(const std::vector<double>& inverse) {
    if (!grids_)
        grids_ = visviva::make_grids([this](const BlockRows<double>& p, const double* modes, int n_modes) {
            return choice_.aggregator(strongly_coupled(p), modes, n_modes);
        });
    kept_ = grids_->serve();
    if (kept_) return true;
    BlockRows<double> p;
    assemble(inverse, p);
    if (grids_->build(p, {})) return true;
    return message = "the pressures: " + grids_->message, false;
}

bool Pressures::factor(const std::vector<double>& inverse) {
    BlockRows<double> p;
    assemble(inverse, p);
    if (!factors_ || p.row != pattern_.row || p.col != pattern_.col) {
        pattern_ = {n(), std::move(p.row), std::move(p.col), {}, {}};
        for (int i = 0; i < n(); ++i) pattern_.equation.push_back(i), pattern_.unknown.push_back(i);
        blocks_.multiplier.assign(n(), 0);
        factors_ = make_linear(factors());
        factors_->analyze(pattern_, blocks_);
    }
    values_ = std::move(p.value);
    if (factors_->factor(values_.data(), {})) return true;
    return message = "the pressures: " + factors_->report().message, false;
}

std::vector<LinearChoice> Pressures::factors() const {
    LinearChoice definite, general;
    const bool mkl = missing_pardiso(choice_.library).empty();
    for (LinearChoice* c : {&definite, &general})
        c->library = choice_.library, c->backend = Backend::pardiso, c->matching = false;
    if (!mkl) definite.backend = Backend::cholesky, general.backend = Backend::sparse_lu;
    definite.kind = MatrixKind::definite;
    if (is_stabilised_) return {general};
    return {definite, general};
}

void Pressures::assemble(const std::vector<double>& inverse, BlockRows<double>& p) const {
    const BlockRows<double>& a = *a_;
    const int m = a.rows;
    std::vector<int> owner(node_.size());                                // of what is listed
    std::vector<std::int64_t> first(a.n() + 1, 0), place(node_.size());  // per node: where it is listed
    for (int j : node_) ++first[j + 1];
    for (int j = 0; j < a.n(); ++j) first[j + 1] += first[j];
    for (int i = 0; i < n(); ++i)
        for (auto k = start_[i]; k < start_[i + 1]; ++k) owner[k] = i, place[first[node_[k]]++] = k;
    for (int j = a.n(); j > 0; --j) first[j] = first[j - 1];
    first[0] = 0;
    std::vector<double> sum(n(), 0.0);
    std::vector<int> seen(n(), -1), cols;
    for (int i = 0; i < n(); ++i) {
        cols.clear();
        auto add = [&](int j, double value) {
            if (seen[j] != i) seen[j] = i, sum[j] = 0, cols.push_back(j);
            sum[j] += value;
        };
        for (auto k = start_[i]; k < start_[i + 1]; ++k) {
            const int node = node_[k];
            for (auto q = first[node]; q < first[node + 1]; ++q) {
                double value = 0;
                for (int c = 0; c < m; ++c)
                    value += row_[k * m + c] * inverse[static_cast<std::size_t>(node) * m + c] *
                             column_[place[q] * m + c];
                add(owner[place[q]], value);
            }
        }
        for (auto k = a.row[block_row_[i]]; k < a.row[block_row_[i] + 1]; ++k)
            if (const double e = a.block(k)[0]; number_[a.col[k]] >= 0 && e != 0) add(number_[a.col[k]], -e);
        std::sort(cols.begin(), cols.end());
        for (int j : cols) p.col.push_back(j), p.value.push_back(sum[j]);
        p.row.push_back(static_cast<std::int64_t>(p.col.size()));
    }
    p.value.resize(p.value.size() + BlockRows<double>::padding);
}

void Pressures::solve(const std::vector<double>& s, std::vector<double>& t) {
    if (grids_) return grids_->apply(s.data(), t.data());
    factors_->solve(s.data(), {}, t.data(), 0);
    for (double& value : t) value = -value;
}

void Pressures::add_gradient(double factor, const std::vector<double>& s, std::vector<double>& v) const {
    const int m = a_->rows;
    for (int i = 0; i < n(); ++i)
        for (auto k = start_[i]; k < start_[i + 1]; ++k)
            for (int c = 0; c < m; ++c)
                v[static_cast<std::size_t>(node_[k]) * m + c] += factor * column_[k * m + c] * s[i];
}

void Pressures::divergence(const std::vector<double>& v, std::vector<double>& s) const {
    const int m = a_->rows;
    for (int i = 0; i < n(); ++i) {
        s[i] = 0;
        for (auto k = start_[i]; k < start_[i + 1]; ++k)
            for (int c = 0; c < m; ++c)
                s[i] += row_[k * m + c] * v[static_cast<std::size_t>(node_[k]) * m + c];
    }
}

void Pressures::learn(int iterations) {
    if (grids_) grids_->learn(iterations);
}

void Pressures::forget() {
    if (grids_) grids_->forget();
}

double Pressures::memory() const {
    return 8.0 * static_cast<double>(row_.size()) + 4.0 * static_cast<double>(node_.size()) +
           (grids_     ? grids_->memory()
            : factors_ ? factors_->report().memory
                       : 0);
}

}  // namespace visviva
