// The kernels of strains for the instruction set chosen once at load time.
#pragma once
#include "visviva/strain/strain.hpp"

namespace visviva {

struct StrainKernels {
    void (*begin)(const StrainView&, const double* x);
    void (*strains)(const StrainView&, const Step&, const Vectors&);
    void (*residual)(const StrainView&, const Step&, const Vectors&, const Signals&, double* r);
    void (*tangent)(const StrainView&, const Step&, const Vectors&, const Signals&, double* values);
    void (*ledger)(const StrainView&, const Step&, const Vectors&, const Signals&, const double* v1,
                   const StrainLedger&);
};

const StrainKernels& strain_kernels();

}  // namespace visviva
