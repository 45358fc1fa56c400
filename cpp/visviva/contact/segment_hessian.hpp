// Second derivatives of the sum of c_a I_a over a segment in space (see segment_gradient.hpp), by hand: sums
// of products of linear forms. With M the sum of products r s the second derivatives are M + M^T.
#pragma once
#include "visviva/contact/segment_gradient.hpp"

namespace visviva::VISVIVA_ISA {

class LocalHessian {
  public:
    /// `gradient` before its corners are spread.
    LocalHessian(const Outline<double>& o, const LocalGradient<double>& gradient, const double* c)
        : o_(o), n_(o.polygon.n), centroid_(o.polygon), c_(c) {
        for (int k = 0; k < n_; ++k) corner_[k] = PolygonCorner<double>(o, k);
        find_motion();
        for (int k = 0; k < n_; ++k) add_triangle(k);
        curve(gradient);
        collapse();
    }

    /// The sum of products: rows of planar coordinates, columns of those and of heights.
    const double (*products() const)[segment_size] { return products_; }

  private:
    using Row = double[segment_size];

    // Derivatives of the corners of the polygon and of the centroid by the facets' corners.
    void find_motion() {
        for (int k = 0; k <= n_; ++k) {
            double unit[4 * segment_corners][2] = {};
            unit[2 * k][0] = unit[2 * k + 1][1] = 1;
            double rows[planar_size][2] = {};
            if (k == n_) centroid_.spread(unit + 2 * n_, unit);
            for (int j = 0; j < n_; ++j)
                if (k == n_ || j == k) corner_[j].spread(unit + 2 * j, rows);
            for (int i = 0; i < planar_size; ++i)
                for (int r = 0; r < 2; ++r) motion_[2 * k + r][i] = rows[i][r];
        }
    }

    void add_triangle(int k) {
        const Polygon<double>& polygon = o_.polygon;
        const int at[3] = {n_, k, polygon.after(k)};
        const Planar<double>&origin = polygon.p[at[0]], b = polygon.p[at[1]] - origin,
              c = polygon.p[at[2]] - origin;
        const double area = 0.5 * cross(b, c);
        Row sum = {};      // of the integrand's variations, by shares of the area
        double whole = 0;  // of the integrand
        for (const TrianglePoint& g : triangle_points) {
            const Planar<double> p = {origin.x + g.a * b.x + g.b * c.x, origin.y + g.a * b.y + g.b * c.y};
            const double share[3] = {1 - g.a - g.b, g.a, g.b};
            whole += g.w * add_point(g.w, area, FacetAt<double>(o_.f1, p), FacetAt<double>(o_.f2, p), share,
                                     at, sum);
        }
        // the area's variation 1/2 (b x c)
        const double by[3][2] = {{b.y - c.y, c.x - b.x}, {c.y, -c.x}, {-b.y, b.x}};
        for (int i = 0; i < 3; ++i)
            for (int r = 0; r < 2; ++r) add(extended_[planar_size + 2 * at[i] + r], 0.5 * by[i][r], sum);
        for (int r = 0; r < 2; ++r) {
            const double half = r == 0 ? 0.5 * whole : -0.5 * whole;
            for (int i = 0; i < planar_size; ++i) {
                const double turned = half * (motion_[2 * at[2] + 1 - r][i] - motion_[2 * n_ + 1 - r][i]);
                extended_[planar_size + 2 * at[1] + r][i] += turned;
                extended_[planar_size + 2 * n_ + r][i] -= turned;
            }
        }
    }

    static void add(double* to, double factor, const double* row) {
        for (int i = 0; i < segment_size; ++i) to[i] += factor * row[i];
    }

    // Of q h with q = sum c_a N_a; returns that, and adds its variation to `sum`.
    double add_point(double share_of_area, double area, const FacetAt<double>& one,
                     const FacetAt<double>& two, const double* share, const int* at, double* sum) {
        const double h = two.height - one.height, w = share_of_area * area;
        double q = 0;
        Planar<double> grad = {0, 0};
        for (int a = 0; a < o_.f1.n; ++a)
            q += c_[a] * one.N[a], grad.x += c_[a] * one.grad[a].x, grad.y += c_[a] * one.grad[a].y;
        // the point's motion, and that relative to both facets
        double s1[2][planar_size], s2[2][planar_size];
        for (int r = 0; r < 2; ++r) {
            for (int i = 0; i < planar_size; ++i)
                s1[r][i] = share[0] * motion_[2 * at[0] + r][i] + share[1] * motion_[2 * at[1] + r][i] +
                           share[2] * motion_[2 * at[2] + r][i];
            for (int i = 0; i < planar_size; ++i) s2[r][i] = s1[r][i];
            for (int i = 0; i < o_.f1.n; ++i) s1[r][2 * i + r] -= one.N[i];
            for (int j = 0; j < o_.f2.n; ++j) s2[r][2 * (facet_corners + j) + r] -= two.N[j];
        }
        Row dh = {};
        for (int i = 0; i < planar_size; ++i)
            dh[i] = two.slope.x * s2[0][i] + two.slope.y * s2[1][i] - one.slope.x * s1[0][i] -
                    one.slope.y * s1[1][i];
        for (int i = 0; i < o_.f1.n; ++i) dh[planar_size + i] = -one.N[i];
        for (int j = 0; j < o_.f2.n; ++j) dh[planar_size + facet_corners + j] = two.N[j];
        for (int i = 0; i < planar_size; ++i)
            sum[i] += share_of_area * (h * (grad.x * s1[0][i] + grad.y * s1[1][i]));
        add(sum, share_of_area * q, dh);
        // products with s1 and s2: variations of q and h, and those of both facets' coordinates
        Row by1[2], by2[2] = {};
        for (int r = 0; r < 2; ++r)
            for (int i = 0; i < segment_size; ++i) by1[r][i] = w * (r == 0 ? grad.x : grad.y) * dh[i];
        const Planar<double> t1 = {w * (h * grad.x - q * one.slope.x), w * (h * grad.y - q * one.slope.y)};
        const Planar<double> t2 = {w * q * two.slope.x, w * q * two.slope.y};
        distort(o_.f1, one, 0, t1, -w * q, by1), distort(o_.f2, two, facet_corners, t2, w * q, by2);
        if (o_.f1.n == 4) {
            const double q3 = 0.25 * (c_[0] - c_[1] + c_[2] - c_[3]);
            bend(o_.f1, one, t1, w * (h * q3 - q * o_.f1.height.c3), s1, by1);
        }
        if (o_.f2.n == 4) bend(o_.f2, two, t2, w * q * o_.f2.height.c3, s2, by2);
        scatter(one, two, share, at, by1, by2);
        return q * h;
    }

    // Of the facets' bilinear coordinates: their gradients turn and stretch,
    static void distort(const Facet<double>& f, const FacetAt<double>& p, int first, const Planar<double>& t,
                        double by_height, double (*by)[segment_size]) {
        for (int i = 0; i < f.n; ++i) {
            const int k = first + i;
            const double g[2] = {p.grad[i].x, p.grad[i].y};
            for (int r = 0; r < 2; ++r) {
                by[r][2 * k] -= t.x * g[r], by[r][2 * k + 1] -= t.y * g[r];
                by[r][planar_size + k] += by_height * g[r];
            }
        }
    }
    // and their product changes as both do.
    static void bend(const Facet<double>& f, const FacetAt<double>& p, const Planar<double>& t, double own,
                     const double (*s)[planar_size], double (*by)[segment_size]) {
        const double kappa = own - t.x * f.u.c3 - t.y * f.v.c3;
        if (kappa == 0) return;
        const double *xi = p.by_point[0], *eta = p.by_point[1];
        for (int r = 0; r < 2; ++r)
            for (int i = 0; i < planar_size; ++i)
                by[r][i] += kappa * xi[r] * (eta[0] * s[0][i] + eta[1] * s[1][i]);
    }

    // s1 and s2 themselves are kept as what they are made of.
    void scatter(const FacetAt<double>& one, const FacetAt<double>& two, const double* share, const int* at,
                 const double (*by1)[segment_size], const double (*by2)[segment_size]) {
        for (int r = 0; r < 2; ++r) {
            Row both;
            for (int i = 0; i < segment_size; ++i) both[i] = by1[r][i] + by2[r][i];
            for (int c = 0; c < 3; ++c) add(extended_[planar_size + 2 * at[c] + r], share[c], both);
            for (int i = 0; i < o_.f1.n; ++i) add(extended_[2 * i + r], -one.N[i], by1[r]);
            for (int j = 0; j < o_.f2.n; ++j) add(extended_[2 * (facet_corners + j) + r], -two.N[j], by2[r]);
        }
    }

    // Second derivatives of the centroid and of crossings, by their adjoints.
    void curve(const LocalGradient<double>& gradient) {
        double bar[4 * segment_corners][1] = {};
        for (int k = 0; k < 2 * (n_ + 1); ++k)
            for (int a = 0; a < o_.f1.n; ++a) bar[k][0] += c_[a] * gradient.corner[k][a];
        curve_centroid(bar[2 * n_][0], bar[2 * n_ + 1][0]);
        centroid_.spread(bar + 2 * n_, bar);
        for (int k = 0; k < n_; ++k)
            if (corner_[k].vertex < 0) curve_crossing(corner_[k], bar[2 * k][0], bar[2 * k + 1][0]);
    }

    void curve_centroid(double x, double y) {
        double whole[planar_size] = {};  // of the sum of all parts, three times that of a third
        auto row = [&](int k, int r) { return motion_[2 * k + r]; };
        for (int k = 0; k < n_; ++k) {
            const int m = k + 1 < n_ ? k + 1 : 0;
            const Planar<double>&p = centroid_.p[k], &next = centroid_.p[m];
            const double along = centroid_.third * (x * centroid_.sum[k].x + y * centroid_.sum[k].y);
            double* own[2] = {extended_[planar_size + 2 * k], extended_[planar_size + 2 * k + 1]};
            double* other[2] = {extended_[planar_size + 2 * m], extended_[planar_size + 2 * m + 1]};
            for (int i = 0; i < planar_size; ++i) {
                own[0][i] += along * row(m, 1)[i], own[1][i] -= along * row(m, 0)[i];
                const double moved =
                    centroid_.third * (x * (row(k, 0)[i] + row(m, 0)[i]) + y * (row(k, 1)[i] + row(m, 1)[i]));
                own[0][i] += next.y * moved, own[1][i] -= next.x * moved;
                other[0][i] -= p.y * moved, other[1][i] += p.x * moved;
                whole[i] +=
                    next.y * row(k, 0)[i] - next.x * row(k, 1)[i] + p.x * row(m, 1)[i] - p.y * row(m, 0)[i];
            }
        }
        for (int i = 0; i < planar_size; ++i) {
            extended_[planar_size + 2 * n_][i] -= 3 * centroid_.third * x * whole[i];
            extended_[planar_size + 2 * n_ + 1][i] -= 3 * centroid_.third * y * whole[i];
        }
    }

    void curve_crossing(const PolygonCorner<double>& k, double x, double y) {
        const double across = k.i * (x * k.ab.x + y * k.ab.y);
        // of t and tau
        double t[planar_size] = {}, tau[planar_size] = {};
        const double part[4] = {1 - k.t, k.t, k.tau - 1, -k.tau};
        const int end[4] = {k.a, k.b, k.c, k.d};
        for (int e = 0; e < 4; ++e) {
            const double p = k.i * part[e];
            t[2 * end[e]] -= p * k.cd.y, t[2 * end[e] + 1] += p * k.cd.x;
            tau[2 * end[e]] -= p * k.ab.y, tau[2 * end[e] + 1] += p * k.ab.x;
        }
        const double own[2] = {x - across * k.cd.y, y + across * k.cd.x},
                     other[2] = {across * k.cd.y, -across * k.cd.x};
        for (int r = 0; r < 2; ++r)
            for (int i = 0; i < planar_size; ++i) {
                extended_[2 * k.b + r][i] += own[r] * t[i], extended_[2 * k.a + r][i] -= own[r] * t[i];
                extended_[2 * k.d + r][i] += other[r] * tau[i],
                    extended_[2 * k.c + r][i] -= other[r] * tau[i];
            }
    }

    // Rows of the polygon's corners to those of the facets.
    void collapse() {
        Row* corners = extended_ + planar_size;
        centroid_.spread(corners + 2 * n_, corners);
        for (int i = 0; i < planar_size; ++i)
            for (int j = 0; j < segment_size; ++j) products_[i][j] = extended_[i][j];
        for (int k = 0; k < n_; ++k) corner_[k].spread(corners + 2 * k, products_);
    }

    const Outline<double>& o_;
    int n_;
    Centroid<double> centroid_;
    PolygonCorner<double> corner_[2 * segment_corners];
    const double* c_;
    double motion_[4 * segment_corners][planar_size];
    Row extended_[planar_size + 4 * segment_corners] = {}, products_[planar_size];
};

/// Variables of a segment's integrals in space: corners in the frame of the plane, which tilts towards
/// its own axes by the corners of the first facet.
class Spatial {
  public:
    /// `u`: covectors whose components along the normal are the c_a.
    Spatial(const Outline<double>& o, const Vec<double>* x, const double (*u)[3]) : o_(o), tilt_(x, o.f1.n) {
        for (int a = 0; a < o.f1.n; ++a) {
            const Vec<double> v = {u[a][0], u[a][1], u[a][2]};
            c[a] = dot(v, o.normal), across_[0][a] = dot(v, o.e1), across_[1][a] = dot(v, o.e2);
        }
        for (int k = 0; k < segment_corners; ++k) {
            there_[k] = k < facet_corners ? k < o.f1.n : k - facet_corners < o.f2.n;
            if (!there_[k]) continue;
            turn_[0][3 * k] = turn_[1][3 * k + 1] = -o.height[k];
            turn_[0][3 * k + 2] = o.q[k].x, turn_[1][3 * k + 2] = o.q[k].y;
        }
        auto plain = [&](const Vec<double>& d) -> Planar<double> { return {dot(d, o.e1), dot(d, o.e2)}; };
        const Planar<double> d[2] = {plain(tilt_.d[0]), plain(tilt_.d[1])};
        const double i = tilt_.i;
        set(angle_[0], 2, -i * d[1].y, i * d[0].y), set(angle_[1], 2, i * d[1].x, -i * d[0].x);
        set(size_, 0, i * d[1].y, -i * d[0].y), set(size_, 1, -i * d[1].x, i * d[0].x);
    }

    double c[facet_corners] = {};

    /// dV_a/dx = e3 dI_a/dx + I_a de3/dx
    void first(const LocalGradient<double>& local, double (*J)[3][segment_size]) const {
        const double e[3][3] = {{o_.e1.x, o_.e1.y, o_.e1.z},
                                {o_.e2.x, o_.e2.y, o_.e2.z},
                                {o_.normal.x, o_.normal.y, o_.normal.z}};
        Row towards[2], g, by_corners;
        for (int r = 0; r < 2; ++r) to_global(angle_[r], towards[r]);
        for (int a = 0; a < o_.f1.n; ++a) {
            gather(local, a, g);
            const double by[2] = {product(g, turn_[0]), product(g, turn_[1])}, I = local.integral[a];
            for (int i = 0; i < segment_size; ++i) g[i] += by[0] * angle_[0][i] + by[1] * angle_[1][i];
            to_global(g, by_corners);
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < segment_size; ++i)
                    J[a][j][i] =
                        e[2][j] * by_corners[i] + I * (e[0][j] * towards[0][i] + e[1][j] * towards[1][i]);
        }
    }

    /// d2(sum of c_a I_a)/dx2, the covectors constant in space.
    void second(const LocalGradient<double>& local, const double (*products)[segment_size],
                double (*H)[segment_size]) const {
        double M[segment_size][segment_size] = {};
        for (int i = 0; i < planar_size; ++i) {
            double* row = M[3 * (i / 2) + i % 2];
            for (int k = 0; k < segment_corners; ++k)
                row[3 * k] = products[i][2 * k], row[3 * k + 1] = products[i][2 * k + 1],
                        row[3 * k + 2] = products[i][planar_size + k];
        }
        add_tilt(local, M);
        // both factors to space, then the transpose added
        double half[segment_size][segment_size], whole[segment_size][segment_size];
        for (int i = 0; i < segment_size; ++i) to_global(M[i], half[i]);
        transpose(half);
        for (int i = 0; i < segment_size; ++i) to_global(half[i], whole[i]);
        for (int i = 0; i < segment_size; ++i)
            for (int j = 0; j < segment_size; ++j) H[i][j] = whole[i][j] + whole[j][i];
    }

  private:
    using Row = double[segment_size];

    static double product(const double* a, const double* b) {
        double sum = 0;
        for (int i = 0; i < segment_size; ++i) sum += a[i] * b[i];
        return sum;
    }
    static void transpose(Row* a) {
        for (int i = 0; i < segment_size; ++i)
            for (int j = 0; j < i; ++j) std::swap(a[i][j], a[j][i]);
    }
    // A form of the directions between corners, by their component r.
    void set(double* row, int r, double first, double second) const {
        const double by[2] = {first, second};
        for (int k = 0; k < 2; ++k) row[3 * tilt_.to[k] + r] += by[k], row[3 * tilt_.from[k] + r] -= by[k];
    }
    void gather(const LocalGradient<double>& local, int a, double* g) const {
        for (int k = 0; k < segment_corners; ++k)
            g[3 * k] = local.planar[2 * k][a], g[3 * k + 1] = local.planar[2 * k + 1][a],
                  g[3 * k + 2] = local.height[k][a];
    }
    void to_global(const double* row, double* out) const {
        for (int k = 0; k < segment_corners; ++k) {
            const Vec<double> v = row[3 * k] * o_.e1 + row[3 * k + 1] * o_.e2 + row[3 * k + 2] * o_.normal;
            out[3 * k] = v.x, out[3 * k + 1] = v.y, out[3 * k + 2] = v.z;
        }
    }

    // Contribution of the angles of the tilt: coordinates are u - a w - a (a u + b v) / 2, v - b w - b (a u +
    // b v) / 2 and w + a u + b v - (a^2 + b^2) w / 2, and so are the components of the covectors.
    void add_tilt(const LocalGradient<double>& local, Row* M) const {
        Row all = {}, with[2] = {};  // the gradient of the sum, and that with the covectors' derivatives
        double by_angle[2] = {}, twice[2][2] = {}, sum = 0;
        for (int a = 0; a < o_.f1.n; ++a) {
            Row g;
            gather(local, a, g);
            for (int i = 0; i < segment_size; ++i) all[i] += c[a] * g[i];
            sum += c[a] * local.integral[a];
            for (int r = 0; r < 2; ++r) {
                by_angle[r] += across_[r][a] * local.integral[a];
                for (int i = 0; i < segment_size; ++i) with[r][i] += across_[r][a] * g[i];
                for (int s = 0; s < 2; ++s) twice[r][s] += across_[r][a] * product(g, turn_[s]);
            }
        }
        Row curved[2];  // M + M^T times the turn
        for (int r = 0; r < 2; ++r) {
            by_angle[r] += product(all, turn_[r]);
            for (int i = 0; i < segment_size; ++i) curved[r][i] = product(M[i], turn_[r]);
            for (int j = 0; j < segment_size; ++j)
                for (int i = 0; i < segment_size; ++i) curved[r][i] += turn_[r][j] * M[j][i];
        }
        double pure[2][2];
        for (int r = 0; r < 2; ++r)
            for (int s = 0; s < 2; ++s) pure[r][s] = product(turn_[r], curved[s]) + twice[r][s] + twice[s][r];
        for (int r = 0; r < 2; ++r) pure[r][r] -= sum;
        for (int k = 0; k < segment_corners; ++k) {
            if (!there_[k]) continue;
            const double u = o_.q[k].x, v = o_.q[k].y, w = o_.height[k], *g = all + 3 * k;
            pure[0][0] -= u * g[0] + w * g[2], pure[1][1] -= v * g[1] + w * g[2];
            pure[0][1] -= 0.5 * (v * g[0] + u * g[1]), pure[1][0] -= 0.5 * (v * g[0] + u * g[1]);
        }
        for (int r = 0; r < 2; ++r) {
            Row mixed;
            for (int i = 0; i < segment_size; ++i)
                mixed[i] = curved[r][i] + with[r][i] +
                           0.5 * (pure[r][0] * angle_[0][i] + pure[r][1] * angle_[1][i]) -
                           by_angle[r] * size_[i];
            for (int k = 0; k < segment_corners; ++k)
                mixed[3 * k + r] += all[3 * k + 2], mixed[3 * k + 2] -= all[3 * k + r];
            for (int j = 0; j < segment_size; ++j)
                if (angle_[r][j] != 0)
                    for (int i = 0; i < segment_size; ++i) M[j][i] += angle_[r][j] * mixed[i];
        }
        add_curvature(by_angle, M);
    }

    // Of the angles themselves: products of both directions' variations.
    void add_curvature(const double* by_angle, Row* M) const {
        for (int r = 0; r < 2; ++r) {
            const int other = 1 - r;
            const double factor = (r == 0 ? 1 : -1) * tilt_.i * by_angle[r];
            Row flat[2] = {}, up[2] = {};
            for (int k = 0; k < 2; ++k) {
                flat[k][3 * tilt_.to[k] + other] += 1, flat[k][3 * tilt_.from[k] + other] -= 1;
                up[k][3 * tilt_.to[k] + 2] += 1, up[k][3 * tilt_.from[k] + 2] -= 1;
            }
            for (int i = 0; i < segment_size; ++i) {
                if (flat[0][i] != 0)
                    for (int j = 0; j < segment_size; ++j) M[i][j] += factor * flat[0][i] * up[1][j];
                if (flat[1][i] != 0)
                    for (int j = 0; j < segment_size; ++j) M[i][j] -= factor * flat[1][i] * up[0][j];
            }
        }
    }

    const Outline<double>& o_;
    Tilt<double> tilt_;
    bool there_[segment_corners];
    double across_[2][facet_corners] = {};  // components of the covectors along e1 and e2
    Row turn_[2] = {};                      // of the coordinates by the angles
    Row angle_[2] = {}, size_ = {};         // of the angles and of log |m| by the coordinates
};

}  // namespace visviva::VISVIVA_ISA
