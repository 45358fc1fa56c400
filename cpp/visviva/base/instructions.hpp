// The instruction sets that kernels are compiled for, one namespace each, and which of them this machine
// uses.
#pragma once
#include <vector>

namespace visviva {

enum class Instructions { base, v3, v4 };

/// Instruction sets that this core was compiled for and this processor has, the narrowest first.
std::vector<Instructions> available();

/// The best of them; VISVIVA_ISA=base|v3|v4 in the environment forces one, and throws if it is not there.
Instructions instructions();

/// The same for kernels that have few elements to work on or copy more than they multiply: never the widest
/// registers unless forced, whose lanes stay empty and for which some processors lower their clock.
Instructions light_instructions();

const char* name(Instructions);

// Of the tables with this name in the namespaces of all instruction sets the chosen one.
#ifdef VISVIVA_X86
#define VISVIVA_DECLARE(type, table) \
    namespace isa_base {             \
    extern const type table;         \
    }                                \
    namespace isa_v3 {               \
    extern const type table;         \
    }                                \
    namespace isa_v4 {               \
    extern const type table;         \
    }
#define VISVIVA_CHOOSE(table, chosen)                      \
    (chosen == Instructions::v4   ? visviva::isa_v4::table \
     : chosen == Instructions::v3 ? visviva::isa_v3::table \
                                  : visviva::isa_base::table)
#else
#define VISVIVA_DECLARE(type, table) \
    namespace isa_base {             \
    extern const type table;         \
    }
#define VISVIVA_CHOOSE(table, chosen) (visviva::isa_base::table)
#endif

}  // namespace visviva
