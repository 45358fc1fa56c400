#include "visviva/rigid/rigid_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(RigidKernels, rigid_table)

const RigidKernels& rigid_kernels() {
    static const RigidKernels& chosen = VISVIVA_CHOOSE(rigid_table, light_instructions());
    return chosen;
}

}  // namespace visviva
