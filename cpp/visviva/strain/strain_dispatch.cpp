#include "visviva/strain/strain_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(StrainKernels, strain_table)

const StrainKernels& strain_kernels() {
    static const StrainKernels& chosen = VISVIVA_CHOOSE(strain_table, light_instructions());
    return chosen;
}

}  // namespace visviva
