#include "visviva/solid/solid_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(SolidKernels, solid_table)
VISVIVA_DECLARE(MixedKernels, mixed_tables[4])

const SolidKernels& solid_kernels() { return VISVIVA_CHOOSE(solid_table, instructions()); }

const MixedKernels& mixed_kernels(int dim, bool fbar) {
    const int k = (dim == 3 ? 2 : 0) + (fbar ? 0 : 1);
    return VISVIVA_CHOOSE(mixed_tables[k], instructions());
}

}  // namespace visviva
