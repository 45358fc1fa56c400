#include "visviva/point/point_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(PointKernels, point_tables[n_physics])
VISVIVA_DECLARE(PointKernels, phase_tables[n_phase_physics])
VISVIVA_DECLARE(PointKernels, heated_tables[n_heated_physics])

const PointKernels& point_kernels(PhysicsKind kind) {
    const int k = static_cast<int>(kind), plain = k - n_phase_physics, heated = plain - n_physics;
    if (plain < 0) return VISVIVA_CHOOSE(phase_tables[k], instructions());
    if (heated >= 0) return VISVIVA_CHOOSE(heated_tables[heated], instructions());
    return VISVIVA_CHOOSE(point_tables[plain], instructions());
}

}  // namespace visviva
