// Compiled once per instruction set; see CMakeLists.txt. Nothing here may instantiate std:: templates: the
// linker could keep the copy made for a newer processor for everybody.
#include "visviva/term/inertia_dispatch.hpp"
#include "visviva/term/inertia_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const InertiaKernels inertia_table;
const InertiaKernels inertia_table = {inertia_residual, inertia_tangent, inertia_ledger};

}  // namespace visviva::VISVIVA_ISA
