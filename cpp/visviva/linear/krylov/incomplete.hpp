// Incomplete block LU on the pattern of a matrix.
#pragma once
#include "visviva/linear/block_rows.hpp"

namespace visviva {

// L (unit diagonal) and U in the place of the matrix, with inverted diagonal blocks. They are kept in single
// precision, half the memory traffic; a preconditioner needs no more.
class IncompleteFactors {
  public:
    // False: a pivot vanishes. Every diagonal block must be in the pattern.
    bool build(BlockRows<double> a);
    void apply(const double* r, double* z) const;
    double memory() const { return 4.0 * static_cast<double>(factors_.value.size() + factors_.col.size()); }

  private:
    template <int M>
    bool eliminate(BlockRows<double>& a);
    template <int M>
    void substitute(const double* r, double* z) const;

    BlockRows<float> factors_;
    std::vector<std::int64_t> diagonal_;
};

// The inverse of a block stored by columns, in its place. False: it is singular.
bool invert_block(double* block, int m);

}  // namespace visviva
