#include "visviva/system/multiplier_forces.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

void MultiplierForces::mark(const Csr& csr, const std::vector<char>& is_judged,
                            std::vector<double>& acted_on) {
    for (int i = 0; i < csr.n; ++i)
        for (auto k = csr.row[i]; k < csr.row[i + 1]; ++k)
            if (is_judged[csr.unknown[csr.col[k]]]) acted_on[csr.unknown[i]] = 1;
}

void MultiplierForces::analyze(const Csr& csr, const std::vector<char>& is_judged,
                               const std::vector<double>& acted_on,
                               const std::vector<double>& inverse_scale) {
    rows_.clear(), entries_.clear();
    for (int u = 0; u < static_cast<int>(acted_on.size()); ++u) {
        if (acted_on[u] == 0 || inverse_scale[u] == 0) continue;
        Row row{u, 1 / inverse_scale[u]};
        if (const int i = csr.equation[u]; i >= 0)
            for (auto k = csr.row[i]; k < csr.row[i + 1]; ++k) {
                const int v = csr.unknown[csr.col[k]];
                if (v == u) row.diagonal = k;
                if (is_judged[v]) entries_.push_back({k, v});
            }
        row.end = entries_.size();
        rows_.push_back(row);
    }
}

double MultiplierForces::largest(const double* values, const double* multipliers, const Total& total) {
    sums_.assign(rows_.size(), 0.0);
    std::size_t k = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i)
        for (; k < rows_[i].end; ++k)
            sums_[i] += values[entries_[k].place] * multipliers[entries_[k].multiplier];
    total(sums_);
    double largest = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i)
        largest = std::max(largest, std::abs(sums_[i]) * rows_[i].scale);
    return largest;
}

MultiplierForces::Size MultiplierForces::sizes(const double* values, const double* x1, const double* dx,
                                               const Total& total) {
    const std::size_t n = rows_.size();
    sums_.assign(2 * n, 0.0);  // forces, redundant ones of which may be large and cancel, and diagonals
    std::size_t k = 0;
    for (std::size_t i = 0; i < n; ++i) {
        for (; k < rows_[i].end; ++k)
            sums_[i] += std::abs(values[entries_[k].place] * x1[entries_[k].multiplier]);
        if (rows_[i].diagonal >= 0) sums_[n + i] = values[rows_[i].diagonal];
    }
    total(sums_);
    Size size;
    for (std::size_t i = 0; i < n; ++i) {
        const double scale = rows_[i].scale, stiffness = std::abs(sums_[n + i]) * scale;
        size.balanced =
            std::max({size.balanced, sums_[i] * scale, stiffness * std::abs(dx[rows_[i].unknown])});
        size.stiffest = std::max(size.stiffest, stiffness * scale);
    }
    return size;
}

}  // namespace visviva
