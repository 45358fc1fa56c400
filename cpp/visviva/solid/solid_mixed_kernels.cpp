// The kernels of F-bar and mixed elements, compiled once per instruction set like solid_kernels.cpp.
#include "visviva/solid/solid_mixed_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const MixedKernels mixed_tables[4];
const MixedKernels mixed_tables[4] = {Mixed<2, true>::table, Mixed<2, false>::table, Mixed<3, true>::table,
                                      Mixed<3, false>::table};

}  // namespace visviva::VISVIVA_ISA
