#pragma once
#include <Eigen/SparseCore>
#include <cstdint>

namespace visviva {

// Entries of the Cholesky factor of a symmetric matrix, given by the columns of its upper triangle.
std::int64_t count_fill(const Eigen::SparseMatrix<double>& upper);

}  // namespace visviva
