// The kernels of mortar segments, compiled once per instruction set.
#include <algorithm>

#include "segment_adjoint.hpp"

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

// The outline on a tape whose first entries are the coordinates.
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

template <class T, int K>
T stripped(const Taped<T, K>& a) {
    return a.v();
}
double stripped(const D& a) { return a.v; }

// Coefficients without their derivatives.
template <class T, class R>
Bilinear<T> values(const Bilinear<R>& b) {
    Bilinear<T> r;
    r.quad = b.quad;
    r.c0 = stripped(b.c0), r.c1 = stripped(b.c1), r.c2 = stripped(b.c2), r.c3 = stripped(b.c3);
    return r;
}
template <class T, class R>
Facet<T> values(const Facet<R>& f) {
    return {values<T>(f.x), values<T>(f.y), values<T>(f.z), values<T>(f.u), values<T>(f.v), f.n};
}
template <class T, class R>
Outline<T> values(const Outline<R>& o) {
    Outline<T> r{{}, values<T>(o.f1), values<T>(o.f2), stripped(o.weight)};
    r.polygon.n = o.polygon.n;
    for (int k = 0; k <= o.polygon.n; ++k)
        r.polygon.p[k] = {stripped(o.polygon.p[k].x), stripped(o.polygon.p[k].y)};
    return r;
}

template <class T, int K>
void seed(const Facet<Taped<T, K>>& f, const T (*bar)[4], int set) {
    auto& tape = Taped<T, K>::tape();
    const Bilinear<Taped<T, K>>* const parts[5] = {&f.x, &f.y, &f.z, &f.u, &f.v};
    for (int i = 0; i < 5; ++i) {
        const Taped<T, K> c[4] = {parts[i]->c0, parts[i]->c1, parts[i]->c2, parts[i]->c3};
        for (int k = 0; k < f.n; ++k) add_to(tape.adjoint(c[k].id, set), bar[i][k]);
    }
}

// Adjoints of the coordinates, left on the tape, for K sets of covectors.
template <class T, int K, class Seed, class Also>
bool differentiate_3d(const FacetPair& p, Seed coordinate, const Covectors* u, Also also) {
    using R = Taped<T, K>;
    const Corners<R> c = on_tape<T, K>(coordinate);
    const auto o = outline(c.x, p.n_first, c.x + facet_corners, p.n_second, p.reach);
    if (!o) return false;
    OutlineAdjoint<T> bar[K] = {};
    back_all<T, K>(values<T>(*o), u, bar, also);
    for (int s = 0; s < K; ++s) {
        seed(o->f1, bar[s].f1, s), seed(o->f2, bar[s].f2, s);
        add_to(R::tape().adjoint(o->weight.id, s), bar[s].weight);
        for (int k = 0; k <= o->polygon.n; ++k) {
            add_to(R::tape().adjoint(o->polygon.p[k].x.id, s), bar[s].p[k].x);
            add_to(R::tape().adjoint(o->polygon.p[k].y.id, s), bar[s].p[k].y);
        }
    }
    R::tape().walk_back(N);
    return true;
}

// The same for edges, all of it on the tape.
template <class T, int K, class Seed, class Also>
bool differentiate_2d(const FacetPair& p, const Seed& coordinate, const Covectors* u, Also also) {
    using R = Taped<T, K>;
    const Corners<R> c = on_tape<T, K>(coordinate);
    const bool any =
        integrate_2d(c.x, c.x + facet_corners, p.reach, p.axisymmetric,
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

template <class T, int K, class Seed, class Also>
bool differentiate(const FacetPair& p, Seed coordinate, const Covectors* u, Also also) {
    return p.n_first == 2 ? differentiate_2d<T, K>(p, coordinate, u, also)
                          : differentiate_3d<T, K>(p, coordinate, u, also);
}

Covectors covectors(const double (*u)[3], int n) {
    if (n > 2) return {u, n};
    Covectors c{};
    for (int i = 0; i < 3; ++i) c.c[0][i] = u[0][i], c.c[1][i] = u[1][i] - u[0][i];
    return c;
}

// One set for every corner of the first facet, with its own covector alone.
void one_by_one(const FacetPair& p, const double (*n)[3], Covectors* each) {
    for (int a = 0; a < p.n_first; ++a) {
        double one[facet_corners][3] = {};
        for (int i = 0; i < 3; ++i) one[a][i] = n[a][i];
        each[a] = covectors(one, p.n_first);
    }
}

// By forward derivatives of the outline, of which there are few coefficients.
void chain(const D& coefficient, double bar, double* g) {
    for (int i = 0; i < N; ++i) g[i] += bar * coefficient.d[i];
}
void chain(const Facet<D>& f, const double (*bar)[4], double* g) {
    const Bilinear<D>* const parts[5] = {&f.x, &f.y, &f.z, &f.u, &f.v};
    for (int i = 0; i < 5; ++i) {
        const D* const c[4] = {&parts[i]->c0, &parts[i]->c1, &parts[i]->c2, &parts[i]->c3};
        for (int k = 0; k < f.n; ++k) chain(*c[k], bar[i][k], g);
    }
}

template <class Also>
bool gradient_3d(const FacetPair& p, const Covectors* u, Also also, Segment& s) {
    const Corners<D> c = varied(p);
    const auto o = outline(c.x, p.n_first, c.x + facet_corners, p.n_second, p.reach);
    if (!o) return false;
    OutlineAdjoint<double> bar[facet_corners] = {};
    back_all<double, facet_corners>(values<double>(*o), u, bar, also);
    for (int a = 0; a < p.n_first; ++a) {
        double* g = s.g[a];
        std::fill_n(g, N, 0.0);
        chain(o->f1, bar[a].f1, g), chain(o->f2, bar[a].f2, g), chain(o->weight, bar[a].weight, g);
        for (int k = 0; k <= o->polygon.n; ++k)
            chain(o->polygon.p[k].x, bar[a].p[k].x, g), chain(o->polygon.p[k].y, bar[a].p[k].y, g);
    }
    return true;
}

template <class Also>
bool gradient_2d(const FacetPair& p, const Covectors* u, Also also, Segment& s) {
    auto coordinate = [&](int k, int i) { return p.x[k][i]; };
    const bool any = differentiate_2d<double, facet_corners>(p, coordinate, u, also);
    for (int a = 0; any && a < p.n_first; ++a)
        for (int i = 0; i < N; ++i) s.g[a][i] = Taped<double, facet_corners>::tape().adjoint(i, a);
    return any;
}

void gradient(const FacetPair& p, const double (*n)[3], Segment& s) {
    clear(s);
    Covectors each[facet_corners] = {};
    one_by_one(p, n, each);
    const Values sums{p, s};
    auto add = [&](double w, const Local<double>& l, const Vec<double>& gap) {
        double shape[facet_corners];
        corner_shapes(p.n_first, l, shape);
        sums(w, shape, nullptr, gap);
    };
    s.any = p.n_first == 2 ? gradient_2d(p, each, add, s) : gradient_3d(p, each, add, s);
}

void second(const FacetPair& p, const double (*u)[3], const double (*n)[3], const double* direction,
            Segment& s) {
    clear(s);
    Moments moments;
    const Covectors all = covectors(u, p.n_first);
    auto coordinate = [&](int k, int i) {
        D x;
        x.v = p.x[k][i], x.d[3 * k + i] = 1;
        return x;
    };
    auto add = [&](const D& w, const Local<D>& l, const Vec<D>& gap) {
        D shape[facet_corners];
        corner_shapes(p.n_first, l, shape);
        moments.add(p.n_first, w, shape, gap);
    };
    s.any = differentiate<D, 1>(p, coordinate, &all, add);
    moments.write(p, s);
    for (int i = 0; i < N; ++i)
        for (int j = 0; j < N; ++j) s.H[i][j] = s.any ? Taped<D, 1>::tape().adjoint(i, 0).d[j] : 0;
    if (!direction) return;
    using L = Dual<1>;
    Covectors each[facet_corners] = {};
    one_by_one(p, n, each);
    auto moved = [&](int k, int i) {
        L x;
        x.v = p.x[k][i], x.d[0] = direction[3 * k + i];
        return x;
    };
    differentiate<L, facet_corners>(p, moved, each, [](const L&, const Local<L>&, const Vec<L>&) {});
    for (int a = 0; a < facet_corners; ++a)
        for (int i = 0; i < N; ++i)
            s.HD[a][i] = s.any ? Taped<L, facet_corners>::tape().adjoint(i, a).d[0] : 0;
}

}  // namespace

extern const SegmentKernels segment_table;
const SegmentKernels segment_table = {value, weights, weight_gradients, gradient, second};

}  // namespace visviva::VISVIVA_ISA
