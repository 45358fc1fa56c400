// Solids whose material conducts heat: the internal energy of strain and entropy, and the balance of entropy.
#pragma once
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
    explicit ThermoelasticEnergy(const V* par) : p(par) {}

    Capacity heat() const { return {p[thermal::capacity], p[thermal::zero], p + thermal::more}; }
    /// W and M of a strain.
    void strained(const V* e, V& W, V& M) const {
        Response w, m;
        respond<false>(static_cast<MaterialKind>(p[thermal::kind][0]), e, p + thermal::material, w);
        VolumeEnergy{{}, VolumeMeasure::logarithm, V{}}.evaluate<false>(e, m);
        W = w.W, M = p[thermal::coupling] * m.W - p[thermal::slope] * w.W;
    }
    V increase(const V* from, const V* to) const {
        V W0, M0, W1, M1;
        strained(from, W0, M0), strained(to, W1, M1);
        return (W1 - W0) + p[thermal::zero] * (M1 - M0) +
               heat().increase(from[6] - M0, (to[6] - from[6]) - (M1 - M0));
    }

    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        Response w, m;
        respond<second>(static_cast<MaterialKind>(p[thermal::kind][0]), e, p + thermal::material, w);
        VolumeEnergy{{}, VolumeMeasure::logarithm, V{}}.evaluate<second>(e, m);
        const V zero = p[thermal::zero], beta = p[thermal::coupling], slope = p[thermal::slope];
        const Capacity capacity = heat();
        const V M = beta * m.W - slope * w.W, rise = capacity.rise_of(e[6] - M), theta = zero + rise;
        const V c = capacity.at(rise);
        V M_C[6];
        for (int k = 0; k < 6; ++k) {
            M_C[k] = beta * m.s[k] - slope * w.s[k];
            to.s[k] = w.s[k] - rise * M_C[k];
        }
        to.W = w.W + zero * M + capacity.content(rise);
        to.s[6] = theta;
        if constexpr (second) {
            for (int k = 0; k < 6; ++k) {
                for (int l = k; l < 6; ++l) {
                    const int at = packed(6, k, l);
                    to.d[packed(n, k, l)] =
                        w.d[at] - rise * (beta * m.d[at] - slope * w.d[at]) + theta / c * M_C[k] * M_C[l];
                }
                to.d[packed(n, k, 6)] = -theta / c * M_C[k];
            }
            to.d[packed(n, 6, 6)] = theta / c;
        }
    }
};

/// The balance s' = div(K grad theta / theta) + grad theta . K grad theta / theta^2 tests the entropy, and
/// that the temperature is D_s e the temperature. Both have the same shape functions, so that heat flows and
/// nothing of the energy is lost. K is that of the reference, or J F^-1 k F^-T of a conductivity in space.
struct HeatPairing {
    static constexpr bool is_gradient = false;

    template <class T>
    static VISVIVA_INLINE void conduct(const T* C, const V* k, const T* slope, bool in_space, T* flux) {
        constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        T pulled[6];
        for (int a = 0; a < 6; ++a) pulled[a] = 0.0 * slope[0] + k[a];
        if (in_space) {
            const T x = C[0] + broadcast(1.0), y = C[1] + broadcast(1.0), z = C[2] + broadcast(1.0);
            const T cofactor[6] = {y * z - C[4] * C[4],    z * x - C[5] * C[5],    x * y - C[3] * C[3],
                                   C[4] * C[5] - C[3] * z, C[5] * C[3] - C[4] * x, C[3] * C[4] - C[5] * y};
            const T det = x * cofactor[0] + C[3] * cofactor[3] + C[5] * cofactor[5];
            for (int a = 0; a < 6; ++a) pulled[a] = k[0] * (cofactor[a] / root(det));
        }
        for (int a = 0; a < 3; ++a)
            flux[a] = pulled[at[a][0]] * slope[0] + pulled[at[a][1]] * slope[1] + pulled[at[a][2]] * slope[2];
    }

    /// What tests the entropy, its gradient, the temperature and its gradient (8), by the temperature, its
    /// gradient, the rate of the entropy and D_s e.
    template <class T>
    static VISVIVA_INLINE void balance(const T& theta, const T* slope, const T& rate, const T& conjugate,
                                       const V* par, const T* C, T* f) {
        T flux[3];
        conduct(C, par + thermal::conductivity, slope, C && par[thermal::spatial][0] > 0, flux);
        const T factor = par[thermal::conductivity_slope] * (theta - par[thermal::zero]) + broadcast(1.0);
        for (int a = 0; a < 3; ++a) flux[a] = factor * flux[a];
        const T square = slope[0] * flux[0] + slope[1] * flux[1] + slope[2] * flux[2];
        f[0] = rate - square / (theta * theta);
        f[4] = theta - conjugate;
        for (int a = 0; a < 3; ++a) f[1 + a] = flux[a] / theta, f[5 + a] = 0.0 * theta;
    }

    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        for (int a = 0; a < 6; ++a) f[a] = z.s[a];
        balance(z.e[10], z.e + 11, z.rate[6], z.s[6], z.par, z.e, f + 6);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

}  // namespace visviva::VISVIVA_ISA
