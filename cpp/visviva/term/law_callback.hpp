// Laws and materials that are evaluated outside the core.
#pragma once
#include <functional>

#include "visviva/term/step.hpp"

namespace visviva {

// A law evaluated outside the core, at batch level. Arrays are [n_e][stride] and so on, element-fastest.
struct LawArguments {
    int n, stride, n_e, n_m;
    bool want_tangent;
    double t, h;
    Stress stress;
    const double *e0, *e1, *e_eval, *e_rate, *lambda;
    double *S, *D, *R, *Phi, *J, *Jt, *W;
    // Energies with internal variables [n_h][stride]: at the start, at the end, and what they lose in the
    // step.
    int n_h = 0;
    const double* h0 = nullptr;
    double *h1 = nullptr, *lost = nullptr;
};
using LawCallback = std::function<void(const LawArguments&)>;

}  // namespace visviva
