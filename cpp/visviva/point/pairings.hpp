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

/// View of a pairing, values alone or with derivatives by the local unknowns at the end, each found when it
/// is asked for: stresses s(k) (of the strains of the energy, the first ones of the map), strains e(k) at
/// theta (at the end of what acts there), at_end(k), their change(k) in the step, rate(k).
template <class Element, bool slopes>
struct PointState {
    using Rows = typename Element::Rows;
    using Value = Number<Element::n_y, slopes>;
    using T = typename Value::type;
    const Element& element;
    const typename Element::Point& p;
    const V* stress_rows;  // ds / dy1
    const V* par;
    double h;
    bool moves;      // increments make velocities
    bool backwards;  // the books go the step from its end to its start, see Context

    PointState(const Element& e, const typename Element::Point& point, const V* rows)
        : element(e),
          p(point),
          stress_rows(rows),
          par(point.par),
          h(e.step.h),
          moves(!e.step.is_static()),
          backwards(e.v.backwards) {}

    VISVIVA_INLINE T s(int k) const { return Value::of(p.s[k], stress_rows + k * Element::n_y); }
    VISVIVA_INLINE T e(int k) const {
        T value = Value::of(p.et[k], nullptr);
        if constexpr (slopes)
            for (int i = Rows::sparse.first[k]; i < Rows::sparse.first[k + 1]; ++i) {
                const int j = Rows::sparse.entry[i].j;
                value.g[j] = element.share(Element::Map::group_of(j)) * p.Bt[i];
            }
        return value;
    }
    VISVIVA_INLINE T change(int k) const { return at_end(k, p.e0[k]); }
    VISVIVA_INLINE T at_end(int k, V less = V{}) const {
        T value = Value::of(p.e1[k] - less, nullptr);
        if constexpr (slopes)
            for (int i = Rows::sparse.first[k]; i < Rows::sparse.first[k + 1]; ++i)
                value.g[Rows::sparse.entry[i].j] = p.B1[i];
        return value;
    }
    /// Rate of the entropy k at a temperature, with what a step to the ends alone would lose of the energy:
    /// that becomes heat there. Of several entropies the first one takes it.
    VISVIVA_INLINE T warming(int k, const T& theta) const {
        if constexpr (requires { Element::Energy::n_entropies; })
            if (p.keeps_heat) {
                T excess = Value::of(p.excess, nullptr);
                if constexpr (slopes)
                    for (int m = 0; m < Element::n_m; ++m)
                        for (int i = Rows::sparse.first[m]; i < Rows::sparse.first[m + 1]; ++i)
                            excess.g[Rows::sparse.entry[i].j] += p.excess_by[m] * p.B1[i];
                return rate(k) + element.step.transport[0][0] * (excess / theta);
            }
        return rate(k);
    }
    VISVIVA_INLINE T rate(int k) const {
        V speed{};
        for (int i = Rows::sparse.first[k]; i < Rows::sparse.first[k + 1]; ++i)
            speed += p.Bt[i] * p.rate[Rows::sparse.entry[i].j];
        T value = Value::of(speed, nullptr);
        if constexpr (slopes) {
            for (int i = Rows::sparse.first[k]; i < Rows::sparse.first[k + 1]; ++i) {
                const int j = Rows::sparse.entry[i].j;
                value.g[j] = element.rate_factor(Element::Map::group_of(j)) * p.Bt[i];
            }
            for (int i = Rows::sparse.first_square[k]; i < Rows::sparse.first_square[k + 1]; ++i) {
                const auto& q = Rows::sparse.square[i];
                value.g[q.l] += (q.factor * element.share(Element::Map::group_of(q.l))) * p.rate[q.j];
            }
        }
        return value;
    }
};

/// Conservative: the gradient of the energy, f = s.
struct GradientPairing {
    static constexpr bool is_gradient = true;
};

}  // namespace visviva::VISVIVA_ISA
