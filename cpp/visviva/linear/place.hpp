#pragma once

namespace visviva {

// The trial configuration x1 and where constraint gradients are taken, x0 + theta_g (x1 - x0); by unknown.
struct Place {
    const double *x0, *x1;
    double theta_g;
};

}  // namespace visviva
