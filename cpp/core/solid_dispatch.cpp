#include "solid_dispatch.hpp"

#include <cstring>

#include "dispatch.hpp"

namespace visviva {

namespace isa_base {
extern const SolidKernels solid_table;
}
#ifdef VISVIVA_X86
namespace isa_v3 {
extern const SolidKernels solid_table;
}
namespace isa_v4 {
extern const SolidKernels solid_table;
}
#endif

const SolidKernels& solid_kernels() {
#ifdef VISVIVA_X86
    if (std::strcmp(kernels().name, "isa_v4") == 0) return isa_v4::solid_table;
    if (std::strcmp(kernels().name, "isa_v3") == 0) return isa_v3::solid_table;
#endif
    return isa_base::solid_table;
}

}  // namespace visviva
