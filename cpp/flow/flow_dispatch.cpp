#include <cstring>

#include "core/dispatch.hpp"
#include "flow.hpp"

namespace visviva {

namespace isa_base {
extern const FlowKernels flow_table;
}
#ifdef VISVIVA_X86
namespace isa_v3 {
extern const FlowKernels flow_table;
}
namespace isa_v4 {
extern const FlowKernels flow_table;
}
#endif

const FlowKernels& flow_kernels() {
#ifdef VISVIVA_X86
    if (std::strcmp(kernels().name, "isa_v4") == 0) return isa_v4::flow_table;
    if (std::strcmp(kernels().name, "isa_v3") == 0) return isa_v3::flow_table;
#endif
    return isa_base::flow_table;
}

}  // namespace visviva
