// The geometry of mortar segments over any number type.
#pragma once
#include <algorithm>
#include <optional>

#include "visviva/contact/dual.hpp"
#include "visviva/contact/segment.hpp"

namespace visviva::VISVIVA_ISA {

template <class T>
struct Vec {
    T x, y, z;
};
template <class T>
inline Vec<T> operator+(const Vec<T>& a, const Vec<T>& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
inline Vec<T> operator-(const Vec<T>& a, const Vec<T>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T, class S>
inline Vec<T> operator*(const S& c, const Vec<T>& a) {
    return {c * a.x, c * a.y, c * a.z};
}
template <class T>
inline T dot(const Vec<T>& a, const Vec<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
inline Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
inline Vec<T> unit(const Vec<T>& a) {
    return reciprocal(root(dot(a, a))) * a;
}

template <class T>
struct Planar {
    T x, y;
};
template <class T>
inline Planar<T> operator-(const Planar<T>& a, const Planar<T>& b) {
    return {a.x - b.x, a.y - b.y};
}
template <class T>
inline T cross(const Planar<T>& a, const Planar<T>& b) {
    return a.x * b.y - a.y * b.x;
}

/// c0 + c1 xi + c2 eta + c3 xi eta over a facet: quadrilateral on (-1, 1)^2, triangle (xi, eta, 1 - xi -
/// eta).
template <class T>
struct Bilinear {
    T c0, c1, c2, c3;
    bool quad;

    Bilinear() : quad(false) {}
    Bilinear(const T& a, const T& b, const T& c, const T& d)
        : c0(0.25 * (a + b + c + d)),
          c1(0.25 * (b + c - (a + d))),
          c2(0.25 * (c + d - (a + b))),
          c3(0.25 * (a + c - (b + d))),
          quad(true) {}
    Bilinear(const T& a, const T& b, const T& c) : c0(a), c1(b - a), c2(c - a), c3(a), quad(false) {}
    template <class S>
    T at(const S& xi, const S& eta, const S& product) const {
        const T r = c0 + xi * c1 + eta * c2;
        return quad ? r + product * c3 : r;
    }
    T by_xi(const T& eta) const { return quad ? c1 + eta * c3 : c1; }
    T by_eta(const T& xi) const { return quad ? c2 + xi * c3 : c2; }
};

/// Coordinates of a point within a facet, with their product.
template <class T>
struct Local {
    T xi, eta, product;
};

/// A facet over its coordinates: projected onto the plane, and its height above that.
template <class T>
struct Facet {
    Bilinear<T> u, v, height;
    int n;

    static Bilinear<T> over(const T* a, int n) {
        return n == 4 ? Bilinear<T>(a[0], a[1], a[2], a[3]) : Bilinear<T>(a[0], a[1], a[2]);
    }
    static Facet make(const Planar<T>* q, const T* height, int n) {
        const T u[4] = {q[0].x, q[1].x, q[2].x, q[n - 1].x}, v[4] = {q[0].y, q[1].y, q[2].y, q[n - 1].y};
        return {over(u, n), over(v, n), over(height, n), n};
    }
};

/// Inverse of the projected facet at a point. Newton in plain numbers, then a step with the Jacobian that it
/// ends with, after which values and first derivatives are those of the inverse.
template <class T>
inline Local<T> inverted(const Facet<T>& f, const Planar<T>& p) {
    constexpr double close = 1e-7;  // the next iterate is exact
    const double x = value(p.x), y = value(p.y);
    const double u1 = value(f.u.c1), u2 = value(f.u.c2), u3 = f.n == 4 ? value(f.u.c3) : 0;
    const double v1 = value(f.v.c1), v2 = value(f.v.c2), v3 = f.n == 4 ? value(f.v.c3) : 0;
    const double u0 = value(f.u.c0) - x, v0 = value(f.v.c0) - y;
    double xi = 0, eta = 0, uu = u1, uv = u2, vu = v1, vv = v2, i = 0, step = 1;
    for (int k = 0; k < 12; ++k) {
        uu = u1 + u3 * eta, uv = u2 + u3 * xi, vu = v1 + v3 * eta, vv = v2 + v3 * xi;
        i = 1 / (uu * vv - uv * vu);
        if (step < close) break;
        const double ru = u0 + uu * xi + u2 * eta, rv = v0 + vu * xi + v2 * eta;
        const double s = i * (vv * ru - uv * rv), t = i * (uu * rv - vu * ru);
        xi -= s, eta -= t;
        if (u3 == 0 && v3 == 0) break;
        step = std::abs(s) + std::abs(t);
    }
    const T ru = f.u.at(xi, eta, xi * eta) - p.x, rv = f.v.at(xi, eta, xi * eta) - p.y;
    const T x1 = (-i * vv) * ru + (i * uv) * rv + xi, y1 = (i * vu) * ru + (-i * uu) * rv + eta;
    return {x1, y1, x1 * y1};
}

template <class T>
inline void corner_shapes(int n, const Local<T>& l, T* N) {
    if (n == 4) {
        const double sx[4] = {-0.25, 0.25, 0.25, -0.25}, sy[4] = {-0.25, -0.25, 0.25, 0.25},
                     sp[4] = {0.25, -0.25, 0.25, -0.25};
        for (int a = 0; a < 4; ++a) N[a] = sx[a] * l.xi + sy[a] * l.eta + sp[a] * l.product + 0.25;
    } else if (n == 3) {
        N[0] = (-1.0) * (l.xi + l.eta) + 1.0;
        N[1] = l.xi, N[2] = l.eta;
    } else {
        N[0] = (-1.0) * l.xi + 1.0, N[1] = l.xi;
    }
}

/// The common polygon of two convex ones, the second given clockwise (Sutherland & Hodgman 1974). Behind its
/// corners stands its centroid, about which it is cut into triangles: they change smoothly where corners come
/// and go, and so do integrals that are not exact.
template <class T>
struct Polygon {
    Planar<T> p[2 * segment_corners];
    int line[2 * segment_corners];  // of which facet's edge the one behind a corner is part, see `Outline`
    int n = 0;

    int after(int k) const { return k + 1 < n ? k + 1 : 0; }

    // False where there is no area.
    bool find_centroid(double least) {
        T area = cross(p[1] - p[0], p[2] - p[0]);
        Planar<T> moment = {area * ((p[1].x - p[0].x) + (p[2].x - p[0].x)),
                            area * ((p[1].y - p[0].y) + (p[2].y - p[0].y))};
        for (int k = 2; k + 1 < n; ++k) {
            const Planar<T> b = p[k] - p[0], c = p[k + 1] - p[0];
            const T part = cross(b, c);
            area = area + part;
            moment = {moment.x + part * (b.x + c.x), moment.y + part * (b.y + c.y)};
        }
        if (!(value(area) > 2 * least)) return false;
        const T i = (1.0 / 3) * reciprocal(area);
        p[n] = {p[0].x + i * moment.x, p[0].y + i * moment.y};
        return true;
    }

    // Within `slack` of the edge all is on its inner side, or nothing, as the facet beyond sees it the other
    // way round: what this one does not cut off that one does not have.
    void clip(const Planar<T>& a, const Planar<T>& b, int number, double slack) {
        const Polygon old = *this;
        const Planar<T> along = b - a;
        T distance[2 * segment_corners];
        bool inside[2 * segment_corners];
        double least = 0, most = 0;
        for (int k = 0; k < old.n; ++k) {
            distance[k] = cross(along, old.p[k] - a);
            inside[k] = value(distance[k]) >= 0;
            least = std::min(least, value(distance[k])), most = std::max(most, value(distance[k]));
        }
        if (least >= -slack && most > slack) return;
        n = 0;
        if (most <= slack) return;
        for (int k = 0; k < old.n; ++k) {
            const int m = (k + 1) % old.n;
            if (inside[k]) line[n] = old.line[k], p[n++] = old.p[k];
            if (inside[k] == inside[m]) continue;
            const Planar<T> step = old.p[m] - old.p[k];
            const T t = distance[k] * reciprocal(distance[k] - distance[m]);
            line[n] = inside[k] ? number : old.line[k];
            p[n++] = {old.p[k].x + t * step.x, old.p[k].y + t * step.y};
        }
    }
};

/// Points and weights on triangles, exact to fourth order (Strang & Fix 1973).
inline constexpr int n_triangle_points = 6;
struct TrianglePoint {
    double a, b, w;  // coordinates and share of the area
};
inline constexpr TrianglePoint triangle_points[n_triangle_points] = {
    {0.445948490915965, 0.445948490915965, 0.223381589678011},
    {0.445948490915965, 0.108103018168070, 0.223381589678011},
    {0.108103018168070, 0.445948490915965, 0.223381589678011},
    {0.091576213509771, 0.091576213509771, 0.109951743655322},
    {0.091576213509771, 0.816847572980459, 0.109951743655322},
    {0.816847572980459, 0.091576213509771, 0.109951743655322}};

/// 1 for s < 0, 0 for s > 1, with two continuous derivatives between.
template <class T>
inline T faded(const T& s) {
    const T cube = s * s * s;
    return (-1.0) * (cube * ((-15.0) * s + 6.0 * (s * s) + 10.0)) + 1.0;
}

/// Weight of a segment: less where facets are far apart along the first one's normal, or hardly look at
/// each other. Without it gaps would jump when a pair leaves. Nothing: not at all.
template <class T>
inline std::optional<T> weight(const Vec<T>& n1, const Vec<T>& n2, const Vec<T>& between, double reach) {
    const T facing = dot(n1, n2), along = dot(n1, between);
    const double s = (value(facing) - facing_full) / (facing_none - facing_full);
    const double d = reach > 0 ? 2 * std::abs(value(along)) / reach - 1 : 0;
    if (s >= 1 || d >= 1) return {};
    T w = 0.0 * facing + 1.0;
    if (s > 0) w = w * faded((1 / (facing_none - facing_full)) * (facing + (-facing_full)));
    if (d > 0) w = w * faded(((value(along) > 0 ? 2 : -2) / reach) * along + (-1.0));
    return w;
}

/// Geometry of a segment in space: both facets over their plane, and their common polygon. Lines of its
/// edges: k from the first facet's corner k to the next, `facet_corners` + k the same of the second.
template <class T>
struct Outline {
    Polygon<T> polygon;
    Facet<T> f1, f2;
    Vec<T> e1, e2, normal;         // of the plane
    Planar<T> q[segment_corners];  // places of the facets' corners in it,
    T height[segment_corners];     // and above it
    T weight;
};

template <class T>
inline Vec<T> centre_of(const Vec<T>* x, int n) {
    const Vec<T> sum = x[0] + x[1] + x[2];
    return (1.0 / n) * (n == 4 ? sum + x[3] : sum);
}
template <class T>
inline Vec<T> normal_of(const Vec<T>* x, int n) {
    return unit(n == 4 ? cross(x[2] - x[0], x[3] - x[1]) : cross(x[1] - x[0], x[2] - x[0]));
}

template <class T>
inline std::optional<Outline<T>> outline(const Vec<T>* first, int n1, const Vec<T>* second, int n2,
                                         const Range& range) {
    const Vec<T> centre = centre_of(first, n1), normal = normal_of(first, n1);
    const Vec<T> facing = normal_of(second, n2), between = centre_of(second, n2) - centre;
    const auto w = weight(normal, facing, between, range.reach);
    if (!w) return {};
    const Vec<T> edge = first[1] - first[0];
    Outline<T> o;
    o.weight = *w, o.normal = normal;
    o.e1 = unit(edge - dot(edge, normal) * normal), o.e2 = cross(normal, o.e1);
    double size = 0;
    auto place = [&](int k, const Vec<T>& x) {
        const Vec<T> r = x - centre;
        o.q[k] = {dot(o.e1, r), dot(o.e2, r)}, o.height[k] = dot(normal, r);
    };
    Polygon<T>& polygon = o.polygon;
    for (int k = 0; k < n1; ++k) {
        place(k, first[k]);
        size += value(o.q[k].x) * value(o.q[k].x) + value(o.q[k].y) * value(o.q[k].y);
        polygon.p[k] = o.q[k], polygon.line[k] = k;
    }
    polygon.n = n1;
    const Planar<T>* const q2 = o.q + facet_corners;
    for (int k = 0; k < n2; ++k) place(facet_corners + k, second[k]);
    for (int k = n2 - 1; k >= 0 && polygon.n > 2; --k)
        polygon.clip(q2[(k + 1) % n2], q2[k], facet_corners + k, along_each_other * size);
    if (polygon.n < 3 || !polygon.find_centroid(1e-14 * size)) return {};
    const Planar<T>& middle = polygon.p[polygon.n];
    const Vec<T> there = between - (middle.x * o.e1 + middle.y * o.e2);
    if (!range.holds(value(dot(facing, there)) / value(dot(facing, normal)))) return {};
    o.f1 = Facet<T>::make(o.q, o.height, n1), o.f2 = Facet<T>::make(q2, o.height + facet_corners, n2);
    return o;
}

/// Calls each(weight, N of the first facet, N of the second, x2 - x1) at every quadrature point of a segment.
template <class T, class F>
inline bool integrate_3d(const Vec<T>* first, int n1, const Vec<T>* second, int n2, const Range& range,
                         F each) {
    const auto o = outline(first, n1, second, n2, range);
    if (!o) return false;
    const Polygon<T>& polygon = o->polygon;
    for (int k = 0; k < polygon.n; ++k) {
        const Planar<T>&a = polygon.p[polygon.n], ab = polygon.p[k] - a, ac = polygon.p[polygon.after(k)] - a;
        const T area = 0.5 * cross(ab, ac);
        for (const TrianglePoint& g : triangle_points) {
            const Planar<T> p = {a.x + g.a * ab.x + g.b * ac.x, a.y + g.a * ab.y + g.b * ac.y};
            const Local<T> l1 = inverted(o->f1, p), l2 = inverted(o->f2, p);
            T N1[facet_corners], N2[facet_corners];
            corner_shapes(n1, l1, N1), corner_shapes(n2, l2, N2);
            const T gap =
                o->f2.height.at(l2.xi, l2.eta, l2.product) - o->f1.height.at(l1.xi, l1.eta, l1.product);
            each(g.w * (o->weight * area), N1, N2, gap * o->normal);
        }
    }
    return true;
}

inline constexpr double pi = 3.14159265358979323846;

/// Points and weights on (0, 1), exact to fifth order.
inline constexpr double line_points[3] = {0.112701665379258, 0.5, 0.887298334620742};
inline constexpr double line_weights[3] = {0.277777777777778, 0.444444444444444, 0.277777777777778};

/// The same for edges in the plane, projected along the normal of the first.
template <class T, class F>
inline bool integrate_2d(const Vec<T>* first, const Vec<T>* second, const Range& range, bool axisymmetric,
                         F each) {
    const Vec<T> along = first[1] - first[0], other = second[1] - second[0];
    const Vec<T> n1 = unit(Vec<T>{along.y, (-1.0) * along.x, 0.0 * along.x});
    const Vec<T> n2 = unit(Vec<T>{other.y, (-1.0) * other.x, 0.0 * other.x});
    const auto counts =
        weight(n1, n2, 0.5 * (second[0] + second[1]) - 0.5 * (first[0] + first[1]), range.reach);
    if (!counts) return false;
    const T length2 = dot(along, along), scale = reciprocal(length2);
    const T s0 = scale * dot(second[0] - first[0], along), s1 = scale * dot(second[1] - first[0], along);
    if (!(value(s1) < value(s0) - 1e-12)) return false;
    constexpr double slack = 1e-12;  // what one edge does not cut off, the next one does not have
    const T low = value(s1) > slack ? s1 : 0.0 * s1, high = value(s0) < 1 - slack ? s0 : 0.0 * s0 + 1.0;
    if (!(value(high) - value(low) > slack)) return false;
    const double middle = (0.5 * (value(low) + value(high)) - value(s0)) / (value(s1) - value(s0));
    const auto above = [&](const Vec<T>& a) { return value(dot(n1, a - first[0])); };
    if (!range.holds((1 - middle) * above(second[0]) + middle * above(second[1]))) return false;
    const T length = *counts * root(length2), part = high - low, slope = reciprocal(s1 - s0);
    for (int g = 0; g < 3; ++g) {
        const T s = low + line_points[g] * part, t = slope * (s - s0);
        T N1[2] = {(-1.0) * s + 1.0, s}, N2[2] = {(-1.0) * t + 1.0, t};
        const Vec<T> place = first[0] + s * along, gap = second[0] + t * (second[1] - second[0]) - place;
        const T w = line_weights[g] * (part * length);
        each(axisymmetric ? w * (2 * pi * place.x) : w, N1, N2, gap);
    }
    return true;
}

template <class T, class F>
inline bool integrate(const Vec<T>* x, const FacetPair& p, F each) {
    return p.n_first == 2 ? integrate_2d(x, x + facet_corners, p.range, p.axisymmetric, each)
                          : integrate_3d(x, p.n_first, x + facet_corners, p.n_second, p.range, each);
}

}  // namespace visviva::VISVIVA_ISA
