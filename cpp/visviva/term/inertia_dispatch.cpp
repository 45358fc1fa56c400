#include "visviva/term/inertia_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(InertiaKernels, inertia_table)

const InertiaKernels& inertia_kernels() {
    static const InertiaKernels& chosen = VISVIVA_CHOOSE(inertia_table, light_instructions());
    return chosen;
}

}  // namespace visviva
