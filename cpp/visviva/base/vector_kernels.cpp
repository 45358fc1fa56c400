// Compiled once per instruction set; see CMakeLists.txt. Nothing here may instantiate std:: templates: the
// linker could keep the copy made for a newer processor for everybody.
#include "visviva/base/vector_dispatch.hpp"
#include "visviva/base/vector_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const VectorKernels vector_table;
const VectorKernels vector_table = {vector_update, vector_affine, vector_largest, vector_differences};

}  // namespace visviva::VISVIVA_ISA
