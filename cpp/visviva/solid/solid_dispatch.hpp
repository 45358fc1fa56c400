// The kernels of solids for one instruction set.
#pragma once
#include "visviva/solid/solid.hpp"

namespace visviva {

struct SolidKernels {
    void (*residual)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* r);
    // r may be null: the residual comes almost free.
    void (*tangent)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* r,
                    double* values);
    void (*ledger)(const SolidView&, const Step&, const Vectors&, const double* v1, int begin, int end,
                   double* out);
    void (*strains)(const SolidView&, const Step&, const Vectors&, double* c0, double* ct, double* c1);
    void (*fields)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* out);
    void (*forces)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* out);
    void (*material)(MaterialKind, const double* par, int n_par, int n, const double* c, double* out);
};

/// Of elements whose energy depends on more than C at a point; see solid_mixed_element.hpp.
struct MixedKernels {
    void (*residual)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* r);
    void (*tangent)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* values);
    void (*energy)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* out);
    void (*fields)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* out);
    void (*forces)(const SolidView&, const Step&, const Vectors&, int begin, int end, double* out);
};

/// The kernels for the machine that runs.
const SolidKernels& solid_kernels();
const MixedKernels& mixed_kernels(int dim, bool fbar);

}  // namespace visviva
