#include "solid_dispatch.hpp"

#include <cstring>

#include "dispatch.hpp"

namespace visviva {

namespace isa_base {
extern const SolidKernels solid_table;
extern const MixedKernels mixed_tables[4];
}  // namespace isa_base
#ifdef VISVIVA_X86
namespace isa_v3 {
extern const SolidKernels solid_table;
extern const MixedKernels mixed_tables[4];
}  // namespace isa_v3
namespace isa_v4 {
extern const SolidKernels solid_table;
extern const MixedKernels mixed_tables[4];
}  // namespace isa_v4
#endif

const SolidKernels& solid_kernels() {
#ifdef VISVIVA_X86
    if (std::strcmp(kernels().name, "isa_v4") == 0) return isa_v4::solid_table;
    if (std::strcmp(kernels().name, "isa_v3") == 0) return isa_v3::solid_table;
#endif
    return isa_base::solid_table;
}

const MixedKernels& mixed_kernels(int dim, bool fbar) {
    const int k = (dim == 3 ? 2 : 0) + (fbar ? 0 : 1);
#ifdef VISVIVA_X86
    if (std::strcmp(kernels().name, "isa_v4") == 0) return isa_v4::mixed_tables[k];
    if (std::strcmp(kernels().name, "isa_v3") == 0) return isa_v3::mixed_tables[k];
#endif
    return isa_base::mixed_tables[k];
}

}  // namespace visviva
