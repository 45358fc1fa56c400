#include "visviva/contact/entrances.hpp"

#include <algorithm>
#include <set>

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;
using Bounds = Eigen::AlignedBox3d;

constexpr double same_side = 0.5;  // cosine of the angle between facets that are one side of a body
constexpr double any_side = -2;
constexpr double same_place = 1e-9;  // by the size of a facet

Vector3 mean(const Vector3& a, const Vector3& b, double t) { return (1 - t) * a + t * b; }

Triangle triangle(const std::vector<double>& X, const int* corners) {
    return {At(&X[3 * corners[0]]), At(&X[3 * corners[1]]), At(&X[3 * corners[2]])};
}

Box grown(const Triangle& t, double by) {
    const Vector3 low = t.a.cwiseMin(t.b).cwiseMin(t.c), high = t.a.cwiseMax(t.b).cwiseMax(t.c);
    return around({low.array() - by, high.array() + by});
}

}  // namespace

Entrances::Entrances(const Triangulated& first, const Triangulated& second, double shallow)
    : triangles_{first.triangles, second.triangles}, shallow_(shallow) {
    for (const int side : {0, 1}) {
        const Triangulated& of = side == 0 ? first : second;
        std::set<std::pair<int, int>> found;
        for (const auto& [a, b] : of.edges) {
            if (of.triangles.empty())
                found.insert({a, b});
            else
                found.insert({{a, a}, {b, b}});
        }
        for (const auto& [a, b] : found) probes_.push_back({a, b, side});
    }
    sides_.resize(static_cast<int>(probes_.size()));
}

Vector3 Entrances::Probe::at(const std::vector<double>& X, double share) const {
    return mean(At(&X[3 * a]), At(&X[3 * b]), share);
}

// The middle, as a share of its length, of the longest part that is in a body.
std::optional<double> Entrances::inside(const Probe& probe, const std::vector<double>& X,
                                        const Enclosure& body) {
    const Vector3 from = probe.at(X, 0);
    if (probe.a == probe.b) return body.holds(from) ? std::optional(0.0) : std::nullopt;
    std::vector<double> cuts;
    body.cut(from, probe.at(X, 1) - from, cuts);
    double longest = 0;
    std::optional<double> found;
    for (std::size_t i = 1; i < cuts.size(); ++i) {
        const double share = 0.5 * (cuts[i - 1] + cuts[i]), length = cuts[i] - cuts[i - 1];
        if (length > longest && body.holds(probe.at(X, share))) longest = length, found = share;
    }
    return found;
}

Entrances::Motion::Motion(const std::vector<double>& from, const std::vector<double>& to,
                          const std::array<std::vector<int>, 2>& triangles)
    : from(from), to(to) {
    for (const int side : {0, 1})
        for (std::size_t i = 0; !from.empty() && i < triangles[side].size(); ++i) {
            const int v = 3 * triangles[side][i];
            ways[side].extend(Vector3(At(&to[v]) - At(&from[v])));
        }
}

void Entrances::settle(const std::vector<double>& X, const Bodies& bodies) {
    const std::vector<double> before = sides_.start();
    const Motion motion(before, X, triangles_);
    sides_.settle(X, [&](std::vector<Entered>& sides) {
        for (int i = 0; i < static_cast<int>(probes_.size()); ++i) sides[i].face = side_of(i, motion, bodies);
    });
}

// By which triangle has come in what is inside where a step ends.
int Entrances::side_of(int i, const Motion& motion, const Bodies& bodies) const {
    if (sides_.of(i).face == Sides::none) return Sides::none;
    const Enclosure& body = bodies[1 - probes_[i].side];
    const std::optional<double> share = inside(probes_[i], motion.to, body);
    if (!share) return Sides::nearest;
    const Vector3 x = probes_[i].at(motion.to, *share);
    if (motion.from.empty()) return body.is_shallow(x, shallow_) ? body.nearest(x) : Sides::none;
    return entered(i, *share, motion, bodies).triangle;
}

// The triangle, of those of the side by which it has come in, that is next to what is inside now, or one that
// carries it and is nearer.
Entrances::Below Entrances::entered(int i, double share, const Motion& motion, const Bodies& bodies) const {
    const Probe& probe = probes_[i];
    const Enclosure& body = bodies[1 - probe.side];
    int triangle = sides_.of(i).face;
    if (triangle == Sides::nearest) triangle = passed(probe, share, motion, body);
    if (triangle < 0) return {triangle, 0};
    const Vector3 x = probe.at(motion.to, share);
    const Below own = below(body, triangle, x, same_side), next = below(body, own.triangle, x, any_side);
    if (next.depth >= own.depth) return own;
    const double held = bodies[probe.side].triangles().empty() ? near_ : shallow_;
    const bool carried = next.depth <= held || carries(1 - probe.side, next.triangle, bodies);
    return carried ? next : own;
}

// Whether bodies hold each other at a triangle of a side, or at those beside it that are one side with it.
bool Entrances::carries(int side, int triangle, const Bodies& bodies) const {
    const Enclosure &body = bodies[side], &other = bodies[1 - side];
    const Triangle& at = body.triangles()[triangle];
    std::vector<int> own, beside;
    body.near(grown(at, 0), own);
    for (const int k : own) {
        const Triangle& t = body.triangles()[k];
        if (t.normal().dot(at.normal()) <= same_side) continue;
        other.near(grown(t, near_), beside);
        for (const int j : beside) {
            const Triangle& u = other.triangles()[j];
            if (side == 0 ? holds(t, u) : holds(u, t)) return true;
        }
    }
    return false;
}

// Whether triangles of the first side, whose vertices have gaps, and of the second one look at each other,
// and a vertex lies on it.
bool Entrances::holds(const Triangle& first, const Triangle& second) const {
    return first.normal().dot(second.normal()) < -same_side &&
           std::min({second.distance(first.a), second.distance(first.b), second.distance(first.c)}) <= near_;
}

// The triangle that a place passes last on its straight way, as that moves itself, or the nearest one. It is
// where the place comes from, as seen from the end, or nearer.
int Entrances::passed(const Probe& probe, double share, const Motion& motion, const Enclosure& body) const {
    const int* corners = triangles_[1 - probe.side].data();
    const Vector3 x0 = probe.at(motion.from, share), x1 = probe.at(motion.to, share);
    const Bounds& ways = motion.ways[1 - probe.side];
    double latest = -1;
    int last = -1;
    std::vector<int> near;
    body.near(around({x1, x0 + ways.min(), x0 + ways.max()}), near);
    for (const int k : near) {
        const Triangle &end = body.triangles()[k], start = triangle(motion.from, corners + 3 * k);
        const double size = (end.b - end.a).norm();
        const Vector3 n = end.normal();
        const double before = start.normal().dot(x0 - start.a), after = n.dot(x1 - end.a);
        if (before < -same_place * size || after >= std::min(before, 0.0)) continue;
        const double t = std::max(before / (before - after), 0.0);
        const Vector3 x = mean(x0, x1, t);
        const Triangle there{mean(start.a, end.a, t), mean(start.b, end.b, t), mean(start.c, end.c, t)};
        if (t > latest && there.crossing(x + size * n, -size * n) > 0) latest = t, last = k;
    }
    return last < 0 ? body.nearest(x1) : last;
}

// The triangle next to a place of those whose normals are more than `same` along that of another one.
Entrances::Below Entrances::below(const Enclosure& body, int triangle, const Vector3& x, double same) {
    const std::vector<Triangle>& all = body.triangles();
    const Vector3 normal = all[triangle].normal();
    Below found{triangle, all[triangle].distance(x)};
    std::vector<int> near;
    body.near(around({x.array() - found.depth, x.array() + found.depth}), near);
    for (const int k : near)
        if (const double d = all[k].distance(x); d < found.depth && all[k].normal().dot(normal) > same)
            found = {k, d};
    return found;
}

}  // namespace visviva
