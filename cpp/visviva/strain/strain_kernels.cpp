// Compiled once per instruction set; see CMakeLists.txt. Nothing here may instantiate std:: templates: the
// linker could keep the copy made for a newer processor for everybody.
#include "visviva/strain/strain_dispatch.hpp"
#include "visviva/strain/strain_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const StrainKernels strain_table;
const StrainKernels strain_table = {strain_begin, strain_strains, strain_residual, strain_tangent,
                                    strain_ledger};

}  // namespace visviva::VISVIVA_ISA
