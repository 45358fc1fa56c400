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

// Vertices over the surface when a step begins.
void NodeToSegment::find_over(const double* X) {
    over_.clear();
    if (std::none_of(border_.begin(), border_.end(), [](char b) { return b != 0; })) return;
    over_.assign(n_own(), 0);
    parallel_for(n_own(), [&](int A) {
        const At x(X + 3 * A);
        over_[A] = std::any_of(candidates_[A].begin(), candidates_[A].end(),
                               [&](const Candidate& c) { return is_over(shape(X, c.facet), x); });
    });
}

// Whether the surface carries part of the body of a vertex: this was over that, or others are, along it.
bool NodeToSegment::lies_over(int A, const Vector3& normal) const {
    constexpr double steep = 0.5;  // sine of the angle between both
    const At x(start() + 3 * (A % n_own()));
    if (!over_.empty() && over_[A % n_own()]) return true;
    for (int v = 0; v < static_cast<int>(over_.size()); ++v) {
        const Vector3 along = At(start() + 3 * v) - x;
        if (over_[v] && std::abs(normal.dot(along)) <= steep * along.norm()) return true;
    }
    return false;
}

}  // namespace visviva::node_to_segment
