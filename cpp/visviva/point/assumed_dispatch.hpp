// The kernels of assumed strains for one instruction set.
#pragma once
#include "visviva/point/assumed.hpp"

namespace visviva {

struct AssumedKernels {
    void (*residual)(const AssumedView&, const Step&, const Vectors&, int begin, int end, double* r);
    // r may be null.
    void (*tangent)(const AssumedView&, const Step&, const Vectors&, int begin, int end, double* r,
                    double* values);
    void (*energy)(const AssumedView&, const double* x, int begin, int end, double* out);  // [element]
};

/// The kernels for the machine that runs.
const AssumedKernels& assumed_kernels();

}  // namespace visviva
