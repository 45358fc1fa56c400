#include "dispatch.hpp"

#include <cstdlib>
#include <cstring>

namespace visviva {

namespace isa_base {
extern const Kernels table;
}
#ifdef VISVIVA_X86
namespace isa_v3 {
extern const Kernels table;
}
namespace isa_v4 {
extern const Kernels table;
}
#endif

static const Kernels& choose() {
    const char* forced = std::getenv("VISVIVA_ISA");
    auto wanted = [&](const char* name) { return !forced || std::strcmp(forced, name) == 0; };
#ifdef VISVIVA_X86
    if (wanted("v4") && __builtin_cpu_supports("x86-64-v4")) return isa_v4::table;
    if (wanted("v3") && __builtin_cpu_supports("x86-64-v3")) return isa_v3::table;
#endif
    (void)wanted;
    return isa_base::table;
}

const Kernels& kernels() {
    static const Kernels& chosen = choose();
    return chosen;
}

const LuKernels& lu_kernels() { return kernels().lu; }

}  // namespace visviva
