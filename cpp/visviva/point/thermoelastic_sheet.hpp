// Solids whose material conducts heat, in plane stress.
#pragma once
#include "visviva/point/thermoelastic.hpp"

namespace visviva::VISVIVA_ISA {

/// What of e(C, s) plane stress asks for.
struct PlainThermoelasticEnergy : PlainEnergy {
    static constexpr int n = 7, n_blocks = 2;
    static constexpr int block(int k) { return k / 6; }
    static constexpr double weight(int k) { return k < 6 ? tensor_weight(k) : 1.0; }
    ThermoelasticEnergy inner;
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        inner.evaluate<second>(e, to);
    }
};

/// e(C, s) at the C33 that leaves no stress across at this entropy, see PlaneStress.
struct SheetEnergy : PlaneStress<PlainThermoelasticEnergy> {
    static constexpr int max_par = thermal::n_par, first_entropy = 6, n_entropies = 1;
    explicit SheetEnergy(const V* par)
        : PlaneStress<PlainThermoelasticEnergy>{{{}, ThermoelasticEnergy(par)}, true} {}
    void settle(const V* in_plane, V* e) const {
        for (int k = 0; k < n; ++k) e[k] = in_plane[k];
        e[2] = across(in_plane);
    }
    V increase(const V* e0, const V* e1) const {
        V from[n], to[n];
        settle(e0, from), settle(e1, to);
        return inner.increase(from, to);
    }
};

/// HeatPairing, where a conductivity in space is of a sheet that is as thick as C33 says.
struct SheetHeatPairing : HeatPairing {
    static V value(V x) { return x; }
    template <class T>
    static V value(const T& x) {
        return x.v;
    }
    /// C33 - 1 where what acts does, with its derivatives by the other strains and the entropy.
    template <class State>
    static VISVIVA_INLINE typename State::T across(const State& z) {
        using T = typename State::T;
        constexpr int n = SheetEnergy::n;
        const SheetEnergy energy(z.par);
        Potential<n> p;
        V e[n], at[n];
        for (int k = 0; k < n; ++k) e[k] = value(z.e(k));
        energy.settle(e, at), energy.inner.template evaluate<true>(at, p);
        T found = 0.0 * z.e(0) + at[2];
        for (int k = 0; k < n; ++k)
            if (k != 2) {
                const V slope = SheetEnergy::weight(k) * p.second(k, 2) / p.second(2, 2);
                found = found - slope * (z.e(k) + (-e[k]));
            }
        return found;
    }
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        typename State::T C[6], slope[3];
        const bool in_space = z.par[thermal::spatial][0] > 0;
        for (int a = 0; a < 6; ++a) f[a] = z.s(a);
        for (int a = 0; a < 6 && in_space; ++a) C[a] = a == 2 ? across(z) : z.e(a);
        for (int a = 0; a < 3; ++a) slope[a] = z.e(11 + a);
        balance(z.e(10), slope, z.warming(6, z.e(10)), z.s(6), z.par, in_space ? C : nullptr, f + 6);
    }
};

}  // namespace visviva::VISVIVA_ISA
