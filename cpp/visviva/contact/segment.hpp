// Mortar segments: where a facet of one surface and a facet of the other face each other. Both are projected
// onto the plane of the first one's centre, the common polygon is cut out, triangulated and integrated
// (Puso & Laursen 2004; paper refs. [10][13]).
#pragma once
#include <cmath>

namespace visviva {

/// Edges that lie along each other within this part of the facet do not cross: their crossing would slide by
/// their shift divided by their angle, which areas do not feel, but derivatives do by rounding.
inline constexpr double along_each_other = 1e-8;

inline constexpr int facet_corners = 4, segment_corners = 2 * facet_corners;
inline constexpr int segment_size = 3 * segment_corners;

/// At which distances, along the normal of the first, two facets see each other.
struct Range {
    double reach = 0;  // segments fade out from half of this on, so that gaps stay smooth; 0: never
    // Beyond these distances inside and outside of the first one a body is in between: see deepest().
    double inside = HUGE_VAL, outside = HUGE_VAL;
    bool holds(double height) const { return height > -inside && height < outside; }
};

/// Corners of two facets, three coordinates each; in the plane facets are edges, of two corners.
struct FacetPair {
    double x[segment_corners][3];  // the first facet's corners, from `facet_corners` on the second's
    int n_first, n_second;
    Range range;
    bool axisymmetric = false;  // edges stand for surfaces of revolution about the second axis
    // Dual functions of the first facet's corners by their shapes, [a][b]; null: the shapes themselves.
    const double (*dual)[facet_corners] = nullptr;
};

/// Facets that look at each other by less than this cosine fade out towards the second one.
inline constexpr double facing_full = -0.3, facing_none = -0.1;

/// Integrals over a segment, for the function N_a of every corner a of the first facet, its shape or a dual
/// one.
struct Segment {
    bool any;                                  // false: they do not face each other
    double V[facet_corners][3];                // of N_a (x2 - x1)
    double area[facet_corners];                // of N_a
    double g[facet_corners][segment_size];     // d(n_a . V_a)/dx for given covectors n_a
    double J[facet_corners][3][segment_size];  // dV/dx
    double H[segment_size][segment_size];      // d2(u . V)/dx2 for given covectors u_a
    double HD[facet_corners][segment_size];    // d2(n_a . V_a)/dx2 along a given direction
};

/// The weights of the integrals of N_a N_b (first facet) and N_a N_c (second), by corners; shapes alone.
struct SegmentWeights {
    bool any;
    double first[facet_corners][facet_corners], second[facet_corners][facet_corners];
    double area[facet_corners];
};

/// Derivatives of `first` and `second` by the corners' coordinates.
struct SegmentWeightGradients {
    double first[facet_corners][facet_corners][segment_size];
    double second[facet_corners][facet_corners][segment_size];
};

struct SegmentKernels {
    void (*value)(const FacetPair&, Segment&);
    void (*weights)(const FacetPair&, SegmentWeights&);
    void (*weight_gradients)(const FacetPair&, SegmentWeights&, SegmentWeightGradients&);
    void (*gradient)(const FacetPair&, const double (*n)[3], Segment&);
    // V and J as well, not g; `direction` null: HD is left out
    void (*second)(const FacetPair&, const double (*u)[3], const double (*n)[3], const double* direction,
                   Segment&);
};

const SegmentKernels& segment_kernels();

}  // namespace visviva
