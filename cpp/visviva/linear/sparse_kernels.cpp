// Compiled once per instruction set; see CMakeLists.txt. Nothing here may instantiate std:: templates: the
// linker could keep the copy made for a newer processor for everybody.
#include "visviva/linear/block_lu_kernels.hpp"
#include "visviva/linear/sparse_dispatch.hpp"
#include "visviva/linear/sparse_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const SparseKernels sparse_table;
const SparseKernels sparse_table = {{lu_factor, lu_solve},
                                    block_multiply<double>,
                                    block_multiply<float>,
                                    add_product<double>,
                                    add_product<float>};

}  // namespace visviva::VISVIVA_ISA
