// The kernels of mechanisms, vectors and sparse products, for the instruction set chosen once at load time.
#pragma once
#include "block_lu.hpp"
#include "block_rows.hpp"
#include "inertia.hpp"
#include "rigid.hpp"
#include "strain.hpp"

namespace visviva {

struct Kernels {
    void (*strain_begin)(const StrainView&, const double* x);
    void (*strain_strains)(const StrainView&, const Step&, const Vectors&);
    void (*strain_residual)(const StrainView&, const Step&, const Vectors&, const Signals&, double* r);
    void (*strain_tangent)(const StrainView&, const Step&, const Vectors&, const Signals&, double* values);
    void (*strain_ledger)(const StrainView&, const Step&, const Vectors&, const Signals&, const double* v1,
                          const StrainLedger&);
    void (*inertia_residual)(const InertiaView&, const Vectors&, double* r);
    void (*inertia_tangent)(const InertiaView&, const Step&, double* values);
    void (*inertia_ledger)(const InertiaView&, const double* x, const double* v, const InertiaLedger&);
    double (*vector_update)(int n, const double* d, const double* weight, const double* x, double* dx,
                            double* x1);
    void (*vector_affine)(int n, double factor, const double* x, const double* base, double* y);
    double (*vector_largest)(int n, const double* a, const double* weight);
    void (*vector_differences)(int n, int n_d, const double* x, const double* weight, double* const* d,
                               double* change, double* sum);
    void (*rigid_force)(const RigidView&, const double* r, const Place&, double* s);
    void (*rigid_balance)(const RigidView&, const double* r, const Place&, double* dx, double* x1);
    void (*rigid_expand)(const RigidView&, const double* s, const Place&, double* d);
    LuKernels lu;
    // y = A x for the block rows begin .. end.
    void (*block_multiply)(const BlockView<double>&, const double* x, double* y, int begin, int end);
    void (*block_multiply_single)(const BlockView<float>&, const float* x, float* y, int begin, int end);
    // c (rows x cols) += a (rows x inner, by columns) b (inner x cols); b and c by rows. A block by rows,
    // taken as one by columns, is its transpose.
    void (*add_product)(const double* a, const double* b, double* c, int rows, int inner, int cols);
};

const Kernels& kernels();

}  // namespace visviva
