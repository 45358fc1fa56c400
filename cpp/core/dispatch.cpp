#include "dispatch.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "instructions.hpp"

namespace visviva {

VISVIVA_DECLARE(Kernels, table)

namespace {
const char* const names[] = {"base", "v3", "v4"};

const char* forced() { return std::getenv("VISVIVA_ISA"); }

Instructions choose() {
    auto wanted = [](const char* name) { return !forced() || std::strcmp(forced(), name) == 0; };
#ifdef VISVIVA_X86
    if (wanted("v4") && __builtin_cpu_supports("x86-64-v4")) return Instructions::v4;
    if (wanted("v3") && __builtin_cpu_supports("x86-64-v3")) return Instructions::v3;
#endif
    (void)wanted;
    return Instructions::base;
}
}  // namespace

const char* name(Instructions set) { return names[static_cast<int>(set)]; }

Instructions instructions() {
    static const Instructions chosen = choose();
    return chosen;
}

Instructions light_instructions() {
    static const Instructions chosen = forced() ? instructions() : std::min(instructions(), Instructions::v3);
    return chosen;
}

const Kernels& kernels() {
    static const Kernels& chosen = VISVIVA_CHOOSE(table, light_instructions());
    return chosen;
}

const LuKernels& lu_kernels() { return kernels().lu; }

}  // namespace visviva
