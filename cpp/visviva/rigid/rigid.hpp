// Rigid bodies as the null-space reduction sees them, for the kernels.
#pragma once
#include "visviva/linear/place.hpp"

namespace visviva {

struct RigidView {
    int n = 0, stride = 0;
    const int* q = nullptr;           // [12][stride] position and directors
    const int* multiplier = nullptr;  // [6][stride] of orthonormality
    const int* at = nullptr;          // [stride] first reduced unknown
};

}  // namespace visviva
