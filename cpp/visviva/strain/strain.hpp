// The generic strain term: forms y = B x + c (constant linear forms of the unknowns), generalised strains
// e(y) quadratic in y, and a law that turns strains into stresses S: residual B^T grad e(y_theta)^T S.
// Joints, springs, dampers, gravity, servo constraints and small solids are all instances of it.
#pragma once
#include <cstdint>
#include <vector>

#include "visviva/term/step.hpp"

namespace visviva {

enum class LawKind : int {
    linear,             // W = p0 e
    quadratic,          // W = p0/2 (e - p1)^2
    length,             // W = p0/2 (sqrt(e) - p1)^2, e a squared length
    energy_callback,    // W(e) from outside, batch level
    constraint,         // e - s(t) = 0, S = lambda
    angle,              // -e0 sin e2 + e1 cos e2 = 0: e2 is the angle of the vector (e0, e1)
    servo,              // e_j - s_j(t) = 0 for the first half, S = -u for the second half (the actuators)
    function_callback,  // Phi(e) = 0 from outside, batch level
    load,               // S = -p0 s(t)
    viscous,            // S = p0 de/dt
    viscous_length,     // force p0 dl/dt along l = sqrt(e)
    rate_callback,      // S(e, de/dt, t) from outside, batch level
    follower,           // force s(t) (e3, e4, e5) on the place (e0, e1, e2)
    torque,             // torque s(t) (e9, e10, e11) on the directors (e0..e2), (e3..e5), (e6..e8)
    couple,             // torque s(t) (e3, e4, e5), less its part along it, on the one director (e0, e1, e2)
};

// Of a law: its name in Python, and what it is. Those of rates, and others, take the state at theta whatever
// the rule of the potentials.
struct LawTraits {
    LawKind kind;
    const char* name;
    bool is_constraint = false, is_potential = false, is_callback = false, needs_rate = false,
         is_at_theta = needs_rate, is_viscous = false;
};
inline constexpr LawTraits law_traits[] = {
    {.kind = LawKind::linear, .name = "LINEAR", .is_potential = true},
    {.kind = LawKind::quadratic, .name = "QUADRATIC", .is_potential = true},
    {.kind = LawKind::length, .name = "LENGTH", .is_potential = true},
    {.kind = LawKind::energy_callback, .name = "ENERGY_CALLBACK", .is_potential = true, .is_callback = true},
    {.kind = LawKind::constraint, .name = "CONSTRAINT", .is_constraint = true},
    {.kind = LawKind::angle, .name = "ANGLE", .is_constraint = true},
    {.kind = LawKind::servo, .name = "SERVO", .is_constraint = true},
    {.kind = LawKind::function_callback,
     .name = "FUNCTION_CALLBACK",
     .is_constraint = true,
     .is_callback = true},
    {.kind = LawKind::load, .name = "LOAD"},
    {.kind = LawKind::viscous, .name = "VISCOUS", .needs_rate = true, .is_viscous = true},
    {.kind = LawKind::viscous_length, .name = "VISCOUS_LENGTH", .needs_rate = true, .is_viscous = true},
    {.kind = LawKind::rate_callback, .name = "RATE_CALLBACK", .is_callback = true, .needs_rate = true},
    {.kind = LawKind::follower, .name = "FOLLOWER", .is_at_theta = true},
    {.kind = LawKind::torque, .name = "TORQUE", .is_at_theta = true},
    {.kind = LawKind::couple, .name = "COUPLE", .is_at_theta = true},
};
constexpr const LawTraits& traits(LawKind kind) { return law_traits[static_cast<int>(kind)]; }

// Sparsity of forms, strains and tangent, which all elements of a batch share.
struct StrainShape {
    int n_x = 0, n_y = 0, n_e = 0, n_m = 0;  // unknowns, forms, strains, multipliers per element
    LawKind law = LawKind::linear;
    std::vector<int> form_row, form_col;      // entries of B: y[row] += weight * x[col]
    std::vector<int> quad_e, quad_a, quad_b;  // e[i] += coef * y[a] * y[b]
    std::vector<double> quad_coef;
    std::vector<int> lin_e, lin_a;  // e[i] += coef * y[a]
    std::vector<double> lin_coef;
    int n_local() const { return n_x + n_m; }
};

// The same as plain pointers, for the kernels.
struct ShapeView {
    int n_x, n_y, n_e, n_m;
    LawKind law;
    int n_forms, n_quad, n_lin;
    const int *form_row, *form_col, *quad_e, *quad_a, *quad_b, *lin_e, *lin_a;
    const double *quad_coef, *lin_coef;
};

// One term K_local[slot] += weight[k1] * Ky[pair] * weight[k2] of the tangent B^T Ky B.
struct Product {
    int slot, k1, pair, k2;
};
// K_local[slot] += weight[k] * gradient of strain e in form a (columns and rows of the multipliers).
struct Border {
    int slot, k, e, a, m;
};

// Plain view of a batch for the kernels; arrays are element-fastest with stride `stride` (padded).
struct StrainView {
    ShapeView shape{};
    int n = 0, stride = 0;
    const int* index = nullptr;           // [n_x + n_m][stride] unknown numbers
    const double* weight = nullptr;       // [n_forms_entries][stride]
    const double* y_const = nullptr;      // [n_y][stride]
    const double* e_const = nullptr;      // [n_e][stride]
    const double* par = nullptr;          // [n_par][stride]
    const int* signal = nullptr;          // [max(n_m, 1)][stride] signal number or -1
    double *y0 = nullptr, *e0 = nullptr;  // begin of step, [n_y][stride], [n_e][stride]
    double *e_eval = nullptr, *e_rate = nullptr, *e1 = nullptr;  // for callbacks
    // Results of a callback law, element-fastest: stress, d stress / d strain, d stress / d rate, residual of
    // a constraint, its derivative, d stress / d multiplier, energy.
    const double *cb_S = nullptr, *cb_D = nullptr, *cb_R = nullptr, *cb_Phi = nullptr, *cb_J = nullptr,
                 *cb_Jt = nullptr, *cb_W = nullptr;
    // tangent program
    int n_pairs = 0, n_slots = 0, n_products = 0, n_columns = 0, n_rows = 0;
    const int* pairs = nullptr;  // [n_pairs][2] (a, b)
    const Product* products = nullptr;
    const Border *columns = nullptr, *rows = nullptr;
    const std::int64_t* position = nullptr;  // [n_slots][stride] where in the matrix values
    double* scratch = nullptr;
};

struct StrainLedger {
    double *energy, *work, *defect, *rate_defect;  // per element
};

}  // namespace visviva
