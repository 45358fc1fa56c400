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

/// Strains of a solid, with W and ln J by them: C at the point alone.
struct PointVolume {
    static constexpr int n = 6;
    static constexpr double weight(int k) { return tensor_weight(k); }
    template <bool second>
    static void evaluate(const MaterialEnergy& energy, const V* e, Potential<n>& w, Potential<n>& log_j) {
        energy.evaluate<second>(e, w);
        VolumeEnergy{{}, VolumeMeasure::logarithm, V{}}.evaluate<second>(e, log_j);
    }
};

/// e(C, s) of psi(C, theta) = W(C) (1 + slope (theta - theta0)) - beta (theta - theta0) ln J + what a
/// capacity c(theta) stores, any material's W: with M = beta ln J - slope W the temperature follows from
/// H(theta) = s - M, and e = W + theta0 M + U(theta); see Capacity. W and ln J may be of other strains than
/// C at the point, see PointVolume and thermoelastic_volumes.hpp.
template <class Volume>
struct ThermoelasticEnergyOf : PlainEnergy {
    static constexpr int n_C = Volume::n, n = n_C + 1, max_par = thermal::n_par, n_blocks = 2;
    static constexpr int first_entropy = n_C, n_entropies = 1;
    static constexpr int block(int k) { return k / n_C; }
    static constexpr double weight(int k) { return k < n_C ? Volume::weight(k) : 1.0; }
    const V* p;
    Capacity heat;
    explicit ThermoelasticEnergyOf(const V* par)
        : p(par), heat(p[thermal::capacity], p[thermal::zero], p + thermal::more) {}

    /// W and M of a strain.
    struct Shared {
        Potential<n_C> w;
        V M, M_C[n_C], M_CC[n_C * (n_C + 1) / 2];
    };
    template <bool second>
    void share(const V* e, Shared& at) const {
        Potential<n_C> v;
        const auto kind = static_cast<MaterialKind>(p[thermal::kind][0]);
        Volume::template evaluate<second>(MaterialEnergy{{}, kind, p + thermal::material}, e, at.w, v);
        const V beta = p[thermal::coupling], slope = p[thermal::slope];
        at.M = beta * v.W - slope * at.w.W;
        for (int k = 0; k < n_C; ++k) at.M_C[k] = beta * v.s[k] - slope * at.w.s[k];
        for (int k = 0; second && k < n_C * (n_C + 1) / 2; ++k)
            at.M_CC[k] = beta * v.d[k] - slope * at.w.d[k];
    }
    V increase(const Shared& from, const V* e0, const Shared& to, const V* e1) const {
        const V dM = to.M - from.M;
        return (to.w.W - from.w.W) + p[thermal::zero] * dM +
               heat.increase(e0[n_C] - from.M, (e1[n_C] - e0[n_C]) - dM);
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
        const V zero = p[thermal::zero], rise = heat.rise_of(e[n_C] - at.M), theta = zero + rise;
        to.W = at.w.W + zero * at.M + heat.content(rise);
        for (int k = 0; k < n_C; ++k) to.s[k] = at.w.s[k] - rise * at.M_C[k];
        to.s[n_C] = theta;
        if constexpr (second) {
            const V by_s = theta / heat.at(rise);
            for (int k = 0; k < n_C; ++k) {
                for (int l = k; l < n_C; ++l) {
                    const int i = packed(n_C, k, l);
                    to.d[packed(n, k, l)] = at.w.d[i] - rise * at.M_CC[i] + by_s * at.M_C[k] * at.M_C[l];
                }
                to.d[packed(n, k, n_C)] = -by_s * at.M_C[k];
            }
            to.d[packed(n, n_C, n_C)] = by_s;
        }
    }
    template <bool tangent>
    void discrete_gradient(const V* e0, const V* e1, V* s, V* T) const;
    template <bool tangent>
    static void without_metric(V* s, V* T) {
        for (int k = 0; k < n_C; ++k) s[k] *= weight(k);
        for (int k = 0; tangent && k < n; ++k)
            for (int l = 0; l < n; ++l) T[n * k + l] *= weight(k) * weight(l);
    }
};

/// The mean of the energies at the entropies where a step begins and where it ends: at one strain constant
/// capacities make both temperatures a multiple of each other, 1 + more. Derivatives by the entropy are those
/// by the one at the end.
template <class Volume>
struct EntropyMean : ThermoelasticEnergyOf<Volume> {
    using Base = ThermoelasticEnergyOf<Volume>;
    using Base::heat, Base::increase, Base::n, Base::n_C, Base::p;
    using typename Base::Shared;
    V more;
    EntropyMean(const Base& energy, V by) : Base(energy), more(by) {}
    V temperature(const Shared& at, const V* e) const {
        return p[thermal::zero] + heat.rise_of(e[n_C] - at.M);
    }
    V increase(const Shared& from, const V* e0, const Shared& to, const V*) const {
        const V dM = to.M - from.M, theta = (1.0 + 0.5 * more) * temperature(from, e0);
        return (to.w.W - from.w.W) + p[thermal::zero] * dM + heat.c * theta * expm1(-dM / heat.c);
    }
    template <bool second>
    void evaluate(const Shared& at, const V* e, Potential<n>& to) const {
        const V zero = p[thermal::zero], first = heat.rise_of(e[n_C] - at.M),
                rise = first + 0.5 * more * (zero + first), later = 0.5 * (1.0 + more) * (zero + first);
        to.W = at.w.W + zero * at.M + heat.c * rise, to.s[n_C] = later;
        for (int k = 0; k < n_C; ++k) to.s[k] = at.w.s[k] - rise * at.M_C[k];
        if constexpr (second) {
            const V by_s = (zero + rise) / heat.c, by_later = later / heat.c;
            for (int k = 0; k < n_C; ++k) {
                for (int l = k; l < n_C; ++l) {
                    const int i = packed(n_C, k, l);
                    to.d[packed(n, k, l)] = at.w.d[i] - rise * at.M_CC[i] + by_s * at.M_C[k] * at.M_C[l];
                }
                to.d[packed(n, k, n_C)] = -by_later * at.M_C[k];
            }
        }
    }
};

/// That of discrete_gradient.hpp, conjugate to strains as they stand: where capacities are constant in fewer
/// evaluations. Paths of strains at either entropy are one of the mean of both energies, and the temperature
/// is the quotient of differences: (theta(C0, s0) + theta(C1, s0)) / 2 (exp(x) - 1) / x, x = (s1 - s0) / c.
template <class Volume>
template <bool tangent>
void ThermoelasticEnergyOf<Volume>::discrete_gradient(const V* e0, const V* e1, V* s, V* T) const {
    if (!heat.is_constant) {
        VISVIVA_ISA::discrete_gradient<tangent>(*this, e0, e1, s, T);
        return without_metric<tangent>(s, T);
    }
    const V x = (e1[n_C] - e0[n_C]) / heat.c;
    const EntropyMean<Volume> mean(*this, expm1(x));
    const Places<tangent, EntropyMean<Volume>> places(mean, e0, e1);
    V middle[n], d[n], df[n] = {};
    for (int k = 0; k < n; ++k) d[k] = e1[k] - e0[k], middle[k] = k < n_C ? 0.5 * (e0[k] + e1[k]) : e0[k];
    Potential<n> p0, p1, m;
    mean.template evaluate<false>(places.at[at_start], e0, p0);
    mean.template evaluate<false>(places.at[at_end], middle, p1);
    mean.template evaluate<tangent>(places.at[in_middle], middle, m);
    const V f =
        correction<tangent>(places, mean, Part<EntropyMean<Volume>>{0, true}, e0, e1, d, m, p0, p1, df);
    for (int k = 0; k < n_C; ++k) {
        s[k] = m.s[k] + f * d[k];
        for (int l = 0; tangent && l < n; ++l)
            T[n * k + l] = (l < n_C ? 0.5 : 1.0) * m.second(k, l) + d[k] * df[l];
        if constexpr (tangent) T[n * k + k] += (1.0 / weight(k)) * f;
    }
    const VI still = x == 0.0;
    const V per = select(still, broadcast(1.0), mean.more / select(still, broadcast(1.0), x));
    // p.s[6] is half of the temperature at the entropy of the end
    const V both = (p0.s[n_C] + p1.s[n_C]) / (1.0 + mean.more);
    s[n_C] = both * per;
    if constexpr (tangent) {
        const V slope = select(vabs(x) < 1e-2, 0.5 + x * (1.0 / 3 + x * (0.125 + x / 30.0)),
                               ((1.0 + mean.more) - per) / select(still, broadcast(1.0), x));
        for (int l = 0; l < n_C; ++l)
            T[n * n_C + l] = (-p1.s[n_C] / (1.0 + mean.more)) * (per / heat.c) * places.at[at_end].M_C[l];
        T[n * n_C + n_C] = both * slope / heat.c;
    }
    without_metric<tangent>(s, T);
}

using ThermoelasticEnergy = ThermoelasticEnergyOf<PointVolume>;

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

    /// With n strains before the entropy.
    template <int n, class State>
    static VISVIVA_INLINE void forces_behind(const State& z, typename State::T* f) {
        typename State::T C[6], slope[3];
        const bool in_space = z.par[thermal::spatial][0] > 0;
        for (int a = 0; a < n; ++a) f[a] = z.s(a);
        for (int a = 0; a < 6 && in_space; ++a) C[a] = z.e(a);
        for (int a = 0; a < 3; ++a) slope[a] = z.e(n + 5 + a);
        balance(z.e(n + 4), slope, z.warming(n, z.e(n + 4)), z.s(n), z.par, in_space ? C : nullptr, f + n);
    }
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        forces_behind<6>(z, f);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

}  // namespace visviva::VISVIVA_ISA
