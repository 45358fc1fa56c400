// The kernels of solids, compiled once per instruction set like kernels.cpp; a translation unit of its own
// because its arithmetic may assume finite numbers, which lets constant derivatives drop out.
#include "visviva/solid/solid_dispatch.hpp"
#include "visviva/solid/solid_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const SolidKernels solid_table;
const SolidKernels solid_table = {solid_residual, solid_tangent, solid_ledger,     solid_strains,
                                  solid_fields,   solid_forces,  material_response};

}  // namespace visviva::VISVIVA_ISA
