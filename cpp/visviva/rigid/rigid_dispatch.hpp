// The kernels of rigid bodies for the instruction set chosen once at load time.
#pragma once
#include "visviva/rigid/rigid.hpp"

namespace visviva {

struct RigidKernels {
    void (*force)(const RigidView&, const double* r, const Place&, double* s);
    void (*balance)(const RigidView&, const double* r, const Place&, double* dx, double* x1);
    void (*expand)(const RigidView&, const double* s, const Place&, double* d);
};

const RigidKernels& rigid_kernels();

}  // namespace visviva
