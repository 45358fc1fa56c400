// Plain data of a batch of equal elements whose physics is written at a point: fields of any kind, strains of
// them, an energy. Elements come in blocks of eight, one per lane; arrays are [block][...][8].
#pragma once
#include <cstdint>

#include "visviva/term/step.hpp"

namespace visviva {

inline constexpr int point_lanes = 8;
inline constexpr int point_max_groups = 6;
inline constexpr int point_max_nodes = 125;

/// Compile-time description of the unknowns of an element that are interpolated alike. Its part of the
/// local unknowns at a point is y[component][column] = sum over nodes of u[node][component]
/// weight[node][column].
struct Group {
    int components, columns;
    int order;            // in time
    bool is_end = false;  // its value at the end acts, as that of multipliers, not that at theta
};

/// And what is known of them at run time.
struct PointGroup {
    int n_nodes = 0, first_slot = 0;
    bool is_position = false;         // has a part in linear momentum
    const double* weights = nullptr;  // [point][node][column]
    const double* mass = nullptr;     // [a <= b] packed, or null
};

struct PointView {
    int n = 0, n_blocks = 0;  // elements, blocks
    int n_points = 0, n_slots = 0, n_unknowns = 0, n_par = 0;
    PointGroup group[point_max_groups];
    const int* index = nullptr;   // [slot] first unknown of the slot: a node of a group
    const double* w = nullptr;    // [point] reference volume
    const double* par = nullptr;  // [point][parameter], of one point if they are the same at all
    bool is_even = false;         // they are
    const double* reference =
        nullptr;  // [point][strain] of the reference, which the energy does not see; or null
    const double* history0 = nullptr;  // [point][variable] at the start of the step
    double* history1 = nullptr;        // and at its end, as last evaluated
    // Places in the matrix, see Slots
    const std::int64_t *row = nullptr, *length = nullptr;
    const std::uint16_t* offset = nullptr;
    // Of an energy evaluated outside the core: W, its stresses s and moduli ds/de1 (or ds/de at theta),
    // arrays over [strain] (and [strain][strain]) [block][point][8]
    const double *called_W = nullptr, *called_s = nullptr, *called_T = nullptr;
    char* lost_way = nullptr;  // [element] whose internal variables found no end of the step last evaluated
    bool backwards = false;    // that step goes from its end to its start
    const double* called_lost = nullptr;  // by internal variables, or null
    // W and s of the strains at the end with the entropies of the start, see PointElement::find_excess; or
    // null
    const double *unheated_W = nullptr, *unheated_s = nullptr;
};

/// Per element: energy, kinetic energy, work dissipated by the pairing, momenta (6), what internal variables
/// lose.
inline constexpr int point_ledger_rows = 10;

}  // namespace visviva
