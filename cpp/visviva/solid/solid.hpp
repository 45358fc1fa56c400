// Plain data of a batch of equal solid elements for the kernels. Elements come in blocks of eight, one per
// lane; arrays are [block][...][8].
#pragma once
#include <cstdint>

#include "visviva/material/material.hpp"
#include "visviva/term/step.hpp"

namespace visviva {

inline constexpr int solid_lanes = 8;
inline constexpr int solid_common_nodes = 27;
inline constexpr int solid_max_nodes = 125;  // splines of degree 4 in space
inline constexpr int solid_max_pressures = 6;
inline constexpr int brick_points = 8;

/// What is the same for all bricks of one density: gradients of the shape functions in the unit cell
/// [point][node][3], weights of the points, and products of shape functions [point][a <= b], packed, times
/// the density.
struct BrickShapes {
    double slopes[brick_points * 8 * 3], weight[brick_points], mass[brick_points * 36];
};

struct SolidView {
    int n = 0, n_blocks = 0;        // elements, blocks
    int n_nodes = 0, n_points = 0;  // per element
    int dim = 3, n_par = 0;
    MaterialKind kind{};
    bool small = false;         // strains linear in the displacements
    bool start_stress = false;  // geometric stiffness under discrete gradients by the stress of the start
    bool damped = false;
    bool plane_stress = false;   // in two dimensions: no stress across the plane
    const int* index = nullptr;  // [node] first unknown of the node
    // Bricks: [node][3] where they are in the reference, from which the next three follow, and what they
    // share
    const double* X = nullptr;
    const BrickShapes* brick = nullptr;
    bool has_mass = false;
    const double* G = nullptr;        // [point][node][dim] gradients of the shape functions in the reference
    const double* H = nullptr;        // [point][node] weights of the hoop stretch, or null
    const double* w = nullptr;        // [point] reference volume
    const double* thermal = nullptr;  // [point] strain that heat alone would leave, or null
    const double* mass = nullptr;     // [a <= b] packed, kept for all but bricks whose mass is not lumped
    const double* par = nullptr;      // [parameter]
    const double* damping = nullptr;  // [3]: per mass, bulk-like and shear viscosity (lambda, mu)
    // F-bar: gradients and weights at the element's centre, [node][dim] and [node]
    const double *centre_G = nullptr, *centre_H = nullptr;
    // Mixed: pressures with shape functions [point][pressure] and compliance [pressure][pressure]; how they
    // measure the volume (see mixed_energy.hpp), and whether they are multipliers, without energy
    int n_pressures = 0, measure = 0;
    bool multiplier = false;
    const int* pressure_index = nullptr;  // [pressure]
    const double *shape = nullptr, *compliance = nullptr;
    // Scatter, nodes and pressures alike: place of row 0 of the node in the matrix (or -1), length of its
    // rows, offset of every column block (or 0xffff)
    const std::int64_t* row = nullptr;      // [node]
    const std::int64_t* length = nullptr;   // [node]
    const std::uint16_t* offset = nullptr;  // [a][b]
    // Evaluated outside the core from C: W, dW/dC (6) and its derivatives (36) by the six components, each an
    // array over [block][point][8]
    const double *user_W = nullptr, *user_S = nullptr, *user_D = nullptr;
    double* smallest = nullptr;  // det F at the end of the last residual, the smallest of all points
};

/// Per element: strain energy, kinetic energy, work of damping, momenta (6).
inline constexpr int solid_ledger_rows = 9;
/// Per point: deformation gradient (9), second Piola-Kirchhoff stress (6), energy.
inline constexpr int solid_field_rows = 16;

}  // namespace visviva
