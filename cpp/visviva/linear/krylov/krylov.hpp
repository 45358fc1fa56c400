// Krylov's methods for A x = b, right-preconditioned.
#pragma once
#include "visviva/base/vectors.hpp"
#include "visviva/linear/krylov/precondition.hpp"

namespace visviva {

// A run from x with residual r = b - A x; both are brought along (r may carry rounding).
struct KrylovRun {
    const NodeMatrix& matrix;
    Preconditioning& preconditioning;
    double target;       // of |r|
    int max_iterations;  // of this run
    std::vector<double>&x, &r;
    std::vector<std::vector<double>>& basis;  // room that is kept between runs
    int iterations = 0;
    const char* trouble = nullptr;  // why it stopped early
};

void conjugate_gradients(KrylovRun&);
void gmres(KrylovRun&, int restart);
void bicgstab(KrylovRun&);

}  // namespace visviva
