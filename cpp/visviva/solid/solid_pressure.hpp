// Mixed: C, and pressures as further unknowns that stand for the volumetric energy.
#pragma once
#include "visviva/solid/solid_pressures.hpp"
#include "visviva/solid/solid_rows.hpp"

namespace visviva::VISVIVA_ISA {

template <int D>
struct PressureMap : SolidRows<D, 6> {
    using Base = SolidRows<D, 6>;
    using Base::e, Base::v, Base::par, Base::Bt, Base::B1, Base::n_motion, Base::n_unknowns;
    const SolidPressures<D> p;

    explicit PressureMap(const SolidElement<D, 0>& element) : Base(element), p(element) {}
    VolumeEnergy measure() const {
        const auto kind = static_cast<VolumeMeasure>(v.measure);
        return {{}, kind, kind == VolumeMeasure::blatz_ko ? par[3] : V{}};
    }
    auto energy_at(int q) const {
        const MaterialEnergy rest{{}, v.kind, par};
        return e.heated(q, PressureEnergy<MaterialEnergy>{rest, measure(), p.at_point(q, p.acting)});
    }
    Response volume(int q, const SolidPoint& at) const {  // at the end
        Response g;
        e.heated(q, measure()).template evaluate<false>(at.c1, g);
        return g;
    }

    // A discrete gradient is linear in the energy, so that of p g(J) may be added.
    template <bool tangent>
    void add_to_user_stress(int q, const SolidPoint& at, V* S, V* T) const {
        V of_volume[6], change[36];
        e.template stress_by<tangent>(e.heated(q, measure()), e.step, at.c0, at.c1, at.ct, of_volume, change);
        const V pressure = p.at_point(q, p.acting);
        for (int k = 0; k < 6; ++k) S[k] += pressure * of_volume[k];
        for (int k = 0; tangent && k < 36; ++k) T[k] += pressure * change[k];
    }

    // The pressure's equations, of the end of the step: that g(J) is what the pressure compresses.
    void add_point_forces(int q, const SolidPoint& at, V* r) const {
        const V g = p.share * e.volume(q) * volume(q, at).W;
        for (int k = 0; k < v.n_pressures; ++k) r[n_motion + k] += p.shape(q, k) * g;
    }
    void add_element_forces(const V*, V* r) const {
        for (int k = 0; k < v.n_pressures; ++k) r[n_motion + k] -= p.share * p.compressed(k);
    }
    // Stress by the pressures, and change of volume at the end by the motion
    void add_point_moduli(int q, const SolidPoint& at, V* K) {
        V S[6], T[36];
        e.template stress_by<false>(e.heated(q, measure()), e.step, at.c0, at.c1, at.ct, S, T);
        const Response g = volume(q, at);
        Base::rows(e, q, at.F1, B1);
        for (int j = 0; j < n_motion; ++j) {
            V force{}, change{};
            for (int k = 0; k < 6; ++k) {
                force += S[k] * Bt[k * n_motion + j];
                change += 2.0 * g.s[k] * B1[k * n_motion + j];
            }
            for (int k = 0; k < v.n_pressures; ++k) {
                const V N = p.share * e.volume(q) * p.shape(q, k);
                K[j * n_unknowns + n_motion + k] += N * force;
                K[(n_motion + k) * n_unknowns + j] += N * change;
            }
        }
    }
    void add_element_moduli(const V*, V* K) const {
        for (int k = 0; k < v.n_pressures; ++k)
            for (int l = 0; l < v.n_pressures; ++l)
                K[(n_motion + k) * n_unknowns + n_motion + l] -= p.share * p.compliance(k, l);
    }
    V element_energy() const { return p.energy(); }
    void add_field(int q, const SolidPoint& at, V* row) const {
        const Response g = volume(q, at);
        const V pressure = p.at_point(q, p.end);
        for (int k = 0; k < 6; ++k) row[9 + k] += 2.0 * pressure * g.s[k];
        row[15] += 0.5 * pressure * g.W;
    }
};

}  // namespace visviva::VISVIVA_ISA
