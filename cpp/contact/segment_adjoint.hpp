// Derivatives of the integrals over a segment in space, by hand at the quadrature points, where nearly all
// the work is, and by a tape for the outline.
#pragma once
#include "segment_geometry.hpp"

namespace visviva::VISVIVA_ISA {

/// Adjoints of an outline's coefficients: x, y, z, u, v of both facets, and corners of the polygon with
/// its centroid.
template <class T>
struct OutlineAdjoint {
    T f1[5][4], f2[5][4];
    Planar<T> p[2 * segment_corners];
    T weight;
};

/// A function over the first facet with constant covectors at its corners.
struct Covectors {
    double c[4][3];  // coefficients of 1, xi, eta, xi eta
    Covectors() = default;
    Covectors(const double (*u)[3], int n) {
        for (int i = 0; i < 3; ++i) {
            const Bilinear<double> b = n == 4 ? Bilinear<double>(u[0][i], u[1][i], u[2][i], u[3][i])
                                              : Bilinear<double>(u[0][i], u[1][i], u[2][i]);
            c[0][i] = b.c0, c[1][i] = b.c1, c[2][i] = b.c2, c[3][i] = n == 4 ? b.c3 : 0;
        }
    }
};

template <class T>
inline T combination(const double (*c)[3], int i, const Local<T>& l) {
    return c[1][i] * l.xi + c[2][i] * l.eta + c[3][i] * l.product + c[0][i];
}

/// From adjoints of a facet's coordinates at a point of the plane back to its planar coefficients and the
/// point.
template <class T>
inline Planar<T> back_to_plane(const Facet<T>& f, const Local<T>& l, const T& xi, const T& eta, T (*bar)[4]) {
    const T uu = f.u.by_xi(l.eta), uv = f.u.by_eta(l.xi), vu = f.v.by_xi(l.eta), vv = f.v.by_eta(l.xi);
    const T i = reciprocal(uu * vv - uv * vu);
    const Planar<T> p = {i * (vv * xi - vu * eta), i * (uu * eta - uv * xi)};
    for (int k = 0; k < 2; ++k) {
        const T minus = (-1.0) * (k == 0 ? p.x : p.y);
        T* c = bar[3 + k];
        add_to(c[0], minus), add_to(c[1], l.xi * minus), add_to(c[2], l.eta * minus);
        if (f.n == 4) add_to(c[3], l.product * minus);
    }
    return p;
}

/// Adjoint `d` of a facet's position at a point: onto its coefficients; adjoints of its coordinates.
template <class T>
inline Planar<T> back_to_coordinates(const Facet<T>& f, const Local<T>& l, const Vec<T>& d, T (*bar)[4]) {
    const T* const each[3] = {&d.x, &d.y, &d.z};
    for (int k = 0; k < 3; ++k) {
        T* c = bar[k];
        add_to(c[0], *each[k]), add_to(c[1], l.xi * *each[k]), add_to(c[2], l.eta * *each[k]);
        if (f.n == 4) add_to(c[3], l.product * *each[k]);
    }
    return {d.x * f.x.by_xi(l.eta) + d.y * f.y.by_xi(l.eta) + d.z * f.z.by_xi(l.eta),
            d.x * f.x.by_eta(l.xi) + d.y * f.y.by_eta(l.xi) + d.z * f.z.by_eta(l.xi)};
}

/// Adjoints of the integral of q . (x2 - x1) at one point; returns those of the point and of the weight.
template <class T>
struct PointAdjoint {
    Planar<T> p;
    T w;
};
template <class T>
inline PointAdjoint<T> back(const Outline<T>& o, const Covectors& u, const Local<T>& l1, const Local<T>& l2,
                            const T& w, const Vec<T>& gap, OutlineAdjoint<T>& bar) {
    const Vec<T> q = {combination(u.c, 0, l1), combination(u.c, 1, l1), combination(u.c, 2, l1)};
    const Vec<T> to_gap = w * q;
    const Planar<T> c2 = back_to_coordinates(o.f2, l2, to_gap, bar.f2);
    const Planar<T> p2 = back_to_plane(o.f2, l2, c2.x, c2.y, bar.f2);
    Planar<T> c1 = back_to_coordinates(o.f1, l1, (-1.0) * to_gap, bar.f1);
    const T* const each[3] = {&gap.x, &gap.y, &gap.z};
    T by_xi = {}, by_eta = {};
    for (int i = 0; i < 3; ++i) {
        add_to(by_xi, *each[i] * (u.c[3][i] * l1.eta + u.c[1][i]));
        add_to(by_eta, *each[i] * (u.c[3][i] * l1.xi + u.c[2][i]));
    }
    add_to(c1.x, w * by_xi), add_to(c1.y, w * by_eta);
    const Planar<T> p1 = back_to_plane(o.f1, l1, c1.x, c1.y, bar.f1);
    return {{p1.x + p2.x, p1.y + p2.y}, dot(q, gap)};
}

/// Adjoints of all coefficients for K sets of covectors; `also(w, l1, gap)` sees every point.
template <class T, int K, class Also>
inline void back_all(const Outline<T>& o, const Covectors* u, OutlineAdjoint<T>* bar, Also also) {
    const int n = o.polygon.n;
    for (int k = 0; k < n; ++k) {
        const int next = o.polygon.after(k);
        const Planar<T>&a = o.polygon.p[n], ab = o.polygon.p[k] - a, ac = o.polygon.p[next] - a;
        const T whole = 0.5 * cross(ab, ac), area = o.weight * whole;
        T area_bar[K] = {};
        for (const TrianglePoint& g : triangle_points) {
            const Planar<T> p = {a.x + g.a * ab.x + g.b * ac.x, a.y + g.a * ab.y + g.b * ac.y};
            const Local<T> l1 = inverted(o.f1, p), l2 = inverted(o.f2, p);
            const Vec<T> gap = o.f2.position(l2) - o.f1.position(l1);
            const T w = g.w * area;
            also(w, l1, gap);
            for (int s = 0; s < K; ++s) {
                const PointAdjoint<T> r = back(o, u[s], l1, l2, w, gap, bar[s]);
                add_to(area_bar[s], g.w * r.w);
                const double share[3] = {1 - g.a - g.b, g.a, g.b};
                const int corner[3] = {n, k, next};
                for (int c = 0; c < 3; ++c)
                    add_to(bar[s].p[corner[c]].x, share[c] * r.p.x),
                        add_to(bar[s].p[corner[c]].y, share[c] * r.p.y);
            }
        }
        for (int s = 0; s < K; ++s) {
            add_to(bar[s].weight, area_bar[s] * whole);
            const T half = 0.5 * (area_bar[s] * o.weight);
            const T bx = half * ac.y, by = (-1.0) * (half * ac.x), cx = (-1.0) * (half * ab.y),
                    cy = half * ab.x;
            Planar<T>* p = bar[s].p;
            add_to(p[k].x, bx), add_to(p[k].y, by), add_to(p[next].x, cx), add_to(p[next].y, cy);
            add_to(p[n].x, (-1.0) * (bx + cx)), add_to(p[n].y, (-1.0) * (by + cy));
        }
    }
}

}  // namespace visviva::VISVIVA_ISA
