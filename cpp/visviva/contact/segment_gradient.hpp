// First derivatives of the integrals I_a of N_a h over a segment in space, h the height of the second facet
// over the first: along the normal e3 of the plane of projection, V_a = I_a e3. By hand, in reverse: from the
// quadrature points to the corners of the triangles, to those of both facets in the plane, to space.
#pragma once
#include "visviva/contact/segment_corners.hpp"

namespace visviva::VISVIVA_ISA {

inline constexpr int planar_size = 2 * segment_corners;

/// Of I_a by the facets' corners in the plane, [2 k + i][a], and by their heights above it, [k][a]; and by
/// the corners of the polygon with its centroid last, the others as if it stood by itself.
template <class T>
struct LocalGradient {
    T integral[facet_corners] = {};
    T planar[planar_size][facet_corners] = {}, height[segment_corners][facet_corners] = {};
    T corner[4 * segment_corners][facet_corners] = {};

    explicit LocalGradient(const Outline<T>& o) : n1_(o.f1.n), n2_(o.f2.n) {
        for (int k = 0; k < o.polygon.n; ++k) add_triangle(o, k);
    }

    /// From the polygon's corners to those of the facets.
    void finish(const Outline<T>& o) {
        const int n = o.polygon.n;
        Centroid<T>(o.polygon).spread(corner + 2 * n, corner);
        for (int k = 0; k < n; ++k) PolygonCorner<T>(o, k).spread(corner + 2 * k, planar);
    }

  private:
    void add_triangle(const Outline<T>& o, int k) {
        const Polygon<T>& polygon = o.polygon;
        const int at[3] = {polygon.n, k, polygon.after(k)};
        const Planar<T>&origin = polygon.p[at[0]], b = polygon.p[at[1]] - origin,
              c = polygon.p[at[2]] - origin;
        const T area = 0.5 * cross(b, c);
        T by_area[facet_corners] = {};
        for (const TrianglePoint& g : triangle_points) {
            const Planar<T> p = {origin.x + g.a * b.x + g.b * c.x, origin.y + g.a * b.y + g.b * c.y};
            const FacetAt<T> one(o.f1, p), two(o.f2, p);
            const double share[3] = {1 - g.a - g.b, g.a, g.b};
            add_point(g.w * area, g.w, one, two, share, at, by_area);
        }
        for (int a = 0; a < n1_; ++a) {
            const T half = 0.5 * by_area[a], bx = half * c.y, by = (-1.0) * (half * c.x),
                    cx = (-1.0) * (half * b.y), cy = half * b.x;
            add_to(corner[2 * at[1]][a], bx), add_to(corner[2 * at[1] + 1][a], by);
            add_to(corner[2 * at[2]][a], cx), add_to(corner[2 * at[2] + 1][a], cy);
            add_to(corner[2 * at[0]][a], (-1.0) * (bx + cx)),
                add_to(corner[2 * at[0] + 1][a], (-1.0) * (by + cy));
        }
    }

    void add_point(const T& w, double share_of_area, const FacetAt<T>& one, const FacetAt<T>& two,
                   const double* share, const int* at, T* by_area) {
        const T h = two.height - one.height;
        for (int a = 0; a < n1_; ++a) {
            const T weighted = w * one.N[a], wh = w * h, Nh = one.N[a] * h;
            add_to(integral[a], w * Nh), add_to(by_area[a], share_of_area * Nh);
            const T x1 = wh * one.grad[a].x - weighted * one.slope.x,
                    y1 = wh * one.grad[a].y - weighted * one.slope.y;
            const T x2 = weighted * two.slope.x, y2 = weighted * two.slope.y;
            const T x = x1 + x2, y = y1 + y2;
            for (int c = 0; c < 3; ++c)
                add_to(corner[2 * at[c]][a], share[c] * x), add_to(corner[2 * at[c] + 1][a], share[c] * y);
            for (int i = 0; i < n1_; ++i) {
                const T minus = (-1.0) * one.N[i];
                add_to(planar[2 * i][a], minus * x1), add_to(planar[2 * i + 1][a], minus * y1);
                add_to(height[i][a], minus * weighted);
            }
            for (int j = 0; j < n2_; ++j) {
                const int k = facet_corners + j;
                const T minus = (-1.0) * two.N[j];
                add_to(planar[2 * k][a], minus * x2), add_to(planar[2 * k + 1][a], minus * y2);
                add_to(height[k][a], two.N[j] * weighted);
            }
        }
    }

    int n1_, n2_;
};

/// The plane of projection turns with m = d1 x d2, of directions between corners of the first facet.
template <class T>
struct Tilt {
    int from[2], to[2];
    Vec<T> d[2];
    T i;  // 1 / |m|

    Tilt(const Vec<T>* x, int n) : from{0, n == 4 ? 1 : 0}, to{n == 4 ? 2 : 1, n == 4 ? 3 : 2} {
        for (int k = 0; k < 2; ++k) d[k] = x[to[k]] - x[from[k]];
        const Vec<T> m = cross(d[0], d[1]);
        i = reciprocal(root(dot(m, m)));
    }
};

template <class T>
inline void add_to(T* g, const Vec<T>& a, double sign) {
    add_to(g[0], sign * a.x), add_to(g[1], sign * a.y), add_to(g[2], sign * a.z);
}

/// Of n_a . V_a by the corners in space, for constant covectors n_a.
template <class T>
inline void to_space(const Outline<T>& o, const LocalGradient<T>& local, const Vec<T>* x,
                     const double (*n)[3], T (*g)[segment_size]) {
    const Tilt<T> tilt(x, o.f1.n);
    for (int a = 0; a < o.f1.n; ++a) {
        auto along = [&](const Vec<T>& e) { return n[a][0] * e.x + n[a][1] * e.y + n[a][2] * e.z; };
        const T c = along(o.normal);
        T by_e1 = {}, by_e2 = {};  // of I_a, as the normal turns towards e1 and e2
        for (int k = 0; k < segment_corners; ++k) {
            if (k >= o.f1.n && (k < facet_corners || k - facet_corners >= o.f2.n)) continue;
            const T &u = local.planar[2 * k][a], &v = local.planar[2 * k + 1][a], &w = local.height[k][a];
            add_to(by_e1, w * o.q[k].x - u * o.height[k]), add_to(by_e2, w * o.q[k].y - v * o.height[k]);
            add_to(g[a] + 3 * k, (c * u) * o.e1 + (c * v) * o.e2 + (c * w) * o.normal, 1);
        }
        const T to1 = tilt.i * (local.integral[a] * along(o.e1) + c * by_e1),
                to2 = tilt.i * (local.integral[a] * along(o.e2) + c * by_e2);
        const Vec<T> m = to1 * o.e1 + to2 * o.e2;
        const Vec<T> back[2] = {cross(tilt.d[1], m), cross(m, tilt.d[0])};
        for (int k = 0; k < 2; ++k)
            add_to(g[a] + 3 * tilt.to[k], back[k], 1), add_to(g[a] + 3 * tilt.from[k], back[k], -1);
    }
}

}  // namespace visviva::VISVIVA_ISA
