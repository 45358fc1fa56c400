// Distance to which the facets of a surface see before their own body is in the way, and its thickness behind
// them.
#pragma once
#include <vector>

namespace visviva {

/// Infinite where the surface has no other facet there.
struct Sight {
    double behind;  // to where one leaves the body through its other side; the least over the facet
    double ahead;   // to the middle of what one would enter it by again; the largest over the facet
};

/// For every facet, [facet][facet_corners], of a surface with vertices at X, three numbers each.
std::vector<Sight> find_sights(int dim, const std::vector<double>& X, const std::vector<int>& facets);

/// Facets of a surface, [facet][facet_corners], with vertices at X, three numbers each, and the thickness of
/// the body behind each facet.
struct Side {
    std::vector<double> X;
    std::vector<int> facets;
    std::vector<double> behind;
};

/// For each facet of `own`, how deep samples of it lie in the body that the closed surface `other` encloses,
/// along their normals, if that is unseen: where no facet of it that is `touched` and does not look the same
/// way is within `reach`, or as near as thicknesses let see. It counts where the way out is through what is
/// touched; 0 elsewhere.
std::vector<double> find_unseen(int dim, const Side& own, const Side& other, const std::vector<int>& touched,
                                double reach);

/// Depth to which two bodies of these thicknesses may overlap: half way to where each of them would have
/// left the other on its far side. What lies deeper are their far sides, which face each other as well. Of a
/// surface whose other side is not known the other body's thickness is all.
double deepest(double one, double two);

}  // namespace visviva
