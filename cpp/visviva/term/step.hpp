// The step under way as a scheme describes it to the terms: a handful of numbers.
#pragma once

namespace visviva {

enum class Stress : int {
    at_theta = 0,           // S = W'(e(x_theta))
    discrete_gradient = 1,  // S . (e1 - e0) = W(e1) - W(e0) exactly (Gonzalez 1996)
};

struct Step {
    // Of the step that stands for an instant: no clock notices it, and users may divide by it.
    static constexpr double no_length = 1e-100;

    double t0 = 0, t1 = 0, te = 0, h = 0;  // ends, evaluation time of loads, length
    double theta = 1;                      // x_theta = x0 + theta (x1 - x0): strain gradients and loads
    double theta_g = 1;                    // the same for constraint gradients
    Stress stress = Stress::at_theta;
    bool projects_rates = false;  // at the end onto the constraints, see rates.cpp
    // The rates at the evaluation point and the history at the end, linear in (dx, v, a, w); rows: rate,
    // second rate, v1, a1, w1. One table for motion (order 2), one for transport of contents (order 1), and
    // one for velocities of flows (order 1), whose rates at the start are smooth: they need no first step.
    double motion[5][4] = {};
    double transport[5][4] = {};
    double flow[5][4] = {};

    bool has_length() const { return h > no_length; }
    // Increments of positions make no velocities: in load steps, and at an instant, which has no increments.
    bool is_static() const { return motion[0][0] == 0; }
    // By accelerations or by rates at the end: generalised alpha with rho = 0 balances without accelerations.
    bool motion_remembers() const { return motion[1][2] != 0 || motion[2][2] != 0; }
    bool uses_history() const { return motion_remembers() || transport[0][2] != 0; }
    // Contents take the step without a history that motion has: a first one, see Scheme.first.
    bool begins_transport() const { return motion_remembers() && transport[0][2] == 0; }
    // Backward Euler in contents, alone or as the first step of another scheme.
    bool goes_to_ends() const {
        return has_length() && stress == Stress::at_theta && theta == 1 && transport[0][0] != 0 &&
               transport[0][2] == 0;
    }
    // Statics and schemes of second order that balance forces at the end of the step.
    bool balances_ends() const { return (is_static() && transport[0][0] == 0) || uses_history(); }
    // Rates contain those of earlier steps and may point against the way of this one. Damping books its work
    // by the mean rate of the step, in its middle: of second order, and never a gain.
    bool remembers() const { return uses_history() && h != 0; }
};

// Prescribed functions of time, evaluated once per step: at t0, te, t1 and the rate at t1.
struct Signals {
    const double *at0 = nullptr, *ate = nullptr, *at1 = nullptr, *rate1 = nullptr;
};

// The evaluation vectors of one iteration, one entry per unknown (fixed ones included).
struct Vectors {
    const double *x0 = nullptr, *x1 = nullptr;
    const double *rate = nullptr, *second_rate = nullptr;  // at the evaluation point
    const double* v0 = nullptr;                            // rates at the start of the step
};

}  // namespace visviva
