#include "visviva/base/instructions.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

namespace visviva {

namespace {
const char* const names[] = {"base", "v3", "v4"};

// None where it is empty.
const char* forced() {
    const char* name = std::getenv("VISVIVA_ISA");
    return name && *name ? name : nullptr;
}

Instructions choose() {
    const std::vector<Instructions> sets = available();
    if (!forced()) return sets.back();
    std::string known;
    for (const Instructions set : sets) {
        if (std::strcmp(forced(), name(set)) == 0) return set;
        known += std::string(known.empty() ? "" : ", ") + name(set);
    }
    throw std::runtime_error("VISVIVA_ISA=" + std::string(forced()) +
                             " is no instruction set that this core and this processor have; they have " +
                             known);
}
}  // namespace

std::vector<Instructions> available() {
    std::vector<Instructions> sets = {Instructions::base};
#ifdef VISVIVA_X86
    if (__builtin_cpu_supports("x86-64-v3")) sets.push_back(Instructions::v3);
    if (__builtin_cpu_supports("x86-64-v4")) sets.push_back(Instructions::v4);
#endif
    return sets;
}

const char* name(Instructions set) { return names[static_cast<int>(set)]; }

Instructions instructions() {
    static const Instructions chosen = choose();
    return chosen;
}

Instructions light_instructions() {
    static const Instructions chosen = forced() ? instructions() : std::min(instructions(), Instructions::v3);
    return chosen;
}

}  // namespace visviva
