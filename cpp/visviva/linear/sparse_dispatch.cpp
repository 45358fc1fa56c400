#include "visviva/linear/sparse_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(SparseKernels, sparse_table)

const SparseKernels& sparse_kernels() {
    static const SparseKernels& chosen = VISVIVA_CHOOSE(sparse_table, light_instructions());
    return chosen;
}

const LuKernels& lu_kernels() { return sparse_kernels().lu; }

}  // namespace visviva
