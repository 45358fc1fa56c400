// Solids whose material conducts heat, with a change of volume that is not that of the point: F-bar and
// mixed.
#pragma once
#include "visviva/point/maps.hpp"
#include "visviva/point/thermoelastic.hpp"

namespace visviva::VISVIVA_ISA {

/// F-bar: C at the point and C0 at the element's centre, which tells J; in plane strain that of the plane.
template <int directions>
struct CentreVolume {
    static constexpr int n = 12;
    static constexpr double weight(int k) { return tensor_weight(k); }
    template <bool second>
    static void evaluate(const MaterialEnergy& energy, const V* e, Potential<n>& w, Potential<n>& log_j) {
        FbarEnergy<MaterialEnergy>{{}, energy, false, directions}.evaluate<second>(e, w);
        Response centre;
        VolumeEnergy{{}, VolumeMeasure::logarithm, V{}}.evaluate<second>(e + 6, centre);
        log_j.W = centre.W;
        for (int k = 0; k < n; ++k) {
            log_j.s[k] = k < 6 ? V{} : centre.s[k - 6];
            for (int l = k; second && l < n; ++l)
                log_j.d[packed(n, k, l)] = k < 6 ? V{} : centre.second(k - 6, l - 6);
        }
    }
};

/// (C, C0) of a map, with the weights of the point and of the centre.
template <class Base>
struct CentreMap : Layout<CentreMap<Base>> {
    static constexpr int components = Base::groups[0].components, columns = Base::groups[0].columns;
    static constexpr int n_groups = 1, n_components = components, n_local = 2 * Base::n_local, n_strains = 12;
    static constexpr Group groups[] = {{components, 2 * columns, 2}};
    static constexpr double origin(int j) { return Base::origin(j / (2 * columns) * columns + j % columns); }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        T at[Base::n_local] = {}, centre[Base::n_local] = {};
        for (int i = 0; i < components; ++i)
            for (int k = 0; k < columns; ++k) {
                at[columns * i + k] = y[2 * columns * i + k];
                centre[columns * i + k] = y[2 * columns * i + columns + k];
            }
        Base::strains(at, e), Base::strains(centre, e + 6);
    }
};

struct CentreHeatPairing : HeatPairing {
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        forces_behind<12>(z, f);
    }
};

/// Mixed: the energy is that of exp(G) for J, W(Cbar) with Cbar = (exp(2 G) / det C)^(1/3) C.
struct GivenVolume {
    static constexpr int n = 7;
    static constexpr double weight(int k) { return k < 6 ? tensor_weight(k) : 1.0; }
    template <class T>
    static void strain(const T* e, T* bar) {
        const T t = expm1((1.0 / 3) * (2.0 * e[6] - log1p(determinant_less_one(e))));
        for (int k = 0; k < 6; ++k) bar[k] = k < 3 ? e[k] + t * e[k] + t : e[k] + t * e[k];
    }
    template <bool second>
    static void evaluate(const MaterialEnergy& energy, const V* e, Potential<n>& w, Potential<n>& log_j) {
        evaluate_at<second>(GivenVolume(), energy, e, [](const auto* of, auto* bar) { strain(of, bar); }, w);
        log_j.W = e[6];
        for (int k = 0; k < n; ++k) log_j.s[k] = broadcast(k < 6 ? 0.0 : 1.0);
        if (second) clear(log_j.d, n * (n + 1) / 2);
    }
};

/// e(C, G, s) + p (ln J(C) - G) of (C, G, s, p): G is the change of volume that the pressures see, in their
/// space, p what makes it that of C. A step has one pressure, that of its end: with ln J by its discrete
/// gradient p changes no energy where the equation of p holds at both ends of the step.
struct VolumePressureEnergy : PlainEnergy {
    static constexpr int n = 9, max_par = thermal::n_par, first_entropy = 7, n_entropies = 1;
    static constexpr double weight(int k) { return k < 6 ? tensor_weight(k) : 1.0; }
    using Base = ThermoelasticEnergyOf<GivenVolume>;
    Base energy;
    explicit VolumePressureEnergy(const V* par) : energy(par) {}
    static VolumeEnergy logarithm() { return {{}, VolumeMeasure::logarithm, V{}}; }

    template <bool second>
    void evaluate(const V* z, Potential<n>& to) const {
        Potential<8> base;
        Response log;
        energy.evaluate<second>(z, base), logarithm().evaluate<second>(z, log);
        to.W = base.W + z[8] * (log.W - z[6]), to.s[8] = log.W - z[6];
        for (int k = 0; k < 8; ++k) {
            to.s[k] = base.s[k] + z[8] * (k < 6 ? log.s[k] : broadcast(k == 6 ? -1.0 : 0.0));
            if constexpr (second) {
                for (int l = k; l < 8; ++l)
                    to.d[packed(n, k, l)] = base.second(k, l) + (l < 6 ? z[8] * log.second(k, l) : V{});
                to.d[packed(n, k, 8)] = k < 6 ? log.s[k] : broadcast(k == 6 ? -1.0 : 0.0);
            }
        }
        if constexpr (second) to.d[packed(n, 8, 8)] = V{};
    }
    /// Of strains as they stand.
    template <bool tangent>
    void discrete_gradient(const V* z0, const V* z1, V* s, V* T) const {
        V base[8], moduli[64], log[6], slopes[36];
        Response start;
        energy.discrete_gradient<tangent>(z0, z1, base, moduli);
        VISVIVA_ISA::discrete_gradient<tangent>(logarithm(), z0, z1, log, slopes);
        logarithm().evaluate<false>(z0, start);
        for (int k = 0; tangent && k < n * n; ++k) T[k] = V{};
        for (int k = 0; k < 8; ++k) {
            const V by = k < 6 ? weight(k) * log[k] : broadcast(k == 6 ? -1.0 : 0.0);
            s[k] = base[k] + z1[8] * by;
            for (int l = 0; tangent && l < 8; ++l) {
                T[n * k + l] = moduli[8 * k + l];
                if (k < 6 && l < 6) T[n * k + l] += (weight(k) * weight(l)) * z1[8] * slopes[6 * k + l];
            }
            if (tangent) T[n * k + 8] = by;
        }
        s[8] = start.W - z0[6];
    }
};

/// (C, G, s, p, grad s, theta, grad theta) with the C of a map
template <class Base>
struct VolumePressureMap : Layout<VolumePressureMap<Base>> {
    static constexpr bool couples(int g, int h) {
        constexpr bool table[5][5] = {
            {1, 1, 1, 0, 1}, {1, 1, 1, 0, 1}, {1, 1, 1, 1, 0}, {1, 1, 1, 1, 0}, {1, 1, 0, 0, 0}};
        return table[g][h];
    }
    static constexpr int tested(int g) { return g == 3 ? 1 : groups[g].columns; }
    static constexpr int tried(int g) { return g == 2 ? 1 : groups[g].columns; }
    static constexpr int columns = Base::groups[0].components + 1, first = Base::n_local;
    static constexpr int n_groups = 5, n_components = Base::n_components + 4,
                         n_local = first + 2 * columns + 2, n_strains = 16;
    static constexpr Group groups[] = {
        Base::groups[0], {1, 1, 0}, {1, columns, 1}, {1, columns, 0, true}, {1, 1, 0, true}};
    static constexpr double origin(int j) { return j < first ? Base::origin(j) : 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        const T *G = y + first, *s = G + 1, *theta = s + columns, *p = theta + columns;
        Base::strains(y, e);
        e[6] = G[0], e[7] = s[0], e[8] = p[0], e[12] = theta[0];
        for (int k = 1; k < 4; ++k) {
            e[8 + k] = k < columns ? s[k] : 0.0 * y[0];
            e[12 + k] = k < columns ? theta[k] : 0.0 * y[0];
        }
    }
};

/// HeatPairing, and that ln J - G vanishes at the end of the step, tested by the pressures.
struct VolumePressurePairing : HeatPairing {
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        using T = typename State::T;
        T C[6], end[6], slope[3], heat[8];
        const bool in_space = z.par[thermal::spatial][0] > 0;
        for (int a = 0; a < 7; ++a) f[a] = z.s(a);
        for (int a = 0; a < 6; ++a) C[a] = z.e(a), end[a] = z.at_end(a);
        for (int a = 0; a < 3; ++a) slope[a] = z.e(13 + a);
        balance(z.e(12), slope, z.warming(7, z.e(12)), z.s(7), z.par, in_space ? C : nullptr, heat);
        f[7] = heat[0], f[8] = 0.5 * log1p(determinant_less_one(end)) - z.at_end(6);
        for (int a = 0; a < 7; ++a) f[9 + a] = heat[1 + a];
    }
};

}  // namespace visviva::VISVIVA_ISA
