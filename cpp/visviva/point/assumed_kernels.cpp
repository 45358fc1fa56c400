// Compiled once per instruction set; see CMakeLists.txt.
#include "visviva/point/assumed_dispatch.hpp"
#include "visviva/point/assumed_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const AssumedKernels assumed_table;
const AssumedKernels assumed_table = {assumed_residual, assumed_tangent, assumed_energy};

}  // namespace visviva::VISVIVA_ISA
