// The pattern of the tangent.
#pragma once
#include <cstdint>
#include <vector>

namespace visviva {

// Compressed rows over the free unknowns. `unknown[eq]` is the number of equation eq in the state vectors.
struct Csr {
    int n = 0;
    std::vector<std::int64_t> row;
    std::vector<int> col;
    std::vector<int> equation, unknown;  // unknown -> equation (-1: fixed), equation -> unknown
};

}  // namespace visviva
