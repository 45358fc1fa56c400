#include "visviva/contact/piercing.hpp"

#include <algorithm>
#include <cmath>

#include "visviva/contact/closest.hpp"
#include "visviva/contact/search.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

struct Triangle {
    Vector3 a, b, c;
    double distance(const Vector3& x) const {
        FacetShape facet;
        facet.n = 3, facet.corner[0] = a, facet.corner[1] = b, facet.corner[2] = c;
        return closest(facet, 0, x).distance;
    }
    // Where a line from p meets it, in lengths of its way; below 0 if nowhere.
    double crossing(const Vector3& p, const Vector3& way) const {
        constexpr double same = 1e-9;
        const Vector3 u = b - a, w = c - a, d = p - a, across = way.cross(w), other = d.cross(u);
        const double det = u.dot(across), first = d.dot(across) / det, second = way.dot(other) / det;
        const bool meets = det != 0 && first >= -same && second >= -same && first + second <= 1 + same;
        return meets ? w.dot(other) / det : -1;
    }
};

Box around(std::initializer_list<Vector3> points) {
    Box box{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (const Vector3& p : points) {
        Box one;
        for (int i = 0; i < 3; ++i) one.low[i] = one.high[i] = p[i];
        box.include(one);
    }
    return box;
}

// A closed surface in one configuration.
struct Body {
    std::vector<Triangle> triangles;
    BoxTree tree;

    Body(const std::vector<double>& X, const std::vector<int>& vertices) {
        std::vector<Box> boxes;
        std::vector<double> centres;
        for (std::size_t k = 0; k < vertices.size(); k += 3) {
            const int* v = &vertices[k];
            const Triangle t{At(&X[3 * v[0]]), At(&X[3 * v[1]]), At(&X[3 * v[2]])};
            const Vector3 centre = (t.a + t.b + t.c) / 3;
            triangles.push_back(t), boxes.push_back(around({t.a, t.b, t.c}));
            centres.insert(centres.end(), centre.data(), centre.data() + 3);
        }
        tree.build(centres), tree.refit(boxes);
    }

    // Depth of a place; 0 outside, which is told by how often a line from there meets the surface. It lies
    // along no edge that a body is likely to have.
    double depth(const Vector3& x) const {
        const Vector3 away(0.26713, 0.53691, 0.80037);
        int meets = 0;
        tree.query(Ray{x.data(), away.data()}, [&](int k) {
            meets += triangles[k].crossing(x, away) > 0;
            return HUGE_VAL;
        });
        double least = HUGE_VAL;
        for (const Triangle& t : triangles)
            if (meets % 2) least = std::min(least, t.distance(x));
        return meets % 2 ? least : 0;
    }

    // The ends of an edge, and where it passes through the surface, as parts of its length in ascending
    // order.
    void cut(const Vector3& p, const Vector3& way, std::vector<double>& cuts) const {
        std::vector<int> near;
        tree.query(around({p, p + way}), near);
        cuts.assign({0, 1});
        for (int k : near)
            if (const double s = triangles[k].crossing(p, way); s > 0 && s < 1) cuts.push_back(s);
        std::sort(cuts.begin(), cuts.end());
    }
};

}  // namespace

Piercing::Piercing(Skin skin, double limit, std::string cure)
    : skin_(std::move(skin)), limit_(limit), cure_(std::move(cure)) {
    for (int f = 0; f < skin_.n_facets(); ++f) add(f, sides_[f < skin_.second_begin ? 0 : 1]);
    for (Side& side : sides_) {
        std::sort(side.edges.begin(), side.edges.end());
        side.edges.erase(std::unique(side.edges.begin(), side.edges.end()), side.edges.end());
    }
}

void Piercing::add(int facet, Side& side) const {
    const int n = skin_.n_corners(facet);
    const int* corner = skin_.corners(facet);
    for (int i = 0; i < n; ++i) side.edges.push_back(std::minmax({corner[i], corner[(i + 1) % n]}));
    for (int i = 2; i < n; ++i)
        side.triangles.insert(side.triangles.end(), {corner[0], corner[i - 1], corner[i]});
}

bool Piercing::sinks(const double* q0, const double* q1, double seen, Piece& worst) {
    if (!begun_) begun_ = true, overlaps_ = deepest(q0).depth > limit_;
    if (overlaps_) return false;
    worst = deepest(q1);
    if (worst.depth <= limit_ + 2 * seen) return false;
    const double before = deepest(q0).depth;
    return before > limit_ && worst.depth > before;
}

Piercing::Piece Piercing::deepest(const double* q) const {
    std::vector<double> X;
    skin_.positions(q, X);
    const Piece one = deepest(X, sides_[0].edges, sides_[1].triangles),
                two = deepest(X, sides_[1].edges, sides_[0].triangles);
    return one.depth > two.depth ? one : two;
}

// The ends and the middle of each part of an edge that the surface cuts off are looked at.
Piercing::Piece Piercing::deepest(const std::vector<double>& X, const Edges& edges,
                                  const std::vector<int>& triangles) const {
    const Body body(X, triangles);
    Piece found;
    std::vector<double> cuts;
    for (const auto& [a, b] : edges) {
        const Vector3 p = At(&X[3 * a]), way = At(&X[3 * b]) - p;
        auto look = [&](double s) {
            const Vector3 x = p + s * way;
            if (const double d = body.depth(x); d > found.depth) found = {d, x};
        };
        body.cut(p, way, cuts);
        look(0), look(1);
        for (std::size_t k = 1; k < cuts.size(); ++k) look(0.5 * (cuts[k - 1] + cuts[k]));
    }
    return found;
}

}  // namespace visviva
