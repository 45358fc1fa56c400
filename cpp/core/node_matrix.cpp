#include "node_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dispatch.hpp"

namespace visviva {

constexpr int largest_block = 6;
constexpr double largest_fill = 2;  // entries of blocks over entries of the pattern

void NodeMatrix::analyze(const Csr& pattern, const Blocks& blocks) {
    csr_ = &pattern;
    partition(blocks.node);
    make_pattern();
    if (static_cast<double>(a_.n_values()) > largest_fill * static_cast<double>(pattern.col.size())) {
        partition({});
        make_pattern();
    }
    a_.allocate();
    n_modes_ = blocks.n_modes;
    modes_.assign(size() * n_modes_, 0.0);
    algebraic_.assign(a_.n(), 0);
    for (int i = 0; i < pattern.n; ++i)
        if (!blocks.algebraic.empty() && blocks.algebraic[i]) algebraic_[slot_[i] / a_.rows] = 1;
    for (int i = 0; i < pattern.n; ++i)
        std::copy_n(blocks.modes.data() + static_cast<std::size_t>(i) * n_modes_, n_modes_,
                    modes_.data() + static_cast<std::size_t>(slot_[i]) * n_modes_);
}

// Blocks have the size that most nodes have; larger nodes are cut into several.
void NodeMatrix::partition(const std::vector<int>& node) {
    std::vector<int> start = node;
    if (start.empty()) {
        start.resize(csr_->n + 1);
        std::iota(start.begin(), start.end(), 0);
    }
    std::vector<int> count(largest_block + 1, 0);
    for (std::size_t k = 0; k + 1 < start.size(); ++k)
        count[std::min(start[k + 1] - start[k], largest_block)] += start[k + 1] - start[k];
    a_.rows = a_.cols = static_cast<int>(std::max_element(count.begin(), count.end()) - count.begin());
    a_.rows = a_.cols = std::max(a_.rows, 1);
    first_.clear(), slot_.resize(csr_->n);
    for (std::size_t k = 0; k + 1 < start.size(); ++k)
        for (int i = start[k]; i < start[k + 1]; i += a_.rows) first_.push_back(i);
    first_.push_back(csr_->n);
    for (std::size_t b = 0; b + 1 < first_.size(); ++b)
        for (int i = first_[b]; i < first_[b + 1]; ++i)
            slot_[i] = static_cast<int>(b) * a_.rows + i - first_[b];
}

void NodeMatrix::make_pattern() {
    const int n = static_cast<int>(first_.size()) - 1;
    a_.row.assign(1, 0), a_.col.clear();
    std::vector<int> seen(n, -1), cols;
    for (int b = 0; b < n; ++b) {
        cols.assign(1, b), seen[b] = b;
        for (auto k = csr_->row[first_[b]]; k < csr_->row[first_[b + 1]]; ++k) {
            const int c = slot_[csr_->col[k]] / a_.rows;
            if (seen[c] != b) cols.push_back(c), seen[c] = b;
        }
        std::sort(cols.begin(), cols.end());
        a_.col.insert(a_.col.end(), cols.begin(), cols.end());
        a_.row.push_back(static_cast<std::int64_t>(a_.col.size()));
    }
}

// Columns of both patterns ascend, so one walk along both finds every entry's place.
bool NodeMatrix::fill(const double* values) {
    const int m = a_.rows;
    std::fill(a_.value.begin(), a_.value.end(), 0.0);
    double sum = 0;
    for (int b = 0; b < a_.n(); ++b) {
        const int used = first_[b + 1] - first_[b];
        for (int i = first_[b]; i < first_[b + 1]; ++i) {
            std::int64_t at = a_.row[b];
            for (auto k = csr_->row[i]; k < csr_->row[i + 1]; ++k) {
                const int slot = slot_[csr_->col[k]], c = slot / m;
                while (a_.col[at] < c) ++at;
                a_.block(at)[(slot - c * m) * m + i - first_[b]] = values[k];
                sum += std::abs(values[k]);
            }
        }
        const auto diagonal = std::lower_bound(a_.col.begin() + a_.row[b], a_.col.begin() + a_.row[b + 1], b);
        for (int r = used; r < m; ++r) a_.block(diagonal - a_.col.begin())[r * m + r] = 1;
    }
    return std::isfinite(sum);
}

void NodeMatrix::multiply(const double* x, double* y) const {
    kernels().block_multiply(a_.view(), x, y, 0, a_.n());
}

void NodeMatrix::gather(const double* r, double* b) const {
    std::fill(b, b + size(), 0.0);
    for (int i = 0; i < csr_->n; ++i) b[slot_[i]] = -r[csr_->unknown[i]];
}

void NodeMatrix::scatter(const double* x, double* d) const {
    for (int i = 0; i < csr_->n; ++i) d[csr_->unknown[i]] = x[slot_[i]];
}

}  // namespace visviva
