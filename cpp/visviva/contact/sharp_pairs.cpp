#include "visviva/contact/sharp_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

constexpr double parallel = 1e-2;  // sine of an angle below which edges do not cross
constexpr double out = 0.1;        // sine of an angle by which corners there lead out: more than bodies tilt
constexpr double looking = 0.1;    // sine by which edges of a corner may lead to a face that it looks at
constexpr double shallow = 0.04;   // part of the depth that is seen by which corners at a border may be in it

using Shares = Eigen::Vector4d;
using Ends = std::array<int, 4>;

/// Where on the edge of a side both are nearest, from 0 to 1.
double place_on(const Shares& shares, int side) { return side == 0 ? shares[1] : -shares[3]; }

/// How far that is from the nearer end of the edge; negative beyond.
double from_end(const double* X, const Ends& v, const Shares& shares, int side) {
    const double place = place_on(shares, side);
    return std::min(place, 1 - place) * (At(X + 3 * v[2 * side + 1]) - At(X + 3 * v[2 * side])).norm();
}

}  // namespace

std::vector<int> SharpPairs::vertices(int side, long part) const {
    if (part < n_edges(side)) {
        const int* e = &parts_.edges[4 * (part + (side == 0 ? 0 : n_edges(0)))];
        return {e[0], e[1]};
    }
    const long k = part - n_edges(side);
    if (side == 1) return {parts_.corners[k]};
    return {parts_.borders.begin() + parts_.border_start[k],
            parts_.borders.begin() + parts_.border_start[k + 1]};
}

std::vector<Box> SharpPairs::boxes(const double* from, const double* to, int side, double margin) const {
    std::vector<Box> boxes;
    const long n = n_edges(side) + (side == 0 ? n_faces() : n_corners());
    for (long k = 0; k < n; ++k) {
        Box box{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
        for (const int v : vertices(side, k))
            for (const double* X : {from, to})
                for (int i = 0; i < 3; ++i) {
                    box.low[i] = std::min(box.low[i], X[3 * v + i] - margin);
                    box.high[i] = std::max(box.high[i], X[3 * v + i] + margin);
                }
        boxes.push_back(box);
    }
    return boxes;
}

std::vector<long> SharpPairs::near(const double* from, const double* to, double margin) const {
    const std::vector<Box> own = boxes(from, to, 0, margin), others = boxes(from, to, 1, margin);
    std::vector<double> centres;
    for (const Box& box : others)
        for (int i = 0; i < 3; ++i) centres.push_back(0.5 * (box.low[i] + box.high[i]));
    BoxTree tree;
    tree.build(centres), tree.refit(others);
    std::vector<long> pairs;
    std::vector<int> found;
    for (long k = 0; k < static_cast<long>(own.size()); ++k) {
        const bool is_edge = k < n_edges(0);
        tree.query(own[k], found);
        for (const long other : found)
            if (is_edge == (other < n_edges(1)))
                pairs.push_back(is_edge ? k * n_edges(1) + other
                                        : n_crossing() + (k - n_edges(0)) * n_corners() + other - n_edges(1));
    }
    return pairs;
}

std::array<int, 4> SharpPairs::stencil(long number) const {
    if (number < n_crossing()) {
        const int *one = edge(number, 0), *two = edge(number, 1);
        return {one[0], one[1], two[0], two[1]};
    }
    const int* f = &parts_.face_corners[3 * face(number)];
    return {f[0], f[1], f[2], parts_.corners[corner(number)]};
}

Meeting SharpPairs::meeting(const double* X, const Pair& pair) const {
    const auto v = stencil(pair.number);
    const At a(X + 3 * v[0]), b(X + 3 * v[1]), c(X + 3 * v[2]), d(X + 3 * v[3]);
    return pair.number < n_crossing() ? Meeting::of_lines(a, b, c, d, pair.sign)
                                      : Meeting::of_plane(a, b, c, d);
}

// By the spheres about both parts, as large again: a step may come from there.
bool SharpPairs::is_apart(const double* X, long number) const {
    Vector3 middle[2];
    double sizes = 0;
    for (int side : {0, 1}) {
        Eigen::AlignedBox3d box;
        for (const int v : vertices(side, part(number, side))) box.extend(Vector3(At(X + 3 * v)));
        middle[side] = box.center(), sizes += box.diagonal().norm();
    }
    return (middle[1] - middle[0]).norm() > sizes + depth_;
}

// A direction along an edge and the normals of the facets to its left and right.
struct SharpPairs::Ridge {
    Vector3 a, along, left, right;
    Ridge(const double* X, const int* edge) : a(At(X + 3 * edge[0])) {
        along = (At(X + 3 * edge[1]) - a).normalized();
        left = along.cross(At(X + 3 * edge[2]) - a).normalized();
        right = (At(X + 3 * edge[3]) - a).cross(along).normalized();
    }
    /// Whether a unit vector across the edge lies between these normals.
    bool looks(const Vector3& n, double sine) const {
        return left.cross(n).dot(along) >= -sine && n.cross(right).dot(along) >= -sine &&
               n.dot(left + right) > 0;
    }
    /// Whether a place lies below both facets, or above one by no more than this.
    bool holds(const Vector3& x, double beside = 0) const {
        return (x - a).dot(left) < beside && (x - a).dot(right) < beside;
    }
};

// A place in the body of a corner, this far from it between its edges.
Vector3 SharpPairs::nudged(const double* X, long corner, double way) const {
    const Vector3 a = At(X + 3 * parts_.corners[corner]);
    Vector3 inwards = Vector3::Zero();
    for (int k = parts_.next_start[corner]; k < parts_.next_start[corner + 1]; ++k)
        inwards += (At(X + 3 * parts_.next[k]) - a).normalized();
    return a + way * inwards.normalized();
}

// Whether all edges of a corner lead away from a plane with this unit normal.
bool SharpPairs::corner_looks(const double* X, long corner, const Vector3& n, double sine) const {
    const Vector3 a = At(X + 3 * parts_.corners[corner]);
    for (int k = parts_.next_start[corner]; k < parts_.next_start[corner + 1]; ++k)
        if (n.dot((At(X + 3 * parts_.next[k]) - a).normalized()) > sine) return false;
    return true;
}

// Of a face.
double SharpPairs::size(const double* X, const Pair& pair) const {
    const auto v = stencil(pair.number);
    double most = 0;
    for (int k : {0, 1, 2}) most = std::max(most, (At(X + 3 * v[k]) - At(X + 3 * v[(k + 1) % 3])).norm());
    return most;
}

// How far a place in the plane of a face is from its border; negative outside. Borders run anticlockwise
// about the outward normal, those of holes the other way, in pairs of vertices.
double SharpPairs::inside(const double* X, long face, const Vector3& x, const Vector3& n) const {
    double least = HUGE_VAL, around = 0;
    for (int k = parts_.border_start[face]; k < parts_.border_start[face + 1]; k += 2) {
        const Vector3 a = At(X + 3 * parts_.borders[k]) - x, b = At(X + 3 * parts_.borders[k + 1]) - x,
                      e = b - a;
        const double s = std::clamp(-a.dot(e) / e.squaredNorm(), 0.0, 1.0);
        least = std::min(least, (a + s * e).norm());
        around += std::atan2(n.dot(a.cross(b)), a.dot(b));
    }
    return around > M_PI ? least : -least;
}

// Whether the body of a corner at the border of a face leads out over that: its corner goes by, as that of a
// floor, which lies flush beside another one, passes the wall of what slides onto it.
bool SharpPairs::passes_by(const double* X, const Pair& pair, const Meeting& m, double in, double way) const {
    const Vector3 inner = nudged(X, corner(pair.number), way), a = At(X + 3 * stencil(pair.number)[0]);
    const Vector3 foot = inner - (inner - a).dot(m.normal) * m.normal;
    return inside(X, face(pair.number), foot, -m.normal) - in < -out * way;
}

// Of edges that end there, as upright ones of boxes, below a face that looks at them, and of corners at the
// border of a face. Of boxes side by side on one floor neither lies on the other.
bool SharpPairs::has_sagged(const double* X, const Pair& pair) const {
    constexpr double opposite = 0.9;  // least agreement of a normal with the way back from an end
    const Meeting m = meeting(X, pair);
    const auto v = stencil(pair.number);
    if (pair.number < n_crossing()) {
        for (int side : {0, 1}) {
            const Vector3 e = At(X + 3 * v[2 * side + 1]) - At(X + 3 * v[2 * side]);
            const Vector3 out = (place_on(m.shares, side) < 0.5 ? -1 : 1) * e.normalized();
            const Ridge other(X, edge(pair.number, 1 - side));
            const bool lies_on = std::min(other.left.dot(out), other.right.dot(out)) < -opposite;
            if (lies_on && sags_.reach(from_end(X, v, m.shares, side), out)) return true;
        }
        return false;
    }
    const Vector3 foot = At(X + 3 * v[3]) + m.distance * m.normal;
    const long f = face(pair.number);
    double sag = 0;
    for (int k = parts_.border_start[f]; k < parts_.border_start[f + 1]; k += 2) {
        const Vector3 a = At(X + 3 * parts_.borders[k]), e = At(X + 3 * parts_.borders[k + 1]) - a;
        const Vector3 out = e.cross(m.normal).normalized();
        const double most = sags_.below(out);
        if (std::abs((foot - a).dot(out)) < most) sag = std::max(sag, most);
    }
    return sag > 0 && passes_by(X, pair, m, inside(X, f, foot, -m.normal), sag);
}

bool SharpPairs::is_flush_edge(const double* X0, const Pair& pair, const Meeting& m, int side) const {
    constexpr double end = 1e-3;  // of its length: bodies as wide end there
    const Ridge ridge(X0, edge(pair.number, side));
    const int* v = edge(pair.number, side);
    const double part = std::clamp(place_on(m.shares, side), end, 1 - end);
    const Vector3 place = ridge.a + part * (At(X0 + 3 * v[1]) - ridge.a);
    return covers_.goes_on(side, place, ridge.left, ridge.right) ||
           covers_.goes_on(side, place, ridge.right, ridge.left);
}

// Places on the border of a face that are nearest to one in its plane, and the ways out there.
std::vector<SharpPairs::Border> SharpPairs::borders(const double* X, const Pair& pair,
                                                    const Vector3& foot) const {
    const Vector3 normal = -meeting(X, pair).normal;
    const long f = face(pair.number);
    std::vector<Border> all;
    for (int k = parts_.border_start[f]; k < parts_.border_start[f + 1]; k += 2) {
        const Vector3 a = At(X + 3 * parts_.borders[k]), e = At(X + 3 * parts_.borders[k + 1]) - a;
        const Vector3 near = a + std::clamp((foot - a).dot(e) / e.squaredNorm(), 0.0, 1.0) * e;
        all.push_back({near, e.cross(normal).normalized()});
    }
    return all;
}

// A corner that has come to a face of the first at a border of which another body goes on, or one that is
// covered itself.
bool SharpPairs::is_flush_wall(const double* X0, const double* X, const Pair& pair, const Meeting& m) const {
    const Vector3 wall = -meeting(X0, pair).normal, x = At(X0 + 3 * stencil(pair.number)[3]);
    const Vector3 aside = covers_.has(1) ? nudged_aside(X0, corner(pair.number)) : Vector3::Zero();
    const std::vector<Border> all = borders(X0, pair, foot_at(X0, pair, m.shares));
    return std::any_of(all.begin(), all.end(), [&](const Border& border) {
        const Vector3 &top = border.out, along = top.cross(wall);
        const double height = (x - border.place).dot(top);
        return (corner_looks(X, corner(pair.number), -top, looking) &&
                covers_.leads_over(0, {border.place, top, wall, x, height})) ||
               (aside.dot(top) > 0 && aside.dot(wall) > 0 &&
                covers_.leads_over(1, {x + aside.dot(along) * along, -top, -wall, border.place, height}));
    });
}

// The way to a place in the body of a corner that is beside it by little of the shortest of its edges.
Vector3 SharpPairs::nudged_aside(const double* X, long corner) const {
    constexpr double little = 1e-3;
    const Vector3 a = At(X + 3 * parts_.corners[corner]);
    double least = HUGE_VAL;
    for (int k = parts_.next_start[corner]; k < parts_.next_start[corner + 1]; ++k)
        least = std::min(least, (At(X + 3 * parts_.next[k]) - a).norm());
    return nudged(X, corner, little * least) - a;
}

bool SharpPairs::comes_past(const double* X0, const double* X, const Pair& pair) const {
    const Meeting before = meeting(X0, pair), after = meeting(X, pair);
    const double t = std::clamp(before.distance / (before.distance - after.distance), 0.0, 1.0);
    const Eigen::Vector4d shares = (1 - t) * before.shares + t * after.shares;
    const Vector3 foot = foot_at(X0, pair, shares);
    return inside(X0, face(pair.number), foot, -before.normal) < -flush() && !goes_on(X0, pair, foot);
}

bool SharpPairs::is_over_flush(const double* X0, const double* X, const Pair& pair) const {
    const Vector3 foot = foot_at(X0, pair, meeting(X, pair).shares);
    return inside(X0, face(pair.number), foot, -meeting(X0, pair).normal) < 0 && goes_on(X0, pair, foot);
}

// Whether another body does where a face ends next to a place in its plane.
bool SharpPairs::goes_on(const double* X, const Pair& pair, const Vector3& foot) const {
    const std::vector<Border> all = borders(X, pair, foot);
    const Border& nearest = *std::min_element(all.begin(), all.end(), [&](const Border& a, const Border& b) {
        return (a.place - foot).norm() < (b.place - foot).norm();
    });
    return covers_.goes_on(0, nearest.place, -meeting(X, pair).normal, nearest.out);
}

// By the shares of the corners of the plane.
Vector3 SharpPairs::foot_at(const double* X, const Pair& pair, const Eigen::Vector4d& shares) const {
    const auto v = stencil(pair.number);
    return shares[0] * At(X + 3 * v[0]) + shares[1] * At(X + 3 * v[1]) + shares[2] * At(X + 3 * v[2]);
}

bool SharpPairs::is_flush(const double* X0, const double* X, const Pair& pair) const {
    if (!covers_.has_any()) return false;
    const Meeting m = meeting(X, pair);
    if (m.sine < parallel) return false;
    if (pair.number < n_crossing()) return is_flush_edge(X0, pair, m, 0) || is_flush_edge(X0, pair, m, 1);
    return is_flush_wall(X0, X, pair, m);
}

bool SharpPairs::edges_meet(const double* X, const Pair& pair, const Meeting& m, double beyond, double sine,
                            bool stays) const {
    const auto v = stencil(pair.number);
    const Ridge ridges[2] = {{X, edge(pair.number, 0)}, {X, edge(pair.number, 1)}};
    for (int side : {0, 1}) {
        const double place = place_on(m.shares, side), to_end = from_end(X, v, m.shares, side);
        if (std::min(place, 1 - place) < -beyond || (beyond <= 0 && to_end < flush())) return false;
        const bool is_near = -m.distance > 2 * to_end;
        const At end(X + 3 * v[2 * side + (place < 0.5 ? 0 : 1)]);
        if (beyond <= 0 && !stays && is_near && ridges[1 - side].holds(end)) return false;
    }
    return ridges[0].looks(-m.normal, sine) && ridges[1].looks(m.normal, sine);
}

void SharpPairs::add_offsets(const double* X, const Pair& pair, std::vector<double>& offsets) const {
    const Meeting m = meeting(X, pair);
    const auto v = stencil(pair.number);
    if (!has_signs(pair.number)) {
        const Vector3 foot = At(X + 3 * v[3]) + m.distance * m.normal;
        offsets.push_back(std::abs(inside(X, face(pair.number), foot, -m.normal)));
        return;
    }
    for (int side : {0, 1}) offsets.push_back(from_end(X, v, m.shares, side));
}

bool SharpPairs::touch(const double* X0, const double* X, const Pair& pair) const {
    const Meeting before = meeting(X0, pair), after = meeting(X, pair);
    const double t = std::clamp(before.distance / (before.distance - after.distance), 0.0, 1.0);
    const Eigen::Vector4d shares = (1 - t) * before.shares + t * after.shares;
    const auto v = stencil(pair.number);
    return std::min(from_end(X, v, shares, 0), from_end(X, v, shares, 1)) >= flush();
}

bool SharpPairs::leaves(const double* X0, const double* X, const Pair& pair) const {
    constexpr double overhang = 10;  // times the depth: what rests leaves at once
    if (!has_signs(pair.number) || slides_in(X, pair)) return false;
    const Meeting m = meeting(X, pair);
    if (m.distance >= 0) return false;
    if (m.distance > meeting(X0, pair).distance) return true;
    const auto v = stencil(pair.number);
    const double least = overhang * m.distance;
    return std::min(from_end(X, v, m.shares, 0), from_end(X, v, m.shares, 1)) >= least;
}

bool SharpPairs::slides_in(const double* X, const Pair& pair) const {
    constexpr double same = 0.9;  // least agreement of normals
    const Meeting m = meeting(X, pair);
    const auto v = stencil(pair.number);
    const auto slides = [&](int side) {
        if (from_end(X, v, m.shares, side) >= flush()) return false;
        const At end(X + 3 * v[2 * side + (place_on(m.shares, side) < 0.5 ? 0 : 1)]);
        const Ridge other(X, edge(pair.number, 1 - side));
        const Vector3 out = side == 0 ? m.normal : Vector3(-m.normal);
        return other.holds(end, flush()) && std::max(other.left.dot(out), other.right.dot(out)) > same;
    };
    return slides(0) || slides(1);
}

// What is nearer to the border of a face than half as deep, or to an end of an edge that lies inside, leaves
// past that, and by what touches there: so does the vertical edge of a box that has sunk a little into the
// one that it stands on. An end that sticks out leads its edge deeper. Corners a little deep at a border
// stay: those of a box below one that stands flush on it.
bool SharpPairs::meets(const double* X, const Pair& pair, double beyond, double sine, bool stays) const {
    const Meeting m = meeting(X, pair);
    if (m.sine < parallel || std::abs(m.distance) > depth_) return false;
    if (pair.number < n_crossing()) return edges_meet(X, pair, m, beyond, sine, stays);
    const auto v = stencil(pair.number);
    const Vector3 foot = At(X + 3 * v[3]) + m.distance * m.normal;
    const double in = inside(X, face(pair.number), foot, -m.normal);
    const double border = flush();
    if (in < -std::max(beyond * size(X, pair), border)) return false;
    if (beyond <= 0 && std::abs(in) < border && passes_by(X, pair, m, in, border)) return false;
    if (beyond <= 0 && !stays && -m.distance > 2 * std::max(in, 0.0) + shallow * depth_) return false;
    return corner_looks(X, corner(pair.number), m.normal, sine);
}

}  // namespace visviva
