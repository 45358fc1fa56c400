// Constant mass between the nodes of an element: residual M times the second rate (motion) or rate
// (transport).
#pragma once
#include <cstdint>

#include "visviva/term/step.hpp"

namespace visviva {

struct InertiaView {
    int n = 0, stride = 0;
    int n_nodes = 0, dim = 3, n_pairs = 0;
    int order = 2;
    const int* pair = nullptr;               // [n_pairs][2] node pairs (both triangles)
    const double* mass = nullptr;            // [n_pairs][stride]
    const int* index = nullptr;              // [n_nodes * dim][stride]
    const char* is_position = nullptr;       // [n_nodes]: counts in linear momentum
    const std::int64_t* position = nullptr;  // [n_pairs * dim][stride]
};

// Per element: kinetic energy, linear and angular momentum (dim 3 only).
struct InertiaLedger {
    double *energy, *momentum;  // [n], [6][n]
};

}  // namespace visviva
