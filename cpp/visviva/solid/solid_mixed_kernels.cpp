// The kernels of F-bar and mixed elements, compiled once per instruction set like solid_kernels.cpp.
#include "visviva/solid/solid_mixed_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const MixedKernels mixed_tables[4];
const MixedKernels mixed_tables[4] = {Mixed<FbarMap<2>>::table, Mixed<PressureMap<2>>::table,
                                      Mixed<FbarMap<3>>::table, Mixed<PressureMap<3>>::table};

}  // namespace visviva::VISVIVA_ISA
