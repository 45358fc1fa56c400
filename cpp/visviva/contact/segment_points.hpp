// The quadrature points of mortar segments, for surfaces that stay together: integrals over them are made
// once.
#pragma once
#include <vector>

#include "visviva/contact/segment.hpp"

namespace visviva {

/// Share of the area, and shape functions of both facets.
struct SegmentPoint {
    double weight, first[facet_corners], second[facet_corners];
};

/// A point of a rule on triangles: coordinates and share of the area.
struct RulePoint {
    double a, b, w;
};

/// Appends the points of a pair's segment, if there is one, with this rule on its triangles.
void add_points(const FacetPair& pair, const std::vector<RulePoint>& rule, std::vector<SegmentPoint>& out);

}  // namespace visviva
