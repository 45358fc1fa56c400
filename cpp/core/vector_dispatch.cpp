#include "vector_dispatch.hpp"

#include "instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(VectorKernels, vector_table)

const VectorKernels& vector_kernels() {
    static const VectorKernels& chosen = VISVIVA_CHOOSE(vector_table, light_instructions());
    return chosen;
}

}  // namespace visviva
