#include "visviva/point/assumed_dispatch.hpp"

#include "visviva/base/instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(AssumedKernels, assumed_table)

const AssumedKernels& assumed_kernels() { return VISVIVA_CHOOSE(assumed_table, instructions()); }

}  // namespace visviva
