#include "visviva/point/point_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(PointKernels, point_tables[n_physics])

const PointKernels& point_kernels(PhysicsKind kind) {
    return VISVIVA_CHOOSE(point_tables[static_cast<int>(kind)], instructions());
}

}  // namespace visviva
