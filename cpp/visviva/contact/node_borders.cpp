// What passes beside a surface that ends, as where faces of a body are named: behind its border there is a
// rounding, which holds what slides off and what the surface carries part of, and nothing else.
#include <algorithm>
#include <cmath>

#include "visviva/base/parallel.hpp"
#include "visviva/contact/node_to_segment.hpp"

namespace visviva::node_to_segment {

namespace {

bool is_over(const FacetShape& facet, const Vector3& y) {
    for (int s = 0; s < facet.n_simplices(); ++s) {
        const Foot foot = whole(facet, s, y);
        if (std::all_of(foot.coordinate, foot.coordinate + facet.dim, [](double c) { return c >= 0; }))
            return true;
    }
    return false;
}

// Of the body of a vertex, the triangle or the edge at one of its corners.
FacetShape side_at(const double* X, int A, const Corner& corner, int dim) {
    FacetShape side;
    side.dim = dim;
    for (const int v : {A, corner.next, corner.previous})
        if (v >= 0) side.corner[side.n++] = At(X + 3 * v);
    if (dim == 2 && corner.next < 0) std::swap(side.corner[0], side.corner[1]);
    return side;
}

}  // namespace

// Whether a vertex behind a border has come there beside the surface, and its body with it, within the step
// or before: what is deeper than rounding where a step begins, and has no side, has been beside it then.
bool NodeToSegment::goes_beside(const double* X, int A, const Found& found) const {
    const double rounding = same_place * found.facet.size();
    if (found.rim.n == 0 || found.value >= rounding || !start() || static_ || sides_.of(A).face >= 0)
        return false;
    Found before;
    const At x0(start() + 3 * A);
    if (locate_nearest(start(), A, x0, before) == Reach::near && before.rim.n > 0 && before.value < -rounding)
        return true;
    return entrance(start(), X, A) < 0 && !lies_over(A, found.facet.normal(found.foot.simplex));
}

// Whether the body of a vertex looks at a facet, and reaches over its middle or one of its corners: bricks as
// wide as what they lie on bulge, so that all their vertices are beside that.
bool NodeToSegment::reaches_over(const double* X, int A, const FacetShape& facet) const {
    const Vector3 normal = facet.normal(0);
    const NormalField& own = around_.corners.empty() ? normals_ : around_;
    for (int k = own.start[A]; k < own.start[A + 1]; ++k) {
        FacetShape side = side_at(X, A, own.corners[k], facet.dim);
        if (side.normal(0).dot(normal) >= facing) continue;
        for (int i = 0; i < side.n; ++i) side.corner[i] -= facet.height(0, side.corner[i]) * normal;
        if (is_over(side, facet.corner[FacetShape::centre]) ||
            std::any_of(facet.corner, facet.corner + facet.n,
                        [&](const Vector3& corner) { return is_over(side, corner); }))
            return true;
    }
    return false;
}

// Vertices over the surface when a step begins, or with a side that is, no farther off than they see.
void NodeToSegment::find_over(const double* X) {
    over_.clear();
    if (std::none_of(border_.begin(), border_.end(), [](char b) { return b != 0; })) return;
    std::vector<char> over(n_own(), 0);
    parallel_for(n_own(), [&](int A) {
        const At x(X + 3 * A);
        over[A] = std::any_of(candidates_[A].begin(), candidates_[A].end(), [&](const Candidate& c) {
            const FacetShape facet = shape(X, c.facet);
            return std::abs(facet.height(0, x)) <= sight(A, c.facet) &&
                   (is_over(facet, x) || reaches_over(X, A, facet));
        });
    });
    for (int A = 0; A < n_own(); ++A)
        if (over[A]) over_.push_back(A);
}

// Whether the surface carries part of the body of a vertex: this, or others along the surface, were over it.
bool NodeToSegment::lies_over(int A, const Vector3& normal) const {
    constexpr double steep = 0.5;  // sine of the angle between both
    const At x(start() + 3 * (A % n_own()));
    return std::any_of(over_.begin(), over_.end(), [&](int v) {
        const Vector3 along = At(start() + 3 * v) - x;
        return std::abs(normal.dot(along)) <= steep * along.norm();
    });
}

}  // namespace visviva::node_to_segment
