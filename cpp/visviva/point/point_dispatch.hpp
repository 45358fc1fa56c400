// The physics, see physics_list.hpp and heated_list.hpp, and their kernels for the machine that
// runs.
#pragma once
#include <iterator>

#include "visviva/point/point.hpp"

namespace visviva {

enum class PhysicsKind : int {
#define VISVIVA_PHYSICS(physics, ...) physics,
#include "visviva/point/phase_list.hpp"
#include "visviva/point/physics_list.hpp"
// and behind them, in this order
#include "visviva/point/heated_list.hpp"
#undef VISVIVA_PHYSICS
};

struct PhysicsTraits {
    PhysicsKind kind;
    const char* name;  // in Python
};
inline constexpr PhysicsTraits physics_traits[] = {
#define VISVIVA_PHYSICS(physics, python, ...) {PhysicsKind::physics, #python},
#include "visviva/point/phase_list.hpp"
#include "visviva/point/physics_list.hpp"
// and behind them, in this order
#include "visviva/point/heated_list.hpp"
#undef VISVIVA_PHYSICS
};
#define VISVIVA_PHYSICS(physics, ...) +1
inline constexpr int n_phase_physics = 0
#include "visviva/point/phase_list.hpp"
    ;
inline constexpr int n_physics = 0  // neither of phases nor with heat
#include "visviva/point/physics_list.hpp"
    ;
#undef VISVIVA_PHYSICS
inline constexpr int n_heated_physics =
    static_cast<int>(std::size(physics_traits)) - n_phase_physics - n_physics;

/// Arrays that a physics expects.
struct PointShape {
    int n_groups, n_par, n_strains, n_energy, n_history;
    int first_entropy, n_entropies;  // among the strains of the energy
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

const PointKernels& point_kernels(PhysicsKind kind);

}  // namespace visviva
