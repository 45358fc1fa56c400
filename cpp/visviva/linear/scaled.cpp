#include "visviva/linear/scaled.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

namespace visviva {

namespace {

// Median of the largest entries of rows among what moves; rows of rounding alone do not count.
double typical(std::vector<double>& sizes) {
    const double least = sizes.empty() ? 0 : 1e-8 * *std::max_element(sizes.begin(), sizes.end());
    std::erase_if(sizes, [&](double a) { return a <= least; });
    if (sizes.empty()) return 1;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return *middle;
}

}  // namespace

std::vector<double> arbitrary_vector(int n) {
    std::vector<double> v(n);
    std::uint64_t state = 88172645463325252ULL;  // xorshift, Marsaglia 2003
    for (double& a : v) {
        state ^= state << 13, state ^= state >> 7, state ^= state << 17;
        a = static_cast<double>(state >> 11) * 0x1p-52 - 1;
    }
    return v;
}

bool is_singular(const std::vector<double>& solution, double residual, double regularization) {
    const double growth = regularization > 0 ? std::max(1e12, 100 / regularization) : 1e12;
    double largest = 0;
    for (double a : solution)
        if (!(std::abs(a) <= largest)) largest = std::isnan(a) ? INFINITY : std::abs(a);
    return !(largest < growth && residual < 1e-4);
}

void ScaledMatrix::analyze(const Csr& pattern, const Blocks& blocks, MatrixKind kind) {
    n_ = pattern.n, kind_ = kind, csr_ = &pattern, blocks_ = &blocks;
    if (pattern.col.size() + n_ > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw MemoryShortage("the tangent has more than 2^31 entries: use an iterative solver");
    row_.assign(1, 0), col_.clear(), diagonal_.clear();
    for (int i = 0; i < n_; ++i) {
        auto k = pattern.row[i];
        const auto end = pattern.row[i + 1];
        while (k < end && pattern.col[k] < i) {
            if (!symmetric()) col_.push_back(pattern.col[k]);
            ++k;
        }
        diagonal_.push_back(col_.size());
        col_.push_back(i);
        if (k < end && pattern.col[k] == i) ++k;
        for (; k < end; ++k) col_.push_back(pattern.col[k]);
        row_.push_back(static_cast<int>(col_.size()));
    }
    value_.resize(col_.size());
    find_parts();
    probe_ = symmetric() ? arbitrary_vector(n_) : std::vector<double>();
}

void ScaledMatrix::find_parts() {
    std::vector<int> above(n_);
    std::iota(above.begin(), above.end(), 0);
    auto root = [&](int i) {
        while (above[i] != i) i = above[i] = above[above[i]];
        return i;
    };
    for_each([&](int i, int j, int) { above[root(j)] = root(i); });
    part_.assign(n_, -1), n_parts_ = 0;
    for (int i = 0; i < n_; ++i)
        if (int& number = part_[root(i)]; number < 0) number = n_parts_++;
    for (int i = 0; i < n_; ++i) part_[i] = part_[root(i)];
}

template <class F>
void ScaledMatrix::for_each(F f) const {
    for (int i = 0; i < n_; ++i)
        for (int k = row_[i]; k < row_[i + 1]; ++k) f(i, col_[k], k);
}

bool ScaledMatrix::fill(const double* values, double regularization) {
    message_.clear();
    if (!copy(values)) return false;
    kind_ == MatrixKind::definite ? scale_by_diagonal() : scale_by_largest();
    if (regularization > 0)
        for (int i = 0; i < n_; ++i)
            if (blocks_->multiplier[unknown(i)]) value_[diagonal_[i]] -= regularization;
    return true;
}

// Walks the pattern of the system along with ours. Of a symmetric matrix the products with some vector tell
// whether the lower triangle, which is left out, mirrors the upper one.
bool ScaledMatrix::copy(const double* values) {
    std::vector<double> whole(symmetric() ? n_ : 0), mirrored(whole);
    double sum = 0;
    for (int i = 0; i < n_; ++i) {
        int to = row_[i];
        value_[diagonal_[i]] = 0;
        for (auto k = csr_->row[i]; k < csr_->row[i + 1]; ++k) {
            const int j = csr_->col[k];
            const double a = values[k];
            if (symmetric()) whole[i] += a * probe_[j];
            sum += std::abs(a);
            if (symmetric() && j < i) continue;
            while (col_[to] < j) ++to;
            value_[to] = a;
            if (symmetric()) mirrored[i] += a * probe_[j];
            if (symmetric() && j > i) mirrored[j] += a * probe_[i];
        }
    }
    if (!std::isfinite(sum)) return message_ = "the tangent holds values that are not finite", false;
    double largest = 0, difference = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        largest = std::max(largest, std::abs(whole[i]));
        difference = std::max(difference, std::abs(whole[i] - mirrored[i]));
    }
    if (difference <= 1e-9 * largest) return true;
    char text[120];
    std::snprintf(text, sizeof text, "the tangent is not symmetric, against what was said (by %.1e)",
                  difference / largest);
    return message_ = text, false;
}

void ScaledMatrix::scale_by_diagonal() {
    left_.resize(n_);
    for (int i = 0; i < n_; ++i) {
        const double a = value_[diagonal_[i]];
        left_[i] = a > 0 ? 1 / std::sqrt(a) : 1;
    }
    right_ = left_;
    apply(left_, right_);
}

// Three sweeps of Ruiz' scaling (2001), rows and columns to unit largest entry, from where neither the units
// nor the step size count: else the sweeps would end where the condition number grows with them (Bottasso,
// Bauchau & Cardona 2007). Directors without stiffness, for instance, would shrink, and the multipliers of
// their orthonormality grow, until the nodes that they are tied to do not feel them.
void ScaledMatrix::scale_by_largest() {
    scale_by_units();
    std::vector<double> r(n_), c(n_);
    auto factor = [](double largest) { return largest > 0 ? 1 / std::sqrt(largest) : 1; };
    for (int sweep = 0; sweep < 3; ++sweep) {
        std::fill(r.begin(), r.end(), 0.0), std::fill(c.begin(), c.end(), 0.0);
        std::vector<double>& other = symmetric() ? r : c;
        for_each([&](int i, int j, int k) {
            const double a = std::abs(value_[k]) * left_[i] * right_[j];
            r[i] = std::max(r[i], a), other[j] = std::max(other[j], a);
        });
        for (int i = 0; i < n_; ++i) r[i] = factor(r[i]), c[i] = symmetric() ? r[i] : factor(c[i]);
        for (int i = 0; i < n_; ++i) left_[i] *= r[i], right_[i] *= c[i];
    }
    apply(left_, right_);
}

// What moves is measured by its scale, a force by what it and a scale do: all entries become parts of one
// energy.
void ScaledMatrix::scale_by_units() {
    left_.assign(n_, 0.0), right_.assign(n_, 0.0);
    for_each([&](int i, int j, int k) {
        const double a = std::abs(value_[k]), of_row = a * scale(j), of_column = a * scale(i);
        left_[i] = std::max(left_[i], of_row), right_[j] = std::max(right_[j], of_column);
        if (symmetric()) left_[j] = std::max(left_[j], of_column), right_[i] = std::max(right_[i], of_row);
    });
    const std::vector<double> energy = typical_energies();
    for (int i = 0; i < n_; ++i) {
        const double unit = std::sqrt(energy[part_[i]]);
        const double own = std::abs(value_[diagonal_[i]]), alone = own > 0 ? 1 / std::sqrt(own) : 1;
        for (double* f : {&left_[i], &right_[i]})
            *f = scale(i) > 0 ? scale(i) / unit : *f > 0 ? unit / *f : alone;
    }
}

// Of each part that nothing couples to others: a beam beside a mountain would be rounding by that one's.
std::vector<double> ScaledMatrix::typical_energies() const {
    std::vector<double> sizes(n_, 0.0);
    for_each([&](int i, int j, int k) {
        const double a = std::abs(value_[k]) * scale(i) * scale(j);
        sizes[i] = std::max(sizes[i], a);
        if (symmetric()) sizes[j] = std::max(sizes[j], a);
    });
    std::vector<std::vector<double>> of(n_parts_);
    for (int i = 0; i < n_; ++i) of[part_[i]].push_back(sizes[i]);
    std::vector<double> energies;
    for (auto& part : of) energies.push_back(typical(part));
    return energies;
}

void ScaledMatrix::apply(const std::vector<double>& left, const std::vector<double>& right) {
    for_each([&](int i, int j, int k) { value_[k] *= left[i] * right[j]; });
}

void ScaledMatrix::right_hand_side(const double* r, double* b) const {
    for (int i = 0; i < n_; ++i) b[i] = -r[unknown(i)] * left_[i];
}

void ScaledMatrix::increment(const double* s, double* d) const {
    for (int i = 0; i < n_; ++i) d[unknown(i)] = s[i] * right_[i];
}

double ScaledMatrix::residual(const double* b, const double* s) const {
    std::vector<double> r(b, b + n_);
    for_each([&](int i, int j, int k) {
        r[i] -= value_[k] * s[j];
        if (symmetric() && i != j) r[j] -= value_[k] * s[i];
    });
    double rr = 0, bb = 0;
    for (int i = 0; i < n_; ++i) rr += r[i] * r[i], bb += b[i] * b[i];
    return bb > 0 ? std::sqrt(rr / bb) : std::sqrt(rr);
}

}  // namespace visviva
