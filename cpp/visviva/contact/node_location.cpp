// Where a vertex is with respect to the facets near it: the closest point, inside or outside, and by which
// side it came in.
#include <algorithm>
#include <cmath>

#include "visviva/contact/node_to_segment.hpp"

namespace visviva::node_to_segment {

namespace {

// Distance of x from its foot in the direction of the simplex' middle.
double towards(const FacetShape& facet, const Foot& foot, const Vector3& x) {
    const Vector3 y = facet.place(foot);
    return (x - y).dot((facet.middle(foot.simplex) - y).normalized());
}

// Height of a point above the plane of a simplex.
double above(const Found& found, const Vector3& x) { return found.facet.height(found.foot.simplex, x); }

// Distance of a point beside a simplex, relative to the length of its first edge.
double beside(const Found& found, const Vector3& x) {
    const FacetShape& facet = found.facet;
    const Vector3 &a = facet.corner[facet.vertex(found.foot.simplex, 0)],
                  &b = facet.corner[facet.vertex(found.foot.simplex, 1)];
    const Vector3 w = x - facet.place(found.foot);
    return (w - above(found, x) * found.normal).norm() / (b - a).norm();
}

}  // namespace

// The closest simplex to a place of the vertex of all, or of those that face it; where several meet at the
// closest point, the one on whose side of it the place is. Where the vertex belongs to a side, of what looks
// there.
Found NodeToSegment::pick(const double* X, int A, const Vector3& x, bool only_facing, int side) const {
    Found found;
    Vector3 own;
    if (!normals_.normal(X, A, own.data())) own.setZero();
    constexpr double same = 1e-12;  // relative
    const Kept& before = kept_[A];
    Found kept;
    double kept_aside = 0;  // beside the simplex, by its size
    double least = options_.reach + options_.radius, aside = -HUGE_VAL;
    for (const Candidate& c : candidates_[A]) {
        if (side >= 0 && !are_same(X, side, c.facet)) continue;
        const FacetShape facet = shape(X, c.facet);
        for (int s = 0; s < facet.n_simplices(); ++s) {
            const Vector3 n = facet.normal(s);
            const bool faces = own.isZero() || own.dot(n) < facing;
            if (n.isZero() || (only_facing && !faces)) continue;
            const Foot foot = closest(facet, s, x);
            if (before.is(c.facet, s)) {
                kept = {&c, facet, foot, {}, n, 0, faces};
                kept_aside = beside(kept, x);
            }
            if (foot.distance > (1 + same) * least) continue;
            const double side = towards(facet, foot, x);
            if (foot.distance >= (1 - same) * least && side <= aside) continue;
            least = foot.distance, aside = side;
            found = {&c, facet, foot, {}, n, 0, faces};
        }
    }
    if (!kept.candidate || passes_by(X, A, x, kept, found)) return found;
    const double jump = std::abs(std::abs(above(kept, x)) - least);
    const bool is_near = !exact_ || deforms(A) || jump <= same_place * kept.facet.size();
    kept.stays = (kept_aside <= same_place && is_near) ||
                 (static_ && kept_aside <= near_place && jump <= near_gap * kept.facet.size());
    kept.goes_on = !kept.stays && before.touches && meets_wall(X, A, kept, found);
    kept.stays = kept.stays || kept.goes_on;
    return kept.stays ? kept : found;
}

// Whether a vertex of a rigid body has come behind what it was above around an edge, outside of the body:
// what slides on a face passes the walls that end there.
bool NodeToSegment::passes_by(const double* X, int A, const Vector3& x, const Found& kept,
                              const Found& found) const {
    if (deforms(A) || above(kept, x) >= 0 || !found.candidate) return false;
    if (are_same(X, kept.candidate->facet, found.candidate->facet)) return false;
    Found there = found;
    return sign(X, x, there) == Reach::near && there.value + there.normal.dot(nudged(X, A) - x) >= 0;
}

// Whether what a vertex has come to in a step leans to what it touched when that began. It goes on along that
// until the end of the step: there it meets the other one, by an impact. Forces of one step are no impact on
// the other one: along both they would do no work, and no energy would be lost, whatever is thrown back.
// Vertices without copies would sink where facets lean together over them.
bool NodeToSegment::meets_wall(const double* X, int A, const Found& kept, const Found& found) const {
    if (static_ || !keeps_ || options_.copies == 1) return false;
    const Vector3 place = found.facet.place(found.foot);
    return std::any_of(candidates_[A].begin(), candidates_[A].end(), [&](const Candidate& c) {
        const FacetShape facet = shape(X, c.facet);
        for (int s = 0; s < facet.n_simplices(); ++s)
            if (lean_together(kept.facet, kept.foot.simplex, facet, s, apart) &&
                closest(facet, s, place).distance <= apart * facet.size())
                return true;
        return false;
    });
}

bool NodeToSegment::turns_uphill(const double* from, const double* to, int A) const {
    constexpr double same_surface = 0.98;  // least agreement of normals
    Found before, after;
    if (locate(from, A, before) != Reach::near || locate(to, A, after) != Reach::near) return false;
    const FacetShape facet = shape(to, before.candidate->facet);
    const int s = before.foot.simplex, t = after.foot.simplex;
    return facet.normal(s).dot(after.facet.normal(t)) < same_surface &&
           lean_together(facet, s, after.facet, t, apart);
}

// A direction that points out of the body where the closest point is on an edge or at a vertex.
Vector3 NodeToSegment::outwards(const double* X, const Found& found, bool& border) const {
    const Foot& foot = found.foot;
    const int f = found.candidate->facet, n = found.facet.n;
    border = false;
    if (std::find(foot.vertex, foot.vertex + foot.n, FacetShape::centre) != foot.vertex + foot.n) {
        Vector3 sum = Vector3::Zero();
        for (int s = 0; s < found.facet.n_simplices(); ++s) sum += found.facet.normal(s);
        return sum;
    }
    if (foot.n == 1) {
        const int v = skin_.corners(f)[foot.vertex[0]];
        border = border_[v];
        return normals_.by_angles(X, v);
    }
    const int corner = (foot.vertex[0] + 1) % n == foot.vertex[1] ? foot.vertex[0] : foot.vertex[1];
    const int other = across_[facet_corners * f + corner];
    border = other < 0;
    if (border) return found.normal;
    const FacetShape beyond = shape(X, other);
    for (int s = 0; s < beyond.n_simplices(); ++s) {
        const int v = skin_.corners(other)[beyond.vertex(s, 0)],
                  w = skin_.corners(other)[beyond.vertex(s, 1)];
        const int a = skin_.corners(f)[foot.vertex[0]], b = skin_.corners(f)[foot.vertex[1]];
        if (beyond.n == 3 || (v == a && w == b) || (v == b && w == a)) return found.normal + beyond.normal(s);
    }
    return found.normal;
}

// The signed distance and its gradient.
PointGaps::Reach NodeToSegment::sign(const double* X, const Vector3& x, Found& found) const {
    if (!found.candidate) return Reach::far;
    const FacetShape& facet = found.facet;
    const double d = found.foot.distance;
    found.value = above(found, x);
    if (found.foot.n == facet.dim) return Reach::near;
    bool border;
    const Vector3 out = outwards(X, found, border);
    const Vector3 w = x - facet.place(found.foot);
    const double aside = beside(found, x);
    const bool rolls = options_.radius > 0;  // off an edge, as balls are round themselves
    if ((border && !rolls) || found.stays || aside <= same_place) {
        if (border && !rolls && aside > on_border) {
            found.rim = found.foot;
            const Expansion gap = beyond_border(facet, found.rim, roundness, x);
            found.value = gap.value, found.normal = gap.gradient.head<3>();
        }
        found.foot = whole(facet, found.foot.simplex, x);
        return Reach::near;
    }
    found.value = w.dot(out) < 0 && !border ? -d : d;
    found.normal = w / found.value;
    return Reach::near;
}

// If it lies behind what is nearest, or by rounding before it. What is outside around an edge, as its body
// leads away from both facets there, has none: the way that it goes on tells.
int NodeToSegment::nearest_side(const double* X, int A) const {
    Found found;
    const bool is_inside = locate_nearest(X, A, At(X + 3 * A), found) == Reach::near &&
                           found.value < same_place * found.facet.size() && !goes_beside(X, A, found);
    if (!is_inside || locate_nearest(X, A, nudged(X, A), found) != Reach::near) return Sides::nearest;
    const double* shares = found.foot.coordinate;
    const bool is_beside = found.foot.n < found.facet.dim ||
                           std::any_of(shares, shares + found.foot.n, [](double share) { return share < 0; });
    const bool is_before = is_beside || !looks(X, A, found.facet.normal(found.foot.simplex));
    return found.value > 0 && is_before ? Sides::nearest : found.candidate->facet;
}

// Whether what is found is beyond a side: of another one, or on what that shares with another one.
bool NodeToSegment::leaves(const double* X, int A, const Found& found, int side) const {
    const Foot& foot = found.foot;
    if (!are_same(X, found.candidate->facet, side)) return true;
    if (foot.n == found.facet.dim) return false;
    const int* own = skin_.corners(found.candidate->facet);
    return std::any_of(candidates_[A].begin(), candidates_[A].end(), [&](const Candidate& c) {
        const int *corners = skin_.corners(c.facet), *end = corners + skin_.n_corners(c.facet);
        const bool shares = std::all_of(foot.vertex, foot.vertex + foot.n, [&](int v) {
            return v != FacetShape::centre && std::find(corners, end, own[v]) != end;
        });
        return shares && !are_same(X, c.facet, side);
    });
}

// The walls of a room are one side where the potential of a penalty counts: what goes from one to the other
// does not come out between them.
bool NodeToSegment::are_same(const double* X, int side, int other) const {
    const FacetShape one = shape(X, side), two = shape(X, other);
    return one.normal(0).dot(two.normal(0)) > same_side || (!keeps_ && lean_together(one, 0, two, 0, apart));
}

// The facet that the vertex passes last from before it to behind it, as both move straight, or if it cannot
// touch that the nearest that it can.
int NodeToSegment::entrance(const double* from, const double* to, int A) const {
    const Vector3 start = nudged(from, A), end = nudged(to, A);
    Vector3 own;
    if (deforms(A) || !normals_.normal(to, A, own.data())) own.setZero();
    double latest = -1;
    int side = Sides::nearest;
    Vector3 normal = Vector3::Zero();
    for (const Candidate& c : candidates_[A]) {
        const FacetShape one = shape(from, c.facet), two = shape(to, c.facet);
        for (int s = 0; s < one.n_simplices(); ++s) {
            const Vector3 n = two.normal(s);
            const int first = one.vertex(s, 0);
            const double before = one.normal(s).dot(start - one.corner[first]),
                         after = n.dot(end - two.corner[first]);
            if (!(before >= 0 && after < 0) || (!own.isZero() && own.dot(n) >= facing)) continue;
            const double t = before / (before - after);
            FacetShape there = two;
            for (int i = 0; i <= FacetShape::centre; ++i)
                there.corner[i] = one.corner[i] + t * (two.corner[i] - one.corner[i]);
            const Foot foot = whole(there, s, start + t * (end - start));
            const bool meets = std::all_of(foot.coordinate, foot.coordinate + there.dim,
                                           [](double share) { return share > -between; });
            if (meets && t > latest) latest = t, side = c.facet, normal = n;
        }
    }
    if (side < 0 || !keeps_ || deforms(A) || looks(to, A, normal)) return side;
    const int other = touched(to, A, Sides::nearest);
    return other < 0 ? side : other;
}

// Whether a vertex of a rigid body has sagged below a facet next to one, whose edge with that is convex, or
// goes by that edge, which is flush.
bool NodeToSegment::goes_by(const double* X, int A, int side, bool sags) const {
    if (deforms(A)) return false;
    const At x(X + 3 * A);
    const FacetShape own_side = shape(X, side);
    const Vector3 middle = own_side.middle(0);
    const Plane wall{own_side.normal(0), own_side.height(0, x)};
    const int *own = skin_.corners(side), *end = own + skin_.n_corners(side);
    return std::any_of(candidates_[A].begin(), candidates_[A].end(), [&](const Candidate& c) {
        const int* corners = skin_.corners(c.facet);
        if (std::find_first_of(own, end, corners, corners + skin_.n_corners(c.facet)) == end) return false;
        const FacetShape facet = shape(X, c.facet);
        for (int s = 0; s < facet.n_simplices(); ++s) {
            const Plane face{facet.normal(s), facet.height(s, x)};
            if (facet.height(s, middle) < -apart * facet.size() && looks(X, A, face.normal) &&
                ((sags && sags_.reach(face.height, face.normal)) || is_flush(X, A, wall, face)))
                return true;
        }
        return false;
    });
}

// Facets of a side that was sagged past are none that a vertex touches, also where they do not reach its
// edge.
int NodeToSegment::touched(const double* X, int A, int side) const {
    const bool passes = side >= 0 && sagged(X, A, side);
    if (side >= 0 && !passes && looks(X, A, shape(X, side).normal(0))) return side;
    double least = HUGE_VAL;
    int other = Sides::nearest;
    for (const Candidate& c : candidates_[A]) {
        const FacetShape facet = shape(X, c.facet);
        if ((passes && are_same(X, side, c.facet)) || swings_by(X, A, c.facet)) continue;
        for (int s = 0; s < facet.n_simplices(); ++s) {
            const double distance = closest(facet, s, At(X + 3 * A)).distance;
            if (distance < least && facet.height(s, At(X + 3 * A)) < 0 && looks(X, A, facet.normal(s)))
                least = distance, other = c.facet;
        }
    }
    return other;
}

// What lies outside is free. What lies inside is pushed back to where it faces, not out of the other side of
// a thin body.
PointGaps::Reach NodeToSegment::locate_nearest(const double* X, int A, const Vector3& x, Found& found) const {
    found = pick(X, A, x, false, Sides::nearest);
    const Reach reach = sign(X, x, found);
    if (found.faces || found.value >= 0) return reach;
    found = pick(X, A, x, true, Sides::nearest);
    return sign(X, x, found);
}

// What is nearest of a side, as if it went on.
Found NodeToSegment::plane_of(const double* X, int A, int side) const {
    Found found = pick(X, A, At(X + 3 * A), false, side);
    if (found.candidate) found.foot = whole(found.facet, found.foot.simplex, At(X + 3 * A));
    return found;
}

double NodeToSegment::depth(const double* X, int A, int side) const {
    Found found = plane_of(X, A, side);
    return sign(X, At(X + 3 * A), found) == Reach::near ? -found.value : HUGE_VAL;
}

// What is over a body that is flush with a face, and was above it where the step began, as far above the
// plane of that: it lands there as on one floor.
bool NodeToSegment::locate_beside(const double* X, int A, Found& found) const {
    const At x(X + 3 * A), x0(start() + 3 * A);
    for (const Candidate& wall : candidates_[A]) {
        const FacetShape side = shape(X, wall.facet);
        const Plane plane{side.normal(0), side.height(0, x)};
        if (plane.height <= 0) continue;
        const int *own = skin_.corners(wall.facet), *end = own + skin_.n_corners(wall.facet);
        for (const Candidate& c : candidates_[A]) {
            const int* corners = skin_.corners(c.facet);
            if (std::find_first_of(own, end, corners, corners + skin_.n_corners(c.facet)) == end) continue;
            const FacetShape facet = shape(X, c.facet);
            const Plane face{facet.normal(0), facet.height(0, x)};
            if (facet.height(0, side.middle(0)) >= -apart * facet.size() || !looks(X, A, face.normal) ||
                shape(start(), c.facet).height(0, x0) < 0 || !is_flush(X, A, plane, face))
                continue;
            found = {&c, facet, whole(facet, 0, x), {}, face.normal, std::max(face.height, 0.0)};
            return true;
        }
    }
    return false;
}

// What lies inside beside an edge is pushed back to where it came in.
PointGaps::Reach NodeToSegment::locate(const double* X, int A, Found& found) const {
    if (!static_ && held_[A].facet >= 0) return locate_held(X, A, found);
    if (A >= n_own()) return Reach::far;
    if (may_land(A) && locate_beside(X, A, found)) return Reach::near;
    const At x(X + 3 * A);
    Reach reach = locate_nearest(X, A, x, found);
    if (reach == Reach::near && goes_beside(X, A, found)) return Reach::far;
    const int came = reach == Reach::near ? side(X, A) : Sides::nearest;
    if (came == Sides::none) return Reach::far;
    if (came >= 0 && !found.goes_on && leaves(X, A, found, came)) {
        found = plane_of(X, A, came);
        reach = sign(X, x, found);
    }
    if (reach != Reach::near) return reach;
    const int facet = found.candidate->facet;
    return holds(A, facet) && options_.radius - found.value <= sight(A, facet) ? Reach::near : Reach::far;
}

}  // namespace visviva::node_to_segment
