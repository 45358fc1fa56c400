#include "visviva/system/multiplier_forces.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

void MultiplierForces::analyze(const Csr& csr, const std::vector<char>& is_judged,
                               const std::vector<double>& inverse_scale) {
    rows_.clear(), entries_.clear();
    for (int i = 0; i < csr.n; ++i) {
        const int u = csr.unknown[i];
        if (inverse_scale[u] == 0) continue;
        const std::size_t begin = entries_.size();
        std::int64_t diagonal = -1;
        for (auto k = csr.row[i]; k < csr.row[i + 1]; ++k) {
            const int v = csr.unknown[csr.col[k]];
            if (v == u) diagonal = k;
            if (is_judged[v]) entries_.push_back({k, v});
        }
        if (entries_.size() > begin) rows_.push_back({u, 1 / inverse_scale[u], diagonal, entries_.size()});
    }
}

double MultiplierForces::largest(const double* values, const double* multipliers) const {
    double largest = 0;
    std::size_t k = 0;
    for (const Row& row : rows_) {
        double force = 0;
        for (; k < row.end; ++k) force += values[entries_[k].place] * multipliers[entries_[k].multiplier];
        largest = std::max(largest, std::abs(force) * row.scale);
    }
    return largest;
}

MultiplierForces::Size MultiplierForces::sizes(const double* values, const double* x1,
                                               const double* dx) const {
    double balanced = 0, stiffest = 0;
    std::size_t k = 0;
    for (const Row& row : rows_) {
        double forces = 0;  // redundant ones may be large and cancel
        for (; k < row.end; ++k) forces += std::abs(values[entries_[k].place] * x1[entries_[k].multiplier]);
        const double stiffness = row.diagonal < 0 ? 0 : std::abs(values[row.diagonal]) * row.scale;
        balanced = std::max({balanced, forces * row.scale, stiffness * std::abs(dx[row.unknown])});
        stiffest = std::max(stiffest, stiffness * row.scale);
    }
    return {balanced, stiffest};
}

}  // namespace visviva
