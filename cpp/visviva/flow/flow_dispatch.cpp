#include "visviva/base/instructions.hpp"
#include "visviva/flow/flow.hpp"

namespace visviva {

VISVIVA_DECLARE(FlowKernels, flow_table)

const FlowKernels& flow_kernels() { return VISVIVA_CHOOSE(flow_table, instructions()); }

}  // namespace visviva
