// The kernels of mortar segments, compiled once per instruction set.
#include <algorithm>

#include "visviva/contact/segment_hessian.hpp"

namespace visviva::VISVIVA_ISA {

namespace {

constexpr int N = segment_size;

template <class T>
struct Corners {
    Vec<T> x[segment_corners];
};

void clear(Segment& s) {
    for (int a = 0; a < facet_corners; ++a) {
        s.area[a] = 0;
        for (double& v : s.V[a]) v = 0;
    }
}

// From integrals with the first facet's shapes to those with its dual functions, if these are wanted.
template <class T>
void mix(const FacetPair& p, T* by_corner, int apart = 1) {
    if (!p.dual) return;
    T shapes[facet_corners];
    for (int b = 0; b < p.n_first; ++b) shapes[b] = by_corner[b * apart];
    for (int a = 0; a < p.n_first; ++a) {
        T sum = {};
        for (int b = 0; b < p.n_first; ++b) add_to(sum, p.dual[a][b] * shapes[b]);
        by_corner[a * apart] = sum;
    }
}

void mix_values(const FacetPair& p, Segment& s) {
    mix(p, s.area);
    for (int i = 0; i < 3; ++i) mix(p, s.V[0] + i, 3);
}

void mix_jacobians(const FacetPair& p, Segment& s) {
    for (int k = 0; k < 3 * N; ++k) mix(p, s.J[0][0] + k, 3 * N);
}

template <class T>
void mix_gradients(const FacetPair& p, LocalGradient<T>& local) {
    mix(p, local.integral);
    for (auto& row : local.planar) mix(p, row);
    for (auto& row : local.height) mix(p, row);
}

// Covectors of the shapes' integrals that do what those of the dual ones' do.
struct ByShapes {
    double u[facet_corners][3] = {};
    ByShapes(const FacetPair& p, const double (*given)[3]) {
        for (int b = 0; b < p.n_first; ++b)
            for (int i = 0; i < 3; ++i) {
                if (!p.dual) u[b][i] = given[b][i];
                for (int a = 0; p.dual && a < p.n_first; ++a) u[b][i] += p.dual[a][b] * given[a][i];
            }
    }
};

struct Values {
    const FacetPair& pair;
    Segment& s;
    void operator()(double w, const double* N1, const double*, const Vec<double>& gap) const {
        for (int a = 0; a < pair.n_first; ++a) {
            const double c = w * N1[a];
            s.area[a] += c, s.V[a][0] += c * gap.x, s.V[a][1] += c * gap.y, s.V[a][2] += c * gap.z;
        }
    }
};

Corners<double> plain(const FacetPair& p) {
    Corners<double> c;
    for (int k = 0; k < segment_corners; ++k) c.x[k] = {p.x[k][0], p.x[k][1], p.x[k][2]};
    return c;
}

void value(const FacetPair& p, Segment& s) {
    clear(s);
    s.any = integrate(plain(p).x, p, Values{p, s});
    mix_values(p, s);
}

struct Weights {
    const FacetPair& pair;
    SegmentWeights& s;
    void operator()(double w, const double* N1, const double* N2, const Vec<double>&) const {
        for (int a = 0; a < pair.n_first; ++a) {
            s.area[a] += w * N1[a];
            for (int b = 0; b < pair.n_first; ++b) s.first[a][b] += w * N1[a] * N1[b];
            for (int b = 0; b < pair.n_second; ++b) s.second[a][b] += w * N1[a] * N2[b];
        }
    }
};

void weights(const FacetPair& p, SegmentWeights& s) {
    s = {};
    s.any = integrate(plain(p).x, p, Weights{p, s});
}

using D = Dual<N>;

// Numbers that carry derivatives by all coordinates of the corners.
Corners<D> varied(const FacetPair& p) {
    Corners<D> c;
    for (int k = 0; k < segment_corners; ++k) {
        D* const x[3] = {&c.x[k].x, &c.x[k].y, &c.x[k].z};
        for (int i = 0; i < 3; ++i) x[i]->v = p.x[k][i], x[i]->d[3 * k + i] = 1;
    }
    return c;
}

struct VariedWeights {
    D area[facet_corners], first[facet_corners][facet_corners], second[facet_corners][facet_corners];
    void add(const FacetPair& p, const D& w, const D* N1, const D* N2) {
        for (int a = 0; a < p.n_first; ++a) {
            const D c = w * N1[a];
            area[a].v += c.v;
            for (int b = 0; b < p.n_first; ++b) add_to(first[a][b], c * N1[b]);
            for (int b = 0; b < p.n_second; ++b) add_to(second[a][b], c * N2[b]);
        }
    }
};

void weight_gradients(const FacetPair& p, SegmentWeights& s, SegmentWeightGradients& g) {
    VariedWeights sums;
    s.any = integrate(varied(p).x, p,
                      [&](const D& w, const D* N1, const D* N2, const Vec<D>&) { sums.add(p, w, N1, N2); });
    for (int a = 0; a < facet_corners; ++a) {
        s.area[a] = sums.area[a].v;
        for (int b = 0; b < facet_corners; ++b) {
            s.first[a][b] = sums.first[a][b].v, s.second[a][b] = sums.second[a][b].v;
            std::copy_n(sums.first[a][b].d, N, g.first[a][b]);
            std::copy_n(sums.second[a][b].d, N, g.second[a][b]);
        }
    }
}

struct Moments {
    Vec<D> V[facet_corners];
    void add(int n, const D& w, const D* N1, const Vec<D>& gap) {
        for (int a = 0; a < n; ++a) {
            const D c = w * N1[a];
            V[a] = V[a] + c * gap;
        }
    }
    void write(const FacetPair& p, Segment& s) const {
        for (int a = 0; a < p.n_first; ++a) {
            const D* const v[3] = {&V[a].x, &V[a].y, &V[a].z};
            for (int i = 0; i < 3; ++i) {
                s.V[a][i] = v[i]->v;
                for (int k = 0; k < N; ++k) s.J[a][i][k] = v[i]->d[k];
            }
        }
    }
};

// --- edges in the plane: all of it on a tape whose first entries are the coordinates -----------------------
template <class T, int K, class Seed>
Corners<Taped<T, K>> on_tape(Seed seed) {
    using R = Taped<T, K>;
    R::tape().clear();
    Corners<R> c;
    for (int k = 0; k < segment_corners; ++k) {
        R* const x[3] = {&c.x[k].x, &c.x[k].y, &c.x[k].z};
        for (int i = 0; i < 3; ++i) *x[i] = R::make(R::Op::leaf, seed(k, i));
    }
    return c;
}

/// Covectors over an edge: coefficients of 1 and of the coordinate.
struct Covectors {
    double c[2][3];
};

Covectors covectors(const double (*u)[3]) {
    Covectors c{};
    for (int i = 0; i < 3; ++i) c.c[0][i] = u[0][i], c.c[1][i] = u[1][i] - u[0][i];
    return c;
}

// One set for each end of the first edge, with its own covector alone.
void one_by_one(const FacetPair& p, const double (*n)[3], Covectors* each) {
    for (int a = 0; a < 2; ++a) {
        double one[2][3] = {};
        for (int i = 0; i < 3; ++i) one[a][i] = n[a][i];
        each[a] = covectors(ByShapes(p, one).u);
    }
}

template <class T, int K, class Seed, class Also>
bool differentiate(const FacetPair& p, const Seed& coordinate, const Covectors* u, Also also) {
    using R = Taped<T, K>;
    const Corners<R> c = on_tape<T, K>(coordinate);
    const bool any =
        integrate_2d(c.x, c.x + facet_corners, p.range, p.axisymmetric,
                     [&](R w, const R* N1, const R*, const Vec<R>& gap) {
                         also(w.v(), Local<T>{N1[1].v(), {}, {}}, Vec<T>{gap.x.v(), gap.y.v(), gap.z.v()});
                         const R parts[2][3] = {{w * gap.x, w * gap.y, w * gap.z},
                                                {w * N1[1] * gap.x, w * N1[1] * gap.y, w * N1[1] * gap.z}};
                         for (int s = 0; s < K; ++s)
                             for (int i = 0; i < 3; ++i)
                                 for (int k = 0; k < 2; ++k)
                                     add_value(R::tape().adjoint(parts[k][i].id, s), u[s].c[k][i]);
                     });
    R::tape().walk_back(N);
    return any;
}

void gradient_2d(const FacetPair& p, const double (*n)[3], Segment& s) {
    Covectors each[2];
    one_by_one(p, n, each);
    const Values sums{p, s};
    s.any = differentiate<double, 2>(
        p, [&](int k, int i) { return p.x[k][i]; }, each,
        [&](double w, const Local<double>& l, const Vec<double>& gap) {
            double shape[facet_corners];
            corner_shapes(2, l, shape);
            sums(w, shape, nullptr, gap);
        });
    mix_values(p, s);
    for (int a = 0; s.any && a < 2; ++a)
        for (int i = 0; i < N; ++i) s.g[a][i] = Taped<double, 2>::tape().adjoint(i, a);
}

void second_2d(const FacetPair& p, const double (*u)[3], const double (*n)[3], const double* direction,
               Segment& s) {
    Moments moments;
    const Covectors all = covectors(ByShapes(p, u).u);
    auto coordinate = [&](int k, int i) {
        D x;
        x.v = p.x[k][i], x.d[3 * k + i] = 1;
        return x;
    };
    s.any = differentiate<D, 1>(p, coordinate, &all, [&](const D& w, const Local<D>& l, const Vec<D>& gap) {
        D shape[facet_corners];
        corner_shapes(2, l, shape);
        moments.add(2, w, shape, gap);
    });
    moments.write(p, s);
    mix_values(p, s), mix_jacobians(p, s);
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) s.H[i][j] = s.any ? Taped<D, 1>::tape().adjoint(i, 0).d[j] : 0;
    if (!direction) return;
    using L = Dual<1>;
    Covectors each[2];
    one_by_one(p, n, each);
    auto moved = [&](int k, int i) {
        L x;
        x.v = p.x[k][i], x.d[0] = direction[3 * k + i];
        return x;
    };
    differentiate<L, 2>(p, moved, each, [](const L&, const Local<L>&, const Vec<L>&) {});
    for (int a = 0; a < 2; ++a)
        for (int i = 0; i < N; ++i) s.HD[a][i] = s.any ? Taped<L, 2>::tape().adjoint(i, a).d[0] : 0;
}

// --- facets in space ---------------------------------------------------------------------------------------
template <class T>
std::optional<Outline<T>> outline(const FacetPair& p, const Vec<T>* x) {
    return outline(x, p.n_first, x + facet_corners, p.n_second, p.range);
}

// Weight of a segment, by the corners' coordinates; 1 alone if it has not begun to fade.
struct Fading {
    double value = 1, g[N] = {}, H[N][N] = {};

    Fading(const FacetPair& p, double weight) : value(weight) {
        if (weight == 1) return;
        using R = Taped<D, 1>;
        const Corners<R> c = on_tape<D, 1>([&](int k, int i) {
            D x;
            x.v = p.x[k][i], x.d[3 * k + i] = 1;
            return x;
        });
        const Vec<R>*first = c.x, *second = c.x + facet_corners;
        const auto w =
            VISVIVA_ISA::weight(normal_of(first, p.n_first), normal_of(second, p.n_second),
                                centre_of(second, p.n_second) - centre_of(first, p.n_first), p.range.reach);
        std::copy_n(w->v().d, N, g);
        add_value(R::tape().adjoint(w->id, 0), 1);
        R::tape().walk_back(N);
        for (int i = 0; i < N; ++i) std::copy_n(R::tape().adjoint(i, 0).d, N, H[i]);
    }
    bool any() const { return value != 1; }
};

// V_a from I_a; the areas are those of `value` and not made here.
void write_moments(const FacetPair& p, const Outline<double>& o, const double* I, double weight, Segment& s) {
    for (int a = 0; a < p.n_first; ++a) {
        const double c = weight * I[a];
        s.V[a][0] = c * o.normal.x, s.V[a][1] = c * o.normal.y, s.V[a][2] = c * o.normal.z;
    }
}

double dotted(const double* a, const double* b) {
    double sum = 0;
    for (int i = 0; i < N; ++i) sum += a[i] * b[i];
    return sum;
}
double dotted(const double* n, const Vec<double>& v) { return n[0] * v.x + n[1] * v.y + n[2] * v.z; }

void gradient_3d(const FacetPair& p, const double (*n)[3], Segment& s) {
    const Corners<double> c = plain(p);
    const auto o = outline(p, c.x);
    if (!(s.any = o.has_value())) return;
    LocalGradient<double> local(*o);
    local.finish(*o);
    mix_gradients(p, local);
    for (int a = 0; a < p.n_first; ++a) std::fill_n(s.g[a], N, 0.0);
    to_space(*o, local, c.x, n, s.g);
    write_moments(p, *o, local.integral, o->weight, s);
    if (o->weight == 1) return;
    const Fading fading(p, o->weight);
    for (int a = 0; a < p.n_first; ++a) {
        const double whole = local.integral[a] * dotted(n[a], o->normal);
        for (int i = 0; i < N; ++i) s.g[a][i] = fading.value * s.g[a][i] + whole * fading.g[i];
    }
}

// Derivatives along a direction of the gradients of n_a . V_a before they fade.
void along_3d(const FacetPair& p, const double (*n)[3], const double* direction, Segment& s) {
    using L = Dual<1>;
    Corners<L> c;
    for (int k = 0; k < segment_corners; ++k) {
        L* const x[3] = {&c.x[k].x, &c.x[k].y, &c.x[k].z};
        for (int i = 0; i < 3; ++i) x[i]->v = p.x[k][i], x[i]->d[0] = direction[3 * k + i];
    }
    const auto o = outline(p, c.x);
    if (!o) return;
    LocalGradient<L> local(*o);
    local.finish(*o);
    mix_gradients(p, local);
    L g[facet_corners][N];
    to_space(*o, local, c.x, n, g);
    for (int a = 0; a < p.n_first; ++a)
        for (int i = 0; i < N; ++i) s.HD[a][i] = g[a][i].d[0];
}

// Of products with how much the segment counts. J and H still without that, `I` by the corners.
void fade(const FacetPair& p, const Outline<double>& o, const double (*u)[3], const double (*n)[3],
          const double* direction, const double* integral, Segment& s) {
    const Fading fading(p, o.weight);
    if (!fading.any()) return;
    double whole = 0, g[N] = {};
    for (int a = 0; a < p.n_first; ++a) {
        whole += integral[a] * dotted(u[a], o.normal);
        for (int i = 0; i < N; ++i)
            for (int j = 0; j < 3; ++j) g[i] += u[a][j] * s.J[a][j][i];
    }
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j)
            s.H[i][j] =
                fading.value * s.H[i][j] + g[i] * fading.g[j] + fading.g[i] * g[j] + whole * fading.H[i][j];
    const double e[3] = {o.normal.x, o.normal.y, o.normal.z};
    for (int a = 0; a < p.n_first; ++a) {
        const double own = integral[a] * dotted(n[a], o.normal);
        double by[N] = {};
        for (int j = 0; j < 3; ++j)
            for (int i = 0; i < N; ++i) {
                by[i] += n[a][j] * s.J[a][j][i];
                s.J[a][j][i] = fading.value * s.J[a][j][i] + integral[a] * e[j] * fading.g[i];
            }
        if (!direction) continue;
        const double faster = dotted(fading.g, direction), more = dotted(by, direction);
        for (int i = 0; i < N; ++i)
            s.HD[a][i] = fading.value * s.HD[a][i] + faster * by[i] + more * fading.g[i] +
                         own * dotted(fading.H[i], direction);
    }
}

void second_3d(const FacetPair& p, const double (*u)[3], const double (*n)[3], const double* direction,
               Segment& s) {
    const Corners<double> c = plain(p);
    const auto o = outline(p, c.x);
    if (!(s.any = o.has_value())) return;
    const Spatial spatial(*o, c.x, ByShapes(p, u).u);
    LocalGradient<double> local(*o);
    const LocalHessian hessian(*o, local, spatial.c);
    local.finish(*o);
    spatial.second(local, hessian.products(), s.H);
    mix_gradients(p, local);
    spatial.first(local, s.J);
    write_moments(p, *o, local.integral, o->weight, s);
    if (direction) along_3d(p, n, direction, s);
    fade(p, *o, u, n, direction, local.integral, s);
}

void gradient(const FacetPair& p, const double (*n)[3], Segment& s) {
    clear(s);
    p.n_first == 2 ? gradient_2d(p, n, s) : gradient_3d(p, n, s);
}

void second(const FacetPair& p, const double (*u)[3], const double (*n)[3], const double* direction,
            Segment& s) {
    clear(s);
    p.n_first == 2 ? second_2d(p, u, n, direction, s) : second_3d(p, u, n, direction, s);
}

}  // namespace

extern const SegmentKernels segment_table;
const SegmentKernels segment_table = {value, weights, weight_gradients, gradient, second};

}  // namespace visviva::VISVIVA_ISA
