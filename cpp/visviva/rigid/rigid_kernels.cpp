// Compiled once per instruction set; see CMakeLists.txt. Nothing here may instantiate std:: templates: the
// linker could keep the copy made for a newer processor for everybody.
#include "visviva/rigid/rigid_dispatch.hpp"
#include "visviva/rigid/rigid_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const RigidKernels rigid_table;
const RigidKernels rigid_table = {rigid_force, rigid_balance, rigid_expand};

}  // namespace visviva::VISVIVA_ISA
