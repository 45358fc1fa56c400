// Free energies of mixtures and order parameters with their gradients, and what moves them: diffusion
// (Cahn & Hilliard), relaxation (Allen & Cahn).
#pragma once
#include "visviva/material/response.hpp"
#include "visviva/point/internal.hpp"
#include "visviva/point/pairings.hpp"

namespace visviva::VISVIVA_ISA {

/// Places of the parameters: factors of c ln c and of (1 - c) ln(1 - c), centre and coefficients of a
/// polynomial, gradient energy 11, 22, 33, 12, 23, 31; centre and coefficients of the mobility. A solid has
/// its material, the centre of its moduli and strains, the coefficients of its moduli, and its eigenstrains
/// behind them.
namespace mixture {
constexpr int first_log = 0, second_log = 1, centre = 2, polynomial = 3, degree = 7, gradient = 11,
              mobility_centre = 17, mobility = 18, n_par = 26;
constexpr int solid_centre = 26, moduli = 27, eigenstrain = 31, kind = 34, material = 35,
              n_solid = 35 + material_max_parameters;
/// Below it c ln c goes on as a parabola, so that iterations find back; no step may end there.
constexpr double least = 1e-12;
}  // namespace mixture

/// c ln c with derivatives.
struct EntropyOfMixing {
    V value, first, second;
    explicit VISVIVA_INLINE EntropyOfMixing(V c) {
        const VI inside = c > mixture::least;
        const V x = select(inside, c, broadcast(mixture::least)), off = c - x, log = vlog1p(x - 1.0);
        value = x * log + off * (log + 1.0 + 0.5 * off / x), first = log + 1.0 + off / x, second = 1.0 / x;
    }
};

/// Its difference quotient and the derivative of that by c1. Where the difference would drown in rounding it
/// is a series about the middle.
VISVIVA_INLINE void quotient_of_mixing(V c0, V c1, V& D, V& slope) {
    const V m = 0.5 * (c0 + c1), d = c1 - c0;
    const EntropyOfMixing f0(c0), f1(c1), fm(m);
    const V r = d / vmax(m, broadcast(mixture::least)), r2 = r * r;
    const VI near = r2 < 4e-4;
    const V safe = select(near, broadcast(1.0), d), plain = (f1.value - f0.value) / safe;
    D = select(near, fm.first - r2 * (1.0 / 24 + r2 * (1.0 / 320 + r2 / 2688.0)), plain);
    slope = select(near, fm.second * (0.5 - r * (1.0 / 12 - r * (1.0 / 24 - r * (1.0 / 80 - r / 160.0)))),
                   (f1.first - plain) / safe);
}

/// f(c) with derivatives.
struct ChemicalEnergy {
    V value, first, second;
    VISVIVA_INLINE ChemicalEnergy(V c, const V* p) {
        const V x = c - p[mixture::centre], *a = p + mixture::polynomial;
        value = a[mixture::degree], first = second = V{};
        for (int k = mixture::degree - 1; k >= 0; --k)
            second = second * x + 2.0 * first, first = first * x + value, value = value * x + a[k];
        for (int side = 0; side < 2; ++side) {
            const V factor = p[mixture::first_log + side];
            if (all(factor == 0.0)) continue;
            const EntropyOfMixing f(side ? 1.0 - c : c);
            value += factor * f.value, first += (side ? -1.0 : 1.0) * factor * f.first;
            second += factor * f.second;
        }
    }
};

/// Its difference quotient, exact for the polynomial, and the derivative of that by c1.
VISVIVA_INLINE void chemical_quotient(V c0, V c1, const V* p, V& D, V& slope) {
    const V u = c0 - p[mixture::centre], x = c1 - p[mixture::centre], *a = p + mixture::polynomial;
    // p(x) - p(u) = (x - u) q(x): synthetic division gives the coefficients of q from the highest on
    V b = a[mixture::degree];
    D = b, slope = V{};
    for (int k = mixture::degree - 1; k >= 1; --k) b = b * u + a[k], slope = slope * x + D, D = D * x + b;
    for (int side = 0; side < 2; ++side) {
        const V factor = p[mixture::first_log + side];
        if (all(factor == 0.0)) continue;
        V more, bend;
        quotient_of_mixing(side ? 1.0 - c0 : c0, side ? 1.0 - c1 : c1, more, bend);
        D += (side ? -1.0 : 1.0) * factor * more, slope += factor * bend;
    }
}

/// Where logarithms allow the compositions.
VISVIVA_INLINE VI is_mixture(V c, const V* p) {
    return ((p[mixture::first_log] == 0.0) | (c >= mixture::least)) &
           ((p[mixture::second_log] == 0.0) | (1.0 - c >= mixture::least));
}

/// f(c) + 1/2 grad c . K grad c of (c, grad c)
template <int parameters = mixture::n_par>
struct MixtureEnergy : PlainEnergy {
    static constexpr int n = 4, max_par = parameters, n_blocks = 2;
    static constexpr int block(int k) { return k == 0 ? 0 : 1; }
    const V* p;
    explicit MixtureEnergy(const V* par) : p(par) {}

    VI is_defined(const V* e) const { return is_mixture(e[0], p); }
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        const ChemicalEnergy f(e[0], p);
        to.W = f.value, to.s[0] = f.first;
        if (second) clear(to.d, 10), to.d[0] = f.second;
        for (int a = 0; a < 3; ++a) {
            V flux{};
            for (int b = 0; b < 3; ++b) {
                const V k = p[mixture::gradient + voigt[a][b]];
                flux += k * e[1 + b];
                if (second && b >= a) to.d[packed(n, 1 + a, 1 + b)] = k;
            }
            to.s[1 + a] = flux, to.W += 0.5 * flux * e[1 + a];
        }
    }
    /// Both parts in closed form.
    template <bool tangent>
    void discrete_gradient(const V* e0, const V* e1, V* s, V* T) const {
        V slope;
        chemical_quotient(e0[0], e1[0], p, s[0], slope);
        for (int k = 0; tangent && k < n * n; ++k) T[k] = V{};
        if (tangent) T[0] = slope;
        for (int a = 0; a < 3; ++a) {
            s[1 + a] = V{};
            for (int b = 0; b < 3; ++b) {
                const V k = 0.5 * p[mixture::gradient + voigt[a][b]];
                s[1 + a] += k * (e0[1 + b] + e1[1 + b]);
                if (tangent) T[n * (1 + a) + 1 + b] = k;
            }
        }
    }
};

/// f(c) alone, of a wall; constant beyond its ends.
struct WallEnergy : PlainEnergy {
    static constexpr int n = 1, low = mixture::gradient, high = low + 1, max_par = high + 1;
    const V* p;
    explicit WallEnergy(const V* par) : p(par) {}
    V inside(V c) const { return select(c < p[low], p[low], select(c > p[high], p[high], c)); }
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        const V c = inside(e[0]);
        const ChemicalEnergy f(c, p);
        to.W = f.value, to.s[0] = select(c == e[0], f.first, V{});
        if (second) to.d[0] = select(c == e[0], f.second, V{});
    }
    /// That between the ends times the share of the way that is there.
    template <bool tangent>
    void discrete_gradient(const V* e0, const V* e1, V* s, V* T) const {
        const V c0 = inside(e0[0]), c1 = inside(e1[0]), way = e1[0] - e0[0];
        const V counts = select(c1 == e1[0], broadcast(1.0), V{}),
                safe = select(way == 0.0, broadcast(1.0), way);
        const V share = select(way == 0.0, counts, (c1 - c0) / safe);
        V quotient, slope;
        chemical_quotient(c0, c1, p, quotient, slope);
        s[0] = quotient * share;
        if (tangent) T[0] = slope * counts * share + quotient * (counts - share) / safe;
    }
};

/// m(c) W(Ce) of (C, c), C_e = F0^-T C F0^-1 with F0 = I + (c - c0) eigenstrain along the axes; any
/// material's W, m a polynomial of third degree.
struct MisfitEnergy : PlainEnergy {
    static constexpr int n = 7, max_par = mixture::n_solid, n_blocks = 2;
    static constexpr int block(int k) { return k / 6; }
    static constexpr double weight(int k) { return k < 6 ? tensor_weight(k) : 1.0; }
    static constexpr double natural = 1;
    const V* p;
    explicit MisfitEnergy(const V* par) : p(par) {}

    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        const V x = e[6] - p[mixture::solid_centre], *a = p + mixture::moduli;
        const V m = a[0] + x * (a[1] + x * (a[2] + x * a[3])), m1 = a[1] + x * (2.0 * a[2] + 3.0 * x * a[3]),
                m2 = 2.0 * a[2] + 6.0 * x * a[3];
        V grown[3], stretch[3], rate[3];
        for (int k = 0; k < 3; ++k) {
            const V a = p[mixture::eigenstrain + k];
            grown[k] = x * a, stretch[k] = 1.0 / (1.0 + grown[k]), rate[k] = a * stretch[k];
        }
        V c[6], share[6], first[6], bend[6];  // Ce - I, and by what it changes with C, c and c again
        for (int k = 0; k < 6; ++k) {
            const V u = rate[voigt_a[k]], w = rate[voigt_b[k]];
            share[k] = stretch[voigt_a[k]] * stretch[voigt_b[k]];
            c[k] = share[k] * e[k];
            if (k < 3) c[k] -= share[k] * grown[k] * (2.0 + grown[k]);  // share - 1 without cancellation
            const V whole = c[k] + (k < 3 ? 1.0 : 0.0);
            first[k] = -whole * (u + w), bend[k] = whole * ((u + w) * (u + w) + u * u + w * w);
        }
        Response w;
        respond<second>(static_cast<MaterialKind>(p[mixture::kind][0]), c, p + mixture::material, w);
        V by_c{};
        for (int k = 0; k < 6; ++k)
            to.s[k] = m * share[k] * w.s[k], by_c += tensor_weight(k) * w.s[k] * first[k];
        to.W = m * w.W;
        to.s[6] = m1 * w.W + m * by_c;
        if constexpr (second) {
            V twice = m2 * w.W + 2.0 * m1 * by_c;
            for (int k = 0; k < 6; ++k) {
                V along{};
                for (int l = 0; l < 6; ++l) {
                    along += tensor_weight(l) * w.second(k, l) * first[l];
                    if (l >= k) to.d[packed(n, k, l)] = m * share[k] * share[l] * w.second(k, l);
                }
                const V u = rate[voigt_a[k]] + rate[voigt_b[k]];
                to.d[packed(n, k, 6)] = share[k] * (m1 * w.s[k] + m * (along - u * w.s[k]));
                twice += m * tensor_weight(k) * (along * first[k] + w.s[k] * bend[k]);
            }
            to.d[packed(n, 6, 6)] = twice;
        }
    }
};

/// f(c) + 1/2 grad c . K grad c + m(c) W(Ce) of (C, c, grad c).
struct MixtureSolidEnergy : PlainEnergy {
    static constexpr int n = 10, max_par = mixture::n_solid, n_misfit = MisfitEnergy::n;
    static constexpr double weight(int k) { return k < 6 ? tensor_weight(k) : 1.0; }
    const V* p;
    explicit MixtureSolidEnergy(const V* par) : p(par) {}

    VI is_defined(const V* e) const { return is_mixture(e[6], p); }
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        Potential<4> chemical;
        MixtureEnergy<>(p).template evaluate<second>(e + 6, chemical);
        Potential<n_misfit> misfit;
        MisfitEnergy(p).template evaluate<second>(e, misfit);
        to.W = chemical.W + misfit.W;
        for (int k = 0; k < n; ++k) to.s[k] = k < n_misfit ? misfit.s[k] : V{};
        for (int k = 0; k < 4; ++k) to.s[6 + k] += chemical.s[k];
        for (int k = 0; second && k < n; ++k)
            for (int l = k; l < n; ++l) {
                V& d = to.d[packed(n, k, l)];
                d = l < n_misfit ? misfit.second(k, l) : V{};
                if (k > 5) d += chemical.second(k - 6, l - 6);
            }
    }
    /// Of each part its own: what is stored in C and c knows nothing of grad c, which has another unit.
    template <bool tangent>
    void discrete_gradient(const V* e0, const V* e1, V* s, V* T) const {
        V chemical[4], by_chemical[16], misfit[n_misfit], by_misfit[n_misfit * n_misfit];
        MixtureEnergy<>(p).template discrete_gradient<tangent>(e0 + 6, e1 + 6, chemical, by_chemical);
        const MisfitEnergy energy(p);
        VISVIVA_ISA::discrete_gradient<tangent>(energy, e0, e1, misfit, by_misfit);
        conjugate<tangent>(energy, misfit, by_misfit);
        for (int k = 0; k < n; ++k) {
            s[k] = (k < n_misfit ? misfit[k] : V{}) + (k > 5 ? chemical[k - 6] : V{});
            for (int l = 0; tangent && l < n; ++l) {
                T[n * k + l] = k < n_misfit && l < n_misfit ? by_misfit[n_misfit * k + l] : V{};
                if (k > 5 && l > 5) T[n * k + l] += by_chemical[4 * (k - 6) + l - 6];
            }
        }
    }
};

/// M(c), never negative.
template <class T>
VISVIVA_INLINE T mobility(const T& c, const V* p) {
    const V* a = p + mixture::mobility;
    const T x = c + (-p[mixture::mobility_centre]);
    T M = a[mixture::degree] * x + a[mixture::degree - 1];
    for (int k = mixture::degree - 2; k >= 0; --k) M = M * x + a[k];
    return positive(M);
}

/// Cahn & Hilliard: the balance c' = div(M grad mu) tests the concentration, and that the potential is D_c W
/// tests the potential, whose shape functions are the same. The concentration is strain number `at`, the
/// potential the fourth one behind it; those before it have their stress.
template <int at>
struct MixturePairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        const auto M = mobility(z.e(at), z.par);
        for (int k = 0; k < at; ++k) f[k] = z.s(k);
        f[at] = z.rate(at);
        f[at + 4] = z.e(at + 4) - z.s(at);
        for (int k = at + 1; k < at + 4; ++k) f[k] = M * z.e(4 + k), f[4 + k] = -z.s(k);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State& z) {
        V square{};
        for (int k = at + 5; k < at + 8; ++k) square += z.e(k) * z.e(k);
        return z.h * mobility(z.e(at), z.par) * square;
    }
};

/// Allen & Cahn: c' = -M (D_c W - load), where the load, if there is one, is the fifth strain and keeps the
/// mean of c.
template <bool is_conserved>
struct RelaxationPairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        f[0] = z.rate(0) / mobility(z.e(0), z.par) + z.s(0);
        for (int k = 1; k < 4; ++k) f[k] = z.s(k);
        if constexpr (is_conserved) f[0] = f[0] - z.e(4), f[4] = -z.rate(0);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State& z) {
        return z.h * z.rate(0) * z.rate(0) / mobility(z.e(0), z.par);
    }
};

/// Contribution of a wall's energy to the potential there.
struct WallPairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        f[0] = 0.0 * z.s(0), f[1] = -z.s(0);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

/// Cahn & Hilliard without a potential, of (c, grad c, laplace c) with isotropic gradient energy:
/// c' + (M f'' + K M' laplace c) grad c . grad + K M laplace c laplace, tested (Gomez et al. 2008).
struct SmoothPairing {
    static constexpr bool is_gradient = false;
    template <class T>
    static VISVIVA_INLINE T curvature(const T& c, const V* p) {
        const V* a = p + mixture::polynomial;
        const T x = c + (-p[mixture::centre]);
        T bend = 0.0 * c;
        for (int k = mixture::degree; k >= 2; --k) bend = bend * x + (k * (k - 1.0)) * a[k];
        for (int side = 0; side < 2; ++side) {
            const V factor = p[mixture::first_log + side];
            if (all(factor == 0.0)) continue;
            const T share = side ? (-1.0) * c + broadcast(1.0) : c;
            bend = bend + (0.0 * c + factor) /
                              (positive(share + broadcast(-mixture::least)) + broadcast(mixture::least));
        }
        return bend;
    }
    template <class T>
    static VISVIVA_INLINE T mobility_slope(const T& c, const V* p) {
        const V* a = p + mixture::mobility;
        const T x = c + (-p[mixture::mobility_centre]);
        T slope = 0.0 * c;
        for (int k = mixture::degree; k >= 1; --k) slope = slope * x + double(k) * a[k];
        return slope * is_positive(mobility(c, p));
    }
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        const V K = z.par[mixture::gradient];
        const auto M = mobility(z.e(0), z.par);
        const auto factor = M * curvature(z.e(0), z.par) + K * (mobility_slope(z.e(0), z.par) * z.e(4));
        f[0] = z.rate(0);
        for (int k = 1; k < 4; ++k) f[k] = factor * z.e(k);
        f[4] = K * (M * z.e(4));
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

}  // namespace visviva::VISVIVA_ISA
