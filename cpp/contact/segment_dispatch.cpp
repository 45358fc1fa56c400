#include <cstring>

#include "core/dispatch.hpp"
#include "segment.hpp"

namespace visviva {

namespace isa_base {
extern const SegmentKernels segment_table;
}
#ifdef VISVIVA_X86
namespace isa_v3 {
extern const SegmentKernels segment_table;
}
namespace isa_v4 {
extern const SegmentKernels segment_table;
}
#endif

const SegmentKernels& segment_kernels() {
#ifdef VISVIVA_X86
    if (std::strcmp(kernels().name, "isa_v4") == 0) return isa_v4::segment_table;
    if (std::strcmp(kernels().name, "isa_v3") == 0) return isa_v3::segment_table;
#endif
    return isa_base::segment_table;
}

}  // namespace visviva
