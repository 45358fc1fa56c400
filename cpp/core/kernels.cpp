// Compiled once per instruction set; see CMakeLists.txt. Nothing here may instantiate std:: templates: the
// linker could keep the copy made for a newer processor for everybody.
#include "block_lu_kernels.hpp"
#include "dispatch.hpp"
#include "inertia_kernel.hpp"
#include "rigid_kernel.hpp"
#include "sparse_kernel.hpp"
#include "strain_kernel.hpp"
#include "vector_kernel.hpp"

namespace visviva::VISVIVA_ISA {

extern const Kernels table;
const Kernels table = {
    strain_begin,          strain_strains,         strain_residual,       strain_tangent, strain_ledger,
    inertia_residual,      inertia_tangent,        inertia_ledger,        vector_update,  vector_affine,
    vector_largest,        vector_differences,     rigid_force,           rigid_balance,  rigid_expand,
    {lu_factor, lu_solve}, block_multiply<double>, block_multiply<float>, add_product};

}  // namespace visviva::VISVIVA_ISA
