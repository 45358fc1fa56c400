// Smoothed aggregation: from aggregates of block rows to the coarser matrix. The aggregates follow from the
// pattern alone and last; what follows from the values is cheap enough to be made anew.
#pragma once
#include "visviva/linear/aggregates.hpp"
#include "visviva/linear/block_rows.hpp"

namespace visviva {

// The way up from a coarser level, in single precision as the cycle; unlike elsewhere blocks are stored by
// rows, so that products run along them.
struct Prolongation {
    int n_coarse = 0, rows = 1, cols = 1;
    std::vector<std::int64_t> row;
    std::vector<int> col;
    std::vector<float> block;

    int n() const { return static_cast<int>(row.size()) - 1; }
    const float* at(std::int64_t k) const { return block.data() + k * rows * cols; }

    BlockRows<float> up() &&;       // by columns, in the same memory
    BlockRows<float> down() const;  // its transpose
};

// P = (1 - weight D^-1 A) T with inverted diagonal blocks D^-1 of `factor` A and tentative T.
Prolongation smoothed(const BlockReader& a, const BlockRows<float>& inverse, double factor,
                      const Aggregates& tentative);

// P^T A P
BlockRows<double> coarse_matrix(const BlockReader& a, const Prolongation& p);

}  // namespace visviva
