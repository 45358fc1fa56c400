// Rigid bodies as the null-space reduction sees them, for the kernels.
#pragma once

namespace visviva {

// The trial configuration x1 and where constraint gradients are taken, x0 + theta_g (x1 - x0); by unknown.
struct Place {
    const double *x0, *x1;
    double theta_g;
};

struct RigidView {
    int n = 0, stride = 0;
    const int* q = nullptr;           // [12][stride] position and directors
    const int* multiplier = nullptr;  // [6][stride] of orthonormality
    const int* at = nullptr;          // [stride] first reduced unknown
};

}  // namespace visviva
