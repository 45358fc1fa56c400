#include "visviva/base/vector_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(VectorKernels, vector_table)

const VectorKernels& vector_kernels() {
    static const VectorKernels& chosen = VISVIVA_CHOOSE(vector_table, light_instructions());
    return chosen;
}

}  // namespace visviva
