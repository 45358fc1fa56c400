// Solids whose material conducts heat: the internal energy of strain and entropy, and the balance of entropy.
#pragma once
#include "visviva/material/discrete_gradient.hpp"
#include "visviva/material/mixed_energy.hpp"
#include "visviva/material/wrapped.hpp"
#include "visviva/point/capacity.hpp"
#include "visviva/point/pairings.hpp"

namespace visviva::VISVIVA_ISA {

/// Places of the parameters: material, capacity c, theta0, coupling beta, relative slope of the moduli, six
/// conductivities 11, 22, 33, 12, 23, 31, whether they turn and stretch with the material, their relative
/// slope, what else is said of the capacity; those of the material.
namespace thermal {
constexpr int kind = 0, capacity = 1, zero = 2, coupling = 3, slope = 4, conductivity = 5, spatial = 11,
              conductivity_slope = 12, more = 13, material = more + Capacity::n_par,
              n_par = material + material_max_parameters;
}

/// e(C, s) of psi(C, theta) = W(C) (1 + slope (theta - theta0)) - beta (theta - theta0) ln J + what a
/// capacity c(theta) stores, any material's W: with M = beta ln J - slope W the temperature follows from
/// H(theta) = s - M, and e = W + theta0 M + U(theta); see Capacity.
struct ThermoelasticEnergy : PlainEnergy {
    static constexpr int n = 7, max_par = thermal::n_par, n_blocks = 2;
    static constexpr int block(int k) { return k / 6; }
    static constexpr double weight(int k) { return k < 6 ? tensor_weight(k) : 1.0; }
    const V* p;
    Capacity heat;
    explicit ThermoelasticEnergy(const V* par)
        : p(par), heat(p[thermal::capacity], p[thermal::zero], p + thermal::more) {}

    /// W and M of a strain.
    struct Shared {
        Response w;
        V M, M_C[6], M_CC[21];
    };
    template <bool second>
    void share(const V* e, Shared& at) const {
        Response v;
        respond<second>(static_cast<MaterialKind>(p[thermal::kind][0]), e, p + thermal::material, at.w);
        VolumeEnergy{{}, VolumeMeasure::logarithm, V{}}.evaluate<second>(e, v);
        const V beta = p[thermal::coupling], slope = p[thermal::slope];
        at.M = beta * v.W - slope * at.w.W;
        for (int k = 0; k < 6; ++k) at.M_C[k] = beta * v.s[k] - slope * at.w.s[k];
        for (int k = 0; second && k < 21; ++k) at.M_CC[k] = beta * v.d[k] - slope * at.w.d[k];
    }
    V increase(const Shared& from, const V* e0, const Shared& to, const V* e1) const {
        const V dM = to.M - from.M;
        return (to.w.W - from.w.W) + p[thermal::zero] * dM +
               heat.increase(e0[6] - from.M, (e1[6] - e0[6]) - dM);
    }
    V increase(const V* e0, const V* e1) const {
        Shared from, to;
        share<false>(e0, from), share<false>(e1, to);
        return increase(from, e0, to, e1);
    }

    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        Shared at;
        share<second>(e, at), evaluate<second>(at, e, to);
    }
    template <bool second>
    void evaluate(const Shared& at, const V* e, Potential<n>& to) const {
        const V zero = p[thermal::zero], rise = heat.rise_of(e[6] - at.M), theta = zero + rise;
        to.W = at.w.W + zero * at.M + heat.content(rise);
        for (int k = 0; k < 6; ++k) to.s[k] = at.w.s[k] - rise * at.M_C[k];
        to.s[6] = theta;
        if constexpr (second) {
            const V by_s = theta / heat.at(rise);
            for (int k = 0; k < 6; ++k) {
                for (int l = k; l < 6; ++l) {
                    const int i = packed(6, k, l);
                    to.d[packed(n, k, l)] = at.w.d[i] - rise * at.M_CC[i] + by_s * at.M_C[k] * at.M_C[l];
                }
                to.d[packed(n, k, 6)] = -by_s * at.M_C[k];
            }
            to.d[packed(n, 6, 6)] = by_s;
        }
    }
    template <bool tangent>
    void discrete_gradient(const V* e0, const V* e1, V* s, V* T) const;
    template <bool tangent>
    static void without_metric(V* s, V* T) {
        for (int k = 0; k < 6; ++k) s[k] *= weight(k);
        for (int k = 0; tangent && k < n; ++k)
            for (int l = 0; l < n; ++l) T[n * k + l] *= weight(k) * weight(l);
    }
};

/// The mean of the energies at the entropies where a step begins and where it ends: at one strain constant
/// capacities make both temperatures a multiple of each other, 1 + more. Derivatives by the entropy are those
/// by the one at the end.
struct EntropyMean : ThermoelasticEnergy {
    V more;
    EntropyMean(const ThermoelasticEnergy& energy, V by) : ThermoelasticEnergy(energy), more(by) {}
    using ThermoelasticEnergy::increase;
    V temperature(const Shared& at, const V* e) const { return p[thermal::zero] + heat.rise_of(e[6] - at.M); }
    V increase(const Shared& from, const V* e0, const Shared& to, const V*) const {
        const V dM = to.M - from.M, theta = (1.0 + 0.5 * more) * temperature(from, e0);
        return (to.w.W - from.w.W) + p[thermal::zero] * dM + heat.c * theta * expm1(-dM / heat.c);
    }
    template <bool second>
    void evaluate(const Shared& at, const V* e, Potential<n>& to) const {
        const V zero = p[thermal::zero], first = heat.rise_of(e[6] - at.M),
                rise = first + 0.5 * more * (zero + first), later = 0.5 * (1.0 + more) * (zero + first);
        to.W = at.w.W + zero * at.M + heat.c * rise, to.s[6] = later;
        for (int k = 0; k < 6; ++k) to.s[k] = at.w.s[k] - rise * at.M_C[k];
        if constexpr (second) {
            const V by_s = (zero + rise) / heat.c, by_later = later / heat.c;
            for (int k = 0; k < 6; ++k) {
                for (int l = k; l < 6; ++l) {
                    const int i = packed(6, k, l);
                    to.d[packed(n, k, l)] = at.w.d[i] - rise * at.M_CC[i] + by_s * at.M_C[k] * at.M_C[l];
                }
                to.d[packed(n, k, 6)] = -by_later * at.M_C[k];
            }
        }
    }
};

/// That of discrete_gradient.hpp, conjugate to strains as they stand: where capacities are constant in fewer
/// evaluations. Paths of strains at either entropy are one of the mean of both energies, and the temperature
/// is the quotient of differences: (theta(C0, s0) + theta(C1, s0)) / 2 (exp(x) - 1) / x, x = (s1 - s0) / c.
template <bool tangent>
void ThermoelasticEnergy::discrete_gradient(const V* e0, const V* e1, V* s, V* T) const {
    if (!heat.is_constant) {
        VISVIVA_ISA::discrete_gradient<tangent>(*this, e0, e1, s, T);
        return without_metric<tangent>(s, T);
    }
    const V x = (e1[6] - e0[6]) / heat.c;
    const EntropyMean mean(*this, expm1(x));
    const Places<tangent, EntropyMean> places(mean, e0, e1);
    V middle[n], d[n], df[n] = {};
    for (int k = 0; k < n; ++k) d[k] = e1[k] - e0[k], middle[k] = k < 6 ? 0.5 * (e0[k] + e1[k]) : e0[k];
    Potential<n> p0, p1, m;
    mean.evaluate<false>(places.at[at_start], e0, p0), mean.evaluate<false>(places.at[at_end], middle, p1);
    mean.evaluate<tangent>(places.at[in_middle], middle, m);
    const V f = correction<tangent>(places, mean, Part<EntropyMean>{0, true}, e0, e1, d, m, p0, p1, df);
    for (int k = 0; k < 6; ++k) {
        s[k] = m.s[k] + f * d[k];
        for (int l = 0; tangent && l < n; ++l)
            T[n * k + l] = (l < 6 ? 0.5 : 1.0) * m.second(k, l) + d[k] * df[l];
        if constexpr (tangent) T[n * k + k] += (1.0 / weight(k)) * f;
    }
    const VI still = x == 0.0;
    const V per = select(still, broadcast(1.0), mean.more / select(still, broadcast(1.0), x));
    // p.s[6] is half of the temperature at the entropy of the end
    const V both = (p0.s[6] + p1.s[6]) / (1.0 + mean.more);
    s[6] = both * per;
    if constexpr (tangent) {
        const V slope = select(vabs(x) < 1e-2, 0.5 + x * (1.0 / 3 + x * (0.125 + x / 30.0)),
                               ((1.0 + mean.more) - per) / select(still, broadcast(1.0), x));
        for (int l = 0; l < 6; ++l)
            T[n * 6 + l] = (-p1.s[6] / (1.0 + mean.more)) * (per / heat.c) * places.at[at_end].M_C[l];
        T[n * 6 + 6] = both * slope / heat.c;
    }
    without_metric<tangent>(s, T);
}

/// The balance s' = div(K grad theta / theta) + grad theta . K grad theta / theta^2 tests the entropy, and
/// that the temperature is D_s e the temperature. Both have the same shape functions, so that heat flows and
/// nothing of the energy is lost. K is that of the reference, or J F^-1 k F^-T of a conductivity in space.
struct HeatPairing {
    static constexpr bool is_gradient = false;

    /// K slope; with the strain C of a conductivity in space, which is isotropic.
    template <class T>
    static VISVIVA_INLINE void conduct(const T* C, const V* k, const T* slope, T* flux) {
        if (!C) {
            for (int a = 0; a < 3; ++a)
                flux[a] = k[voigt[a][0]] * slope[0] + k[voigt[a][1]] * slope[1] + k[voigt[a][2]] * slope[2];
            return;
        }
        const T x = C[0] + broadcast(1.0), y = C[1] + broadcast(1.0), z = C[2] + broadcast(1.0);
        const T cofactor[6] = {y * z - C[4] * C[4],    z * x - C[5] * C[5],    x * y - C[3] * C[3],
                               C[4] * C[5] - C[3] * z, C[5] * C[3] - C[4] * x, C[3] * C[4] - C[5] * y};
        const T det = x * cofactor[0] + C[3] * cofactor[3] + C[5] * cofactor[5],
                share = k[0] * inverse(root(det));
        for (int a = 0; a < 3; ++a)
            flux[a] = share * (cofactor[voigt[a][0]] * slope[0] + cofactor[voigt[a][1]] * slope[1] +
                               cofactor[voigt[a][2]] * slope[2]);
    }

    /// What tests the entropy, its gradient, the temperature and its gradient (8), by the temperature, its
    /// gradient, the rate of the entropy and D_s e. Of the conductivity there may be a share left.
    template <class T>
    static VISVIVA_INLINE void balance(const T& theta, const T* slope, const T& rate, const T& conjugate,
                                       const V* par, const T* C, T* f, const T* left = nullptr) {
        T flux[3];
        conduct(C, par + thermal::conductivity, slope, flux);
        if (!all(par[thermal::conductivity_slope] == 0.0)) {
            const T factor = par[thermal::conductivity_slope] * (theta - par[thermal::zero]) + broadcast(1.0);
            for (int a = 0; a < 3; ++a) flux[a] = factor * flux[a];
        }
        for (int a = 0; left && a < 3; ++a) flux[a] = *left * flux[a];
        const T over = inverse(theta);
        f[0] = rate;
        for (int a = 0; a < 3; ++a) {
            f[1 + a] = flux[a] * over, f[5 + a] = 0.0 * theta;
            f[0] = f[0] - (slope[a] * over) * f[1 + a];
        }
        f[4] = theta - conjugate;
    }

    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        typename State::T C[6], slope[3];
        const bool in_space = z.par[thermal::spatial][0] > 0;
        for (int a = 0; a < 6; ++a) f[a] = z.s(a);
        for (int a = 0; a < 6 && in_space; ++a) C[a] = z.e(a);
        for (int a = 0; a < 3; ++a) slope[a] = z.e(11 + a);
        balance(z.e(10), slope, z.rate(6), z.s(6), z.par, in_space ? C : nullptr, f + 6);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

}  // namespace visviva::VISVIVA_ISA
