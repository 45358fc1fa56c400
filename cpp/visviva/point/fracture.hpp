// Solids that crack, as phase fields: the energy of strain, damage and its gradient.
#pragma once
#include "visviva/material/response.hpp"
#include "visviva/point/maps.hpp"

namespace visviva::VISVIVA_ISA {

/// Places of the parameters: material, split, its constants lambda or bulk modulus, and mu; toughness over
/// (c_w length) of the local part, 1 where it is linear in d (AT1), half the factor of the gradient's square,
/// residual stiffness; those of the material.
namespace fracture {
constexpr int kind = 0, split = 1, first = 2, shear = 3, local = 4, linear = 5, gradient = 6, rest = 7,
              material = 8, n_par = 8 + material_max_parameters;
}

/// Part of the energy that drives cracks: all of it; all but that of a volume which shrinks (Amor, Marigo &
/// Maurini 2009), measured by tr E or by J; or that of principal strains that stretch (Miehe, Welschinger &
/// Hofacker 2010), Green's or logarithmic ones.
enum class CrackSplit : int {
    none = 0,
    trace = 1,
    volume = 2,
    green = 3,
    logarithmic = 4,
};

/// One of Jacobi's rotations of a symmetric matrix a, gathered in n.
VISVIVA_INLINE void rotate_pair(V a[3][3], V n[3][3], int p, int q) {
    const VI zero = vabs(a[p][q]) < 1e-300;
    const V theta = 0.5 * (a[q][q] - a[p][p]) / select(zero, broadcast(1.0), a[p][q]);
    const V size = 1.0 / (vabs(theta) + vsqrt(1.0 + theta * theta));
    const V t = select(zero, V{}, select(theta < 0.0, -size, size));
    const V cosine = 1.0 / vsqrt(1.0 + t * t), sine = t * cosine;
    for (int k = 0; k < 3; ++k) {
        const V x = a[k][p], y = a[k][q], u = n[k][p], w = n[k][q];
        a[k][p] = cosine * x - sine * y, a[k][q] = sine * x + cosine * y;
        n[k][p] = cosine * u - sine * w, n[k][q] = sine * u + cosine * w;
    }
    for (int k = 0; k < 3; ++k) {
        const V x = a[p][k], y = a[q][k];
        a[p][k] = cosine * x - sine * y, a[q][k] = sine * x + cosine * y;
    }
    a[p][q] = a[q][p] = V{};
}

/// (C, d, grad d) in a plane, where nothing strains across.
struct PlaneScalarMap : Layout<PlaneScalarMap> {
    static constexpr int n_groups = 2, n_components = 3, n_local = 7, n_strains = 10;
    static constexpr Group groups[] = {{2, 2, 2}, {1, 3, 0}};
    static constexpr double origin(int j) { return j < 4 ? PlaneMap::origin(j) : 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        PlaneMap::strains(y, e);
        for (int k = 0; k < 3; ++k) e[6 + k] = y[4 + k];
        e[9] = 0.0 * y[0];
    }
};

/// The same of a revolution, see RevolutionMap.
struct RevolutionScalarMap : Layout<RevolutionScalarMap> {
    static constexpr int n_groups = 2, n_components = 3, n_local = 9, n_strains = 10;
    static constexpr Group groups[] = {{2, 3, 2}, {1, 3, 0}};
    static constexpr double origin(int j) { return j < 6 ? RevolutionMap::origin(j) : 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        RevolutionMap::strains(y, e);
        for (int k = 0; k < 3; ++k) e[6 + k] = y[6 + k];
        e[9] = 0.0 * y[0];
    }
};

/// Principal values and directions as principal() gives them; done as soon as nothing is left off the
/// diagonal in any lane, after one rotation where nothing strains across a plane.
VISVIVA_INLINE void principal_of_strain(const V* c, V* value, V n[3][3]) {
    V a[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) a[i][j] = c[voigt[i][j]], n[i][j] = broadcast(i == j ? 1.0 : 0.0);
    constexpr int pairs[3][2] = {{0, 1}, {1, 2}, {0, 2}};
    for (int sweep = 0; sweep < 7; ++sweep) {
        const V size = vabs(a[0][0]) + vabs(a[1][1]) + vabs(a[2][2]);
        const VI left = vabs(a[0][1]) + vabs(a[1][2]) + vabs(a[0][2]) > 1e-18 * size;
        if (!any(left)) break;
        for (const auto& pq : pairs) rotate_pair(a, n, pq[0], pq[1]);
    }
    for (int k = 0; k < 3; ++k) value[k] = a[k][k];
}

/// The strains of a map with a free strain behind them, which something else prescribes.
template <class Base>
struct StretchedMap : Layout<StretchedMap<Base>> {
    static constexpr int n_groups = 3, n_components = Base::n_components + 1, n_local = Base::n_local + 1,
                         n_strains = Base::n_strains + 1;
    static constexpr Group groups[] = {Base::groups[0], Base::groups[1], {1, 1, 0}};
    static constexpr double origin(int j) { return j < Base::n_local ? Base::origin(j) : 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        Base::strains(y, e);
        e[Base::n_strains] = y[Base::n_local];
    }
};

/// W+ of a whole W: what cracks take away.
template <bool second>
struct CrackDriving {
    const V* p;
    const V* c;

    /// K / 2 <tr E>_-^2 of what shrinks.
    VISVIVA_INLINE void trace(Response& minus) const {
        const V half = 0.5 * (c[0] + c[1] + c[2]), shrinks = -positive(-half);
        const V bulk = select(half < 0.0, p[fracture::first], V{});
        minus.W = 0.5 * p[fracture::first] * shrinks * shrinks;
        for (int k = 0; k < 6; ++k) minus.s[k] = k < 3 ? 0.5 * p[fracture::first] * shrinks : V{};
        clear(minus.d, second ? 21 : 0);
        for (int a = 0; second && a < 3; ++a)
            for (int b = a; b < 3; ++b) minus.d[packed(6, a, b)] = 0.25 * bulk;
    }

    /// K U(J) where J < 1; the material says which U.
    VISVIVA_INLINE void volume(Response& minus) const {
        const V bulk = p[fracture::first], measure = p[fracture::shear];
        from_invariants<3, second>(
            c, c, [&](const auto* i) { return select(i[2].v < 0.0, bulk, V{}) * volumetric(i[2], measure); },
            minus);
    }

    /// lambda / 2 <tr e>_-^2 + mu sum <e_a>_-^2 of principal strains. Where two values coincide, the slope
    /// between them is that of their own second derivatives.
    VISVIVA_INLINE void spectral(bool logarithmic, Response& minus) const {
        using J = Jet<3, second>;
        V e[3], n[3][3];
        principal_of_strain(c, e, n);
        J strain[3];
        for (int a = 0; a < 3; ++a) {
            const J i = J::variable(e[a], a);
            strain[a] = logarithmic ? 0.5 * log1p(i) : 0.5 * i;
        }
        const J shrinks = positive(-1.0 * (strain[0] + strain[1] + strain[2]));
        J w = (0.5 * p[fracture::first]) * (shrinks * shrinks);
        for (int a = 0; a < 3; ++a) {
            const J part = positive(-1.0 * strain[a]);
            w = w + p[fracture::shear] * (part * part);
        }
        auto coincide = [&](int a, int b, const V& h) -> Coinciding {
            return {vabs(e[a] - e[b]) <= 1e-9 * (vabs(e[a]) + vabs(e[b])) + 1e-14,
                    0.5 * (w.h[packed(3, a, a)] + w.h[packed(3, b, b)]) - h};
        };
        along_directions<second>(w, e, n, coincide, minus);
    }

    /// W-, which cracks leave.
    VISVIVA_INLINE void left(CrackSplit split, Response& minus) const {
        switch (split) {
            case CrackSplit::trace:
                return trace(minus);
            case CrackSplit::volume:
                return volume(minus);
            case CrackSplit::green:
                return spectral(false, minus);
            case CrackSplit::logarithmic:
                return spectral(true, minus);
            case CrackSplit::none:
                break;
        }
        minus.W = V{};
        clear(minus.s, 6), clear(minus.d, second ? 21 : 0);
    }
};

/// g(d) W+(C) + W-(C) + w(d) + |grad d|^2 / 2 times its factor, g = (1 - rest) (1 - d)^2 + rest,
/// w = local ((1 - linear) d^2 + linear d). Not inlined by parts: many materials are behind respond().
/// With a free strain s behind grad d both parts are (1 + s)^3 W(C / (1 + s)^2).
template <bool stretches>
struct FractureEnergy : PlainEnergy {
    static constexpr int n = stretches ? 11 : 10, max_par = fracture::n_par, n_blocks = stretches ? 3 : 2;
    static constexpr double natural = 1, smooth = 1e-13;
    static constexpr int block(int k) { return k < 6 ? 0 : k < 10 ? 1 : 2; }
    static constexpr double weight(int k) { return k < 6 ? tensor_weight(k) : 1.0; }
    /// The parts of W at a strain, which discrete gradients ask for again and again at three of them.
    struct Parts {
        V c[6];
        Response whole, minus;
        bool has_second = false;
    };
    const V* p;
    mutable Parts parts[3];
    mutable int n_parts = 0;
    explicit FractureEnergy(const V* par) : p(par) {}

    template <bool second>
    void fill(const V* c, Parts& at) const {
        for (int k = 0; k < 6; ++k) at.c[k] = c[k];
        at.has_second = second;
        respond<second>(static_cast<MaterialKind>(static_cast<int>(p[fracture::kind][0])), c,
                        p + fracture::material, at.whole);
        CrackDriving<second>{p, c}.left(static_cast<CrackSplit>(static_cast<int>(p[fracture::split][0])),
                                        at.minus);
    }
    template <bool second>
    const Parts& parts_at(const V* c) const {
        for (int i = 0; i < n_parts && i < 3; ++i) {
            VI other = parts[i].c[0] != c[0];
            for (int k = 1; k < 6; ++k) other |= parts[i].c[k] != c[k];
            if (any(other)) continue;
            if (second && !parts[i].has_second) fill<true>(c, parts[i]);
            return parts[i];
        }
        Parts& at = parts[n_parts % 3];
        ++n_parts;
        fill<second>(c, at);
        return at;
    }

    /// What of C drives both parts, and 1 + s.
    static VISVIVA_INLINE V inner(const V* e, V* c) {
        V stretch = broadcast(1.0);
        if constexpr (stretches) stretch = 1.0 + e[10];
        const V shrink = 1.0 / (stretch * stretch);
        for (int k = 0; k < 6; ++k) c[k] = stretches ? shrink * e[k] + (k < 3 ? shrink - 1.0 : V{}) : e[k];
        return stretch;
    }
    /// W+ per reference volume.
    V driving(const V* e) const {
        V c[6];
        const V stretch = inner(e, c);
        const Parts& at = parts_at<false>(c);
        return stretch * stretch * stretch * (at.whole.W - at.minus.W);
    }

    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        V c[6];
        const V stretch = inner(e, c);
        const Parts& at = parts_at<second>(c);
        const Response &whole = at.whole, &minus = at.minus;
        const V sound = 1.0 - e[6], share = 1.0 - p[fracture::rest], volume = stretch * stretch * stretch;
        const V g = share * sound * sound + p[fracture::rest], g1 = -2.0 * share * sound, g2 = 2.0 * share;
        const V local = p[fracture::local], linear = p[fracture::linear], along = p[fracture::gradient];
        const V square = e[7] * e[7] + e[8] * e[8] + e[9] * e[9], plus = volume * (whole.W - minus.W);
        const V strain = g * plus + volume * minus.W;
        to.W = strain + local * e[6] * (linear + (1.0 - linear) * e[6]) + along * square;
        V pull{};  // stress times C / (1 + s)^2
        for (int k = 0; k < 6; ++k) {
            to.s[k] = stretch * (g * (whole.s[k] - minus.s[k]) + minus.s[k]);
            pull += weight(k) * to.s[k] * (c[k] + (k < 3 ? 1.0 : 0.0));
        }
        to.s[6] = g1 * plus + local * (linear + 2.0 * (1.0 - linear) * e[6]);
        for (int k = 7; k < 10; ++k) to.s[k] = 2.0 * along * e[k];
        if constexpr (stretches) to.s[10] = (3.0 * strain) / stretch - (2.0 * stretch) * pull;
        if constexpr (second) {
            clear(to.d, n * (n + 1) / 2);
            const V less = 1.0 / stretch;
            for (int k = 0; k < 6; ++k) {
                for (int l = k; l < 6; ++l)
                    to.d[packed(n, k, l)] =
                        less * (g * (whole.second(k, l) - minus.second(k, l)) + minus.second(k, l));
                to.d[packed(n, k, 6)] = g1 * stretch * (whole.s[k] - minus.s[k]);
            }
            to.d[packed(n, 6, 6)] = g2 * plus + 2.0 * (1.0 - linear) * local;
            if constexpr (stretches) add_second(at, stretch, c, g1, plus, strain, pull, to);
            for (int k = 7; k < 10; ++k) to.d[packed(n, k, k)] = 2.0 * along;
        }
    }

  private:
    /// Second derivatives by the free strain.
    void add_second(const Parts& at, V stretch, const V* c, V g1, V plus, V strain, V pull,
                    Potential<n>& to) const {
        const V less = 1.0 / stretch;
        V full[6], pull_plus{}, bend{};
        for (int k = 0; k < 6; ++k) {
            full[k] = weight(k) * (c[k] + (k < 3 ? 1.0 : 0.0));
            pull_plus += full[k] * (at.whole.s[k] - at.minus.s[k]);
        }
        for (int k = 0; k < 6; ++k) {
            V sum{};
            for (int l = 0; l < 6; ++l) sum += stretch * to.second(k, l) * full[l];
            to.d[packed(n, k, 10)] = less * to.s[k] - 2.0 * sum;
            bend += full[k] * sum;
        }
        to.d[packed(n, 6, 10)] = g1 * (3.0 * less * plus - 2.0 * stretch * stretch * pull_plus);
        to.d[packed(n, 10, 10)] = 6.0 * less * less * strain - 6.0 * pull + 4.0 * stretch * bend;
    }
};

/// The same, with damages that the largest W+ so far drives, H (Miehe, Hofacker & Welschinger 2010): a
/// variable of the point. Forces on damages are then no gradient of the energy; they act where forces are
/// balanced, at the end of steps with discrete gradients. H starts where damage that is linear in d begins to
/// grow.
template <bool stretches>
struct HistoryEnergy : PlainEnergy {
    using Plain = FractureEnergy<stretches>;
    static constexpr int n_s = Plain::n, n = n_s + 1, n_internal = 1, max_par = Plain::max_par;
    Plain energy;
    explicit HistoryEnergy(const V* par) : energy(par) {}

    /// What is stored.
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        static_assert(!second);
        Potential<n_s> whole;
        energy.template evaluate<false>(e, whole);
        to.W = whole.W;
    }

    /// Stresses s and moduli T like those of conjugate_stress(), and H at the end, behind the strains e1.
    template <bool tangent>
    void remember(const Step& step, const V* e0, V* e1, const V* et, V* s, V* T) const {
        V moduli[n_s * n_s];
        conjugate_stress<tangent>(energy, step, e0, e1, et, s, moduli);
        const V* e = step.stress == Stress::discrete_gradient ? e1 : et;
        Potential<n_s> at;
        energy.template evaluate<tangent>(e, at);
        const V *p = energy.p, share = 1.0 - p[fracture::rest];
        const V before = vmax(e0[n_s], 0.5 * p[fracture::local] * p[fracture::linear] / share);
        const V plus = energy.driving(e), more = vmax(before - plus, V{});
        e1[n_s] = plus + more;
        for (int k = 6; k < 10; ++k) s[k] = at.s[k];
        s[6] -= 2.0 * share * (1.0 - e[6]) * more;
        for (int k = 0; tangent && k < n_s; ++k)
            for (int l = 0; l < n_s; ++l)
                T[n * k + l] = k < 6 || k > 9 ? moduli[n_s * k + l] : Plain::weight(l) * at.second(k, l);
        for (int l = 0; tangent && l < 6; ++l) T[n * 6 + l] = select(more > 0.0, V{}, T[n * 6 + l]);
        if constexpr (tangent) T[n * 6 + 6] += 2.0 * share * more;
    }
};

}  // namespace visviva::VISVIVA_ISA
