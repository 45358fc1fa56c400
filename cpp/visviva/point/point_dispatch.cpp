#include "visviva/point/point_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(PointKernels, point_tables[n_physics])
VISVIVA_DECLARE(PointKernels, phase_tables[n_phase_physics])

const PointKernels& point_kernels(PhysicsKind kind) {
    const int k = static_cast<int>(kind);
    if (k < n_phase_physics) return VISVIVA_CHOOSE(phase_tables[k], instructions());
    return VISVIVA_CHOOSE(point_tables[k - n_phase_physics], instructions());
}

}  // namespace visviva
