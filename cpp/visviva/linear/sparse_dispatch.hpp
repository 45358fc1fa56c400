// The kernels of sparse factors and products for the instruction set chosen once at load time.
#pragma once
#include "visviva/linear/block_lu.hpp"
#include "visviva/linear/block_rows.hpp"

namespace visviva {

struct SparseKernels {
    LuKernels lu;
    // y = A x for the block rows begin .. end.
    void (*block_multiply)(const BlockView<double>&, const double* x, double* y, int begin, int end);
    void (*block_multiply_single)(const BlockView<float>&, const float* x, float* y, int begin, int end);
    // c (rows x cols) += a (rows x inner, by columns) b (inner x cols); b and c by rows. A block by rows,
    // taken as one by columns, is its transpose.
    void (*add_product)(const double* a, const double* b, double* c, int rows, int inner, int cols);
    void (*add_product_single)(const double* a, const float* b, double* c, int rows, int inner, int cols);
};

const SparseKernels& sparse_kernels();

}  // namespace visviva
