// The kernels of vectors for the instruction set chosen once at load time.
#pragma once

namespace visviva {

struct VectorKernels {
    double (*update)(int n, const double* d, const double* weight, const double* x, double* dx, double* x1);
    void (*affine)(int n, double factor, const double* x, const double* base, double* y);
    double (*largest)(int n, const double* a, const double* weight);
    void (*differences)(int n, int n_d, const double* x, const double* weight, double* const* d,
                        double* change, double* sum);
};

const VectorKernels& vector_kernels();

}  // namespace visviva
