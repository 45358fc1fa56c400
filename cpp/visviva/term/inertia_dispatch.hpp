// The kernels of masses for the instruction set chosen once at load time.
#pragma once
#include "visviva/term/inertia.hpp"

namespace visviva {

struct InertiaKernels {
    void (*residual)(const InertiaView&, const Vectors&, double* r);
    void (*tangent)(const InertiaView&, const Step&, double* values);
    void (*ledger)(const InertiaView&, const double* x, const double* v, const InertiaLedger&);
};

const InertiaKernels& inertia_kernels();

}  // namespace visviva
