// Solids that crack and conduct heat: the internal energy of strain, damage and entropy, and its balances.
#pragma once
#include "visviva/point/fracture.hpp"
#include "visviva/point/thermoelastic.hpp"

namespace visviva::VISVIVA_ISA {

/// Places of the parameters: those of heat up to the material, with the expansion in place of the coupling
/// and the share of the conductivity that cracks leave in place of the slope of the moduli; those of
/// fracture.
namespace heated_fracture {
constexpr int expansion = thermal::coupling, left = thermal::slope, fracture = thermal::material,
              n_par = fracture + visviva::VISVIVA_ISA::fracture::n_par;
}

/// That of fracture with the free strain alpha (t - theta0), and the heat content of t, the temperature that
/// an entropy s has without strain. Moduli are so those at constant entropy, and the temperature is de/ds = t
/// (1 + alpha dW/d(free strain) / c).
struct HeatedFractureEnergy : PlainEnergy {
    using Plain = FractureEnergy<true>;
    static constexpr int n = 11, max_par = heated_fracture::n_par, n_blocks = 3;
    static constexpr int first_entropy = 10, n_entropies = 1;
    static constexpr double smooth = Plain::smooth;  // natural_square() for the natural size
    static constexpr int block(int k) { return Plain::block(k); }
    static constexpr double weight(int k) { return Plain::weight(k); }
    const V* p;
    Capacity heat;
    Plain plain;
    explicit HeatedFractureEnergy(const V* par)
        : p(par),
          heat(p[thermal::capacity], p[thermal::zero], p + thermal::more),
          plain(p + heated_fracture::fracture) {}

    /// Strains and damages have no unit. Entropies change as the logarithm of the temperature does, times the
    /// capacity. The difference of energies of strain has rounding that beside a smaller change would swing
    /// iterations between two temperatures.
    V natural_square(int k) const {
        constexpr double one = Plain::natural * Plain::natural;
        return k == 10 ? p[thermal::capacity] * p[thermal::capacity] : broadcast(one);
    }
    /// The strains of a free strain.
    V stretched(const V* e, V* z) const {
        const V rise = heat.rise_of(e[10]);
        for (int k = 0; k < 10; ++k) z[k] = e[k];
        z[10] = p[heated_fracture::expansion] * rise;
        return rise;
    }
    V increase(const V* e0, const V* e1) const {
        V z[n];
        Potential<n> from, to;
        stretched(e0, z), plain.template evaluate<false>(z, from);
        stretched(e1, z), plain.template evaluate<false>(z, to);
        return (to.W - from.W) + heat.increase(e0[10], e1[10] - e0[10]);
    }
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        V z[n];
        const V rise = stretched(e, z), theta = p[thermal::zero] + rise, c = heat.at(rise);
        const V by_s = theta / c, alpha = p[heated_fracture::expansion], slope = alpha * by_s;
        plain.template evaluate<second>(z, to);
        const V pull = to.s[10];
        to.W += heat.content(rise);
        to.s[10] = theta + slope * pull;
        if constexpr (second) {
            const V bend = by_s * (c - theta * heat.bend(rise)) / (c * c);
            for (int k = 0; k < 10; ++k) to.d[packed(n, k, 10)] *= slope;
            V& last = to.d[packed(n, 10, 10)];
            last = slope * slope * last + alpha * bend * pull + by_s;
        }
    }
};

/// Stresses, and the balance of entropy with a conductivity of which cracks leave a share.
struct HeatedFracturePairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        using T = typename State::T;
        T C[6], slope[3];
        const bool in_space = z.par[thermal::spatial][0] > 0;
        for (int k = 0; k < 10; ++k) f[k] = z.s(k);
        for (int k = 0; k < 6 && in_space; ++k) C[k] = z.e(k);
        for (int a = 0; a < 3; ++a) slope[a] = z.e(15 + a);
        const V share = z.par[heated_fracture::left];
        const T sound = -z.e(6) + broadcast(1.0), left = (1.0 - share) * (sound * sound) + share;
        HeatPairing::balance(z.e(14), slope, z.warming(10, z.e(14)), z.s(10), z.par, in_space ? C : nullptr,
                             f + 10, &left);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

}  // namespace visviva::VISVIVA_ISA
