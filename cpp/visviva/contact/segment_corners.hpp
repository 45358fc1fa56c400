// Derivatives of the corners and centroid of a segment's polygon by the corners of both facets in their
// plane. Adjoints come in pairs of rows, for x and y, of L at once.
#pragma once
#include "visviva/contact/segment_geometry.hpp"

namespace visviva::VISVIVA_ISA {

/// A corner of a facet, or the crossing of the lines a - b and c - d through corners of facets.
template <class T>
struct PolygonCorner {
    int vertex = -1, a, b, c, d;
    T t, tau;          // where the crossing lies between a and b, and between c and d
    Planar<T> ab, cd;  // from a to b, from c to d
    T i;               // 1 / (ab x cd)

    static int begin_of(int line) { return line; }
    static int end_of(int line, int n1, int n2) {
        const int first = line < facet_corners ? 0 : facet_corners, n = first == 0 ? n1 : n2;
        return first + (line - first + 1) % n;
    }

    PolygonCorner() = default;
    PolygonCorner(const Outline<T>& o, int k) {
        const Polygon<T>& p = o.polygon;
        const int one = p.line[k > 0 ? k - 1 : p.n - 1], two = p.line[k];
        a = begin_of(one), b = end_of(one, o.f1.n, o.f2.n), c = begin_of(two),
        d = end_of(two, o.f1.n, o.f2.n);
        if (a == c || a == d)
            vertex = a;
        else if (b == c || b == d)
            vertex = b;
        if (vertex >= 0) return;
        ab = o.q[b] - o.q[a], cd = o.q[d] - o.q[c];
        i = reciprocal(cross(ab, cd));
        t = i * cross(o.q[c] - o.q[a], cd), tau = i * cross(o.q[c] - o.q[a], ab);
    }

    /// Adds to the adjoints of the facets' corners (two rows each) what follows from those of this corner.
    template <int L>
    void spread(const T (*bar)[L], T (*facets)[L]) const {
        if (vertex >= 0) {
            for (int r = 0; r < 2; ++r)
                for (int l = 0; l < L; ++l) add_to(facets[2 * vertex + r][l], bar[r][l]);
            return;
        }
        for (int l = 0; l < L; ++l) {
            const T across = i * (bar[0][l] * ab.x + bar[1][l] * ab.y);
            const T other[2] = {across * cd.y, (-1.0) * (across * cd.x)};
            for (int r = 0; r < 2; ++r) {
                const T own = bar[r][l] - other[r], part = t * own, far = tau * other[r];
                add_to(facets[2 * a + r][l], own - part), add_to(facets[2 * b + r][l], part);
                add_to(facets[2 * c + r][l], other[r] - far), add_to(facets[2 * d + r][l], far);
            }
        }
    }
};

/// The same for the centroid, seen from where it is.
template <class T>
struct Centroid {
    int n;
    Planar<T> p[2 * segment_corners], sum[2 * segment_corners];  // a corner, and with the next one
    T part[2 * segment_corners];                                 // the cross product of both
    T third;                                                     // 1 / (3 * sum of all parts)

    explicit Centroid(const Polygon<T>& polygon) : n(polygon.n) {
        for (int k = 0; k < n; ++k) p[k] = polygon.p[k] - polygon.p[n];
        T whole = {};
        for (int k = 0; k < n; ++k) {
            const Planar<T>& next = p[polygon.after(k)];
            sum[k] = {p[k].x + next.x, p[k].y + next.y}, part[k] = cross(p[k], next);
            add_to(whole, part[k]);
        }
        third = (1.0 / 3) * reciprocal(whole);
    }

    /// Adds to the adjoints of the polygon's corners what follows from those of the centroid.
    template <int L>
    void spread(const T (*bar)[L], T (*corners)[L]) const {
        for (int k = 0; k < n; ++k) {
            const int m = k + 1 < n ? k + 1 : 0;
            for (int l = 0; l < L; ++l) {
                const T along = third * (bar[0][l] * sum[k].x + bar[1][l] * sum[k].y),
                        share = third * part[k];
                const T x = share * bar[0][l], y = share * bar[1][l];
                add_to(corners[2 * k][l], along * p[m].y + x);
                add_to(corners[2 * k + 1][l], y - along * p[m].x);
                add_to(corners[2 * m][l], x - along * p[k].y);
                add_to(corners[2 * m + 1][l], along * p[k].x + y);
            }
        }
    }
};

/// A facet at a point of the plane.
template <class T>
struct FacetAt {
    T N[facet_corners];             // shapes of the corners
    Planar<T> grad[facet_corners];  // their gradients
    T height;                       // above the plane,
    Planar<T> slope;                // and its gradient
    T by_point[2][2];               // coordinates by the point

    FacetAt(const Facet<T>& f, const Planar<T>& p) {
        const Local<T> l = inverted(f, p);
        corner_shapes(f.n, l, N);
        const T uu = f.u.by_xi(l.eta), uv = f.u.by_eta(l.xi), vu = f.v.by_xi(l.eta), vv = f.v.by_eta(l.xi);
        const T i = reciprocal(uu * vv - uv * vu);
        by_point[0][0] = i * vv, by_point[0][1] = (-1.0) * (i * uv);
        by_point[1][0] = (-1.0) * (i * vu), by_point[1][1] = i * uu;
        height = f.height.at(l.xi, l.eta, l.product);
        slope = gradient(f.height.by_xi(l.eta), f.height.by_eta(l.xi));
        for (int a = 0; a < f.n; ++a) grad[a] = shape_gradient(f.n, a, l);
    }

    Planar<T> gradient(const T& by_xi, const T& by_eta) const {
        return {by_point[0][0] * by_xi + by_point[1][0] * by_eta,
                by_point[0][1] * by_xi + by_point[1][1] * by_eta};
    }

  private:
    Planar<T> shape_gradient(int n, int a, const Local<T>& l) const {
        if (n == 4) {
            const double x[4] = {-0.25, 0.25, 0.25, -0.25}, y[4] = {-0.25, -0.25, 0.25, 0.25},
                         p[4] = {0.25, -0.25, 0.25, -0.25};
            return gradient(p[a] * l.eta + x[a], p[a] * l.xi + y[a]);
        }
        const double x[3] = {-1, 1, 0}, y[3] = {-1, 0, 1};
        return {x[a] * by_point[0][0] + y[a] * by_point[1][0], x[a] * by_point[0][1] + y[a] * by_point[1][1]};
    }
};

}  // namespace visviva::VISVIVA_ISA
