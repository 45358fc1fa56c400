// Pairings: what tests the variation of every strain. The residual is the sum over points of f . de, so that
// a pairing gives one number f for every strain of the map, from stresses, strains where they act, and rates.
#pragma once
#include "visviva/base/jet.hpp"

namespace visviva::VISVIVA_ISA {

/// Values alone, or with derivatives by n variables.
template <int n, bool slopes>
struct Number {
    using type = Jet<n, false>;
    static VISVIVA_INLINE type of(V value, const V* slope) {
        type t = type::constant(value);
        for (int j = 0; slope && j < n; ++j) t.g[j] = slope[j];
        return t;
    }
};
template <int n>
struct Number<n, false> {
    using type = V;
    static VISVIVA_INLINE V of(V value, const V*) { return value; }
};

/// View of a pairing, values alone or with derivatives: stresses (of the strains of the energy, the
/// first ones of the map), strains at theta (at the end of what acts there), their change in the step, rates.
template <class Number, int n_e, int n_s>
struct PointState {
    using T = typename Number::type;
    T s[n_s], e[n_e], change[n_e], rate[n_e];
    const V* par;
    double h;
    bool moves;      // increments make velocities
    bool backwards;  // the books go the step from its end to its start, see Context
};

/// Conservative: the gradient of the energy, f = s.
struct GradientPairing {
    static constexpr bool is_gradient = true;
};

}  // namespace visviva::VISVIVA_ISA
