// The pressures of a mixed element, W elements at a time, and the energy that they themselves hold.
#pragma once
#include "visviva/solid/solid_element.hpp"

namespace visviva::VISVIVA_ISA {

template <int D>
struct SolidPressures {
    const SolidElement<D, 0>& e;
    const SolidView& v;
    const double share;  // of the end in the pressure that acts: where it is no state, all
    V end[solid_max_pressures], acting[solid_max_pressures];

    explicit SolidPressures(const SolidElement<D, 0>& element)
        : e(element), v(e.v), share(v.multiplier ? 1.0 : e.step.theta) {
        for (int k = 0; k < v.n_pressures; ++k) {
            const V start = gather(e.x.x0, e.pressure_index(k));
            end[k] = gather(e.x.x1, e.pressure_index(k));
            acting[k] = start + share * (end[k] - start);
        }
    }
    VISVIVA_INLINE V shape(int q, int k) const {
        return vload(v.shape + (e.point(q) - e.lane) * v.n_pressures + k * L8 + e.lane);
    }
    V at_point(int q, const V* pressures) const {
        V p{};
        for (int k = 0; k < v.n_pressures; ++k) p += shape(q, k) * pressures[k];
        return p;
    }
    V compliance(int k, int l) const {
        const std::int64_t at = (static_cast<std::int64_t>(e.block) * v.n_pressures + k) * v.n_pressures + l;
        return vload(v.compliance + at * L8 + e.lane);
    }
    /// The change of volume that the pressure at the end leaves, of pressure k.
    V compressed(int k) const {
        V sum{};
        for (int l = 0; l < v.n_pressures; ++l) sum += compliance(k, l) * end[l];
        return sum;
    }
    V energy() const {
        V sum{};
        for (int k = 0; k < v.n_pressures; ++k) sum += 0.5 * end[k] * compressed(k);
        return sum;
    }
};

}  // namespace visviva::VISVIVA_ISA
