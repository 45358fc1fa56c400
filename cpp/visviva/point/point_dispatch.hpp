// The kernels of physics at points for one instruction set.
#pragma once
#include "visviva/point/point.hpp"

namespace visviva {

/// What may be built from a strain map, an energy and a pairing; point_kernels.cpp says how.
enum class PhysicsKind : int {
    viscoelastic = 0,   // solid: C, with internal variables
    thermoelastic = 1,  // solid: C, entropy, temperature and its gradient
    damage = 2,         // solid: C, damage and its gradient
    cahn_hilliard = 3,  // concentration, its gradient, potential and its gradient
    beam = 4,           // directors: Gamma, K
    shell = 5,          // four nodes with directors: membrane, bending, shear
    layer = 6,          // of a shell whose directors stretch: C
    pressed_layer = 7,  // and its pressure
    damped_beam = 8,    // directors: Gamma, K and their rates
    conduction = 9,     // temperature and its gradient
    branch = 10,        // solid: C, with the viscous strain of a Maxwell branch
    branch_in_plane = 11,
    branch_of_revolution = 12,
};
inline constexpr int n_physics = 13;

/// What a physics expects.
struct PointShape {
    int n_groups, n_par, n_strains, n_energy, n_history;
    Group group[point_max_groups];
};

struct PointKernels {
    PointShape shape;
    void (*residual)(const PointView&, const Step&, const Vectors&, int begin, int end, double* r);
    // r may be null: the residual comes almost free.
    void (*tangent)(const PointView&, const Step&, const Vectors&, int begin, int end, double* r,
                    double* values);
    void (*ledger)(const PointView&, const Step&, const Vectors&, const double* v1, int begin, int end,
                   double* out);
    void (*strains)(const PointView&, const Step&, const Vectors&, double* e0, double* et, double* e1);
};

/// The kernels for the machine that runs.
const PointKernels& point_kernels(PhysicsKind kind);

}  // namespace visviva
