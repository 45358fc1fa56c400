// F-bar: twelve strains, C at the point and C at the element's centre; no further unknowns.
#pragma once
#include "visviva/solid/solid_rows.hpp"

namespace visviva::VISVIVA_ISA {

template <int D>
struct FbarMap : SolidRows<D, 12> {
    using Base = SolidRows<D, 12>;
    using Base::e, Base::v, Base::par, Base::Bt, Base::B1, Base::n_motion, Base::ends;
    const SolidView view;                // the elements with gradients at their centres alone
    const SolidElement<D, 0> at_centre;  // this one
    SolidPoint centre;

    explicit FbarMap(const SolidElement<D, 0>& element)
        : Base(element), view(of_centre(v)), at_centre(view, e.step, e.x, e.block, e.lane) {
        at_centre.strains(0, centre);
        Base::rows(at_centre, 0, centre.Ft, Bt + 6 * n_motion);
        Base::rows(at_centre, 0, ends ? centre.Ft : centre.F1, B1 + 6 * n_motion);
    }
    static SolidView of_centre(const SolidView& v) {
        SolidView c = v;
        c.n_points = 1, c.G = v.centre_G, c.H = v.centre_H, c.damped = false;
        return c;
    }

    void strains(const SolidPoint& p, V* c0, V* ct, V* c1) const {
        for (int k = 0; k < 12; ++k) {
            const SolidPoint& from = k < 6 ? p : centre;
            c0[k] = from.c0[k % 6], ct[k] = from.ct[k % 6], c1[k] = from.c1[k % 6];
        }
    }
    auto energy_at(int q) const {
        return FbarEnergy<Stretched<MaterialEnergy>>{{}, e.material(q, par), v.small, D == 2 && !v.H ? 2 : 3};
    }

    V least_determinant() const { return centre.det; }
    void add_element_forces(const V* S, V* r) const {
        Base::add_forces(Bt + 6 * n_motion, S, broadcast(1.0), r);
    }
    void add_element_moduli(const V* S, V* K) const {
        Base::add_geometric(at_centre, 0, S, broadcast(1.0), K);
    }

    // Fbar and Cbar - I
    void feel(const SolidPoint& p, V* F, V* bar) const {
        const auto energy = energy_at(0);
        V c0[12], ct[12], c[12];
        strains(p, c0, ct, c);
        energy.strain(c, bar);
        const V factor = v.small ? broadcast(1.0) : vsqrt((1.0 + bar[0]) / (1.0 + c[0]));
        for (int k = 0; k < (energy.directions == 3 ? 9 : 8); ++k) F[k] *= factor;
        for (int k = 0; v.small && k < 3; ++k) F[4 * k] += 0.5 * (bar[k] - c[k]);
    }
};

}  // namespace visviva::VISVIVA_ISA
