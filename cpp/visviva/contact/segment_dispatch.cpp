#include "visviva/base/instructions.hpp"
#include "visviva/contact/segment.hpp"

namespace visviva {

VISVIVA_DECLARE(SegmentKernels, segment_table)

const SegmentKernels& segment_kernels() { return VISVIVA_CHOOSE(segment_table, instructions()); }

}  // namespace visviva
