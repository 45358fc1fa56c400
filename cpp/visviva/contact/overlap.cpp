#include "visviva/contact/overlap.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using Bounds = Eigen::AlignedBox3d;

constexpr double same = 1e-9;  // part of the size of both bodies up to which places are one

Bounds bounds_of(const Enclosure& body) {
    Bounds bounds;
    for (const Triangle& t : body.triangles()) bounds.extend(t.a).extend(t.b).extend(t.c);
    return bounds;
}

// What a triangle has in common with a plane, along a direction in that.
struct Stretch {
    double from = HUGE_VAL, to = -HUGE_VAL;
    Vector3 first, last;

    Stretch(const Triangle& t, const Vector3& normal, const Vector3& origin, const Vector3& along,
            double slack) {
        const std::array<Vector3, 3> x{t.a, t.b, t.c};
        std::array<double, 3> height;
        for (int i = 0; i < 3; ++i) height[i] = normal.dot(x[i] - origin);
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            const bool flush = std::abs(height[i]) <= slack, next = std::abs(height[j]) <= slack;
            if (flush) take(x[i], along);
            if (!flush && !next && (height[i] > 0) != (height[j] > 0))
                take(x[i] + height[i] / (height[i] - height[j]) * (x[j] - x[i]), along);
        }
    }
    void take(const Vector3& x, const Vector3& along) {
        const double s = along.dot(x);
        if (s < from) from = s, first = x;
        if (s > to) to = s, last = x;
    }
    Vector3 at(double s) const { return first + (s - from) / (to - from) * (last - first); }
};

// From the middle of what two triangles have in common the way leads into both bodies, if that is where they
// cross and not where they touch, even where edges of one lie flush in faces of the other.
struct Inwards {
    bool there = false;
    Vector3 place, way;

    Inwards(const Triangle& t, const Triangle& u, double size) {
        constexpr double flat = 1e-6;  // sine of the angle
        const Vector3 n = t.normal(), m = u.normal(), across = n.cross(m);
        if (!(across.norm() > flat)) return;
        const Vector3 along = across.normalized();
        const Stretch one(t, m, u.a, along, same * size), two(u, n, t.a, along, same * size);
        const double from = std::max(one.from, two.from), to = std::min(one.to, two.to);
        if (!(to - from > same * size)) return;
        there = true, place = one.at(0.5 * (from + to)), way = -size * (n + m).normalized();
    }
};

}  // namespace

DeepPlace find_overlap(const Enclosure& one, const Enclosure& two, double least) {
    DeepPlace found;
    const Bounds bounds[2] = {bounds_of(one), bounds_of(two)};
    if (!bounds[0].intersects(bounds[1])) return found;
    const double size = bounds[0].merged(bounds[1]).diagonal().norm();
    std::vector<int> near;
    for (const Triangle& t : one.triangles()) {
        two.near(around({t.a, t.b, t.c}), near);
        for (int k : near) {
            const Inwards in(t, two.triangles()[k], size);
            if (!in.there) continue;
            const double out = std::min(one.exit(in.place, in.way), two.exit(in.place, in.way));
            if (!std::isfinite(out)) continue;
            const Vector3 x = in.place + 0.5 * out * in.way;
            const double more = std::max(least, found.depth), depth = one.depth(x, more);
            if (depth > more)
                if (const double other = two.depth(x, more); other > more)
                    found = {std::min(depth, other), x};
        }
    }
    if (found.depth > 0) return found;
    // Surfaces that do not cross: one body may be in the other as a whole, which any of its places tells.
    for (const auto& [inner, outer] : {std::pair(&one, &two), std::pair(&two, &one)}) {
        const Vector3& x = inner->triangles().front().a;
        if (const double depth = outer->depth(x, least); depth > 0) return {depth, x};
    }
    return found;
}

}  // namespace visviva
