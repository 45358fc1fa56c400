#include "visviva/contact/enclosure.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "visviva/contact/closest.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

}  // namespace

Triangulated::Triangulated(const Skin& skin, int begin, int end) {
    for (int f = begin; f < end; ++f) {
        const int n = skin.n_corners(f);
        const int* corner = skin.corners(f);
        for (int i = 0; i < n; ++i) edges.push_back(std::minmax({corner[i], corner[(i + 1) % n]}));
        for (int i = 2; i < n; ++i) triangles.insert(triangles.end(), {corner[0], corner[i - 1], corner[i]});
        if (n == 2 && skin.dim == 2) {
            const int back = skin.n_vertices(), front = 2 * back, a = corner[0], b = corner[1];
            triangles.insert(triangles.end(),
                             {a + back, a + front, b + back, b + back, a + front, b + front});
        }
        facets.resize(triangles.size() / 3, f);
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

void Triangulated::stand_walls(std::vector<double>& X) {
    const std::size_t n = X.size();
    const auto [least, most] = std::minmax_element(X.begin(), X.end());
    const double far = 4 * (*most - *least);  // lines that tell inside from outside rise by 1.3 of their way
    for (const double z : {-far, far})
        for (std::size_t i = 0; i < n; i += 3) X.insert(X.end(), {X[i], X[i + 1], z});
}

double Triangle::distance(const Vector3& x) const {
    FacetShape facet;
    facet.n = 3, facet.corner[0] = a, facet.corner[1] = b, facet.corner[2] = c;
    return closest(facet, 0, x).distance;
}

double Triangle::crossing(const Vector3& p, const Vector3& way) const {
    constexpr double same = 1e-9;
    const Vector3 u = b - a, w = c - a, d = p - a, across = way.cross(w), other = d.cross(u);
    const double det = u.dot(across), first = d.dot(across) / det, second = way.dot(other) / det;
    const bool meets = det != 0 && first >= -same && second >= -same && first + second <= 1 + same;
    return meets ? w.dot(other) / det : -1;
}

Box around(std::initializer_list<Vector3> points) {
    Box box{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (const Vector3& p : points) {
        Box one;
        for (int i = 0; i < 3; ++i) one.low[i] = one.high[i] = p[i];
        box.include(one);
    }
    return box;
}

Enclosure::Enclosure(const std::vector<double>& X, const std::vector<int>& triangles) {
    std::vector<Box> boxes;
    std::vector<double> centres;
    for (std::size_t k = 0; k < triangles.size(); k += 3) {
        const int* v = &triangles[k];
        const Triangle t{At(&X[3 * v[0]]), At(&X[3 * v[1]]), At(&X[3 * v[2]])};
        const Vector3 centre = (t.a + t.b + t.c) / 3;
        triangles_.push_back(t), boxes.push_back(around({t.a, t.b, t.c}));
        centres.insert(centres.end(), centre.data(), centre.data() + 3);
    }
    tree_.build(centres), tree_.refit(boxes);
}

// Told by how often a line from there meets the surface. It lies along no edge that a body is likely to have.
bool Enclosure::holds(const Vector3& x) const {
    const Vector3 away(0.26713, 0.53691, 0.80037);
    int meets = 0;
    tree_.query(Ray{x.data(), away.data()}, [&](int k) {
        meets += triangles_[k].crossing(x, away) > 0;
        return HUGE_VAL;
    });
    return meets % 2;
}

bool Enclosure::is_shallow(const Vector3& x, double least) const {
    std::vector<int> beside;
    near(around({x.array() - least, x.array() + least}), beside);
    return std::any_of(beside.begin(), beside.end(),
                       [&](int k) { return triangles_[k].distance(x) <= least; });
}

double Enclosure::depth(const Vector3& x, double least) const {
    if (least > 0 && is_shallow(x, least)) return 0;
    const int k = nearest(x);
    return k < 0 ? 0 : triangles_[k].distance(x);
}

int Enclosure::nearest(const Vector3& x) const {
    int nearest = -1;
    double depth = HUGE_VAL;
    if (!holds(x)) return nearest;
    for (int k = 0; k < static_cast<int>(triangles_.size()); ++k)
        if (const double d = triangles_[k].distance(x); d < depth) depth = d, nearest = k;
    return nearest;
}

bool Enclosure::touches(const Vector3& x, double near) const {
    return holds(x) || std::any_of(triangles_.begin(), triangles_.end(),
                                   [&](const Triangle& t) { return t.distance(x) <= near; });
}

void Enclosure::cut(const Vector3& p, const Vector3& way, std::vector<double>& cuts) const {
    std::vector<int> beside;
    near(around({p, p + way}), beside);
    cuts.assign({0, 1});
    for (int k : beside)
        if (const double s = triangles_[k].crossing(p, way); s > 0 && s < 1) cuts.push_back(s);
    std::sort(cuts.begin(), cuts.end());
}

double Enclosure::exit(const Vector3& p, const Vector3& way) const {
    constexpr double here = 1e-9;
    double least = HUGE_VAL;
    tree_.query(Ray{p.data(), way.data()}, [&](int k) {
        const double s = triangles_[k].crossing(p, way);
        if (s > here && s < least && triangles_[k].normal().dot(way) > 0) least = s;
        return least;
    });
    return least;
}

}  // namespace visviva
