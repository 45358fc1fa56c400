// Solid elements whose energy depends on more than C at a point: on C at the element's centre (F-bar), or on
// a pressure (mixed). All in terms of rows B of the variation of Green's strain, dE = B du.
#pragma once
#include "visviva/material/discrete_gradient.hpp"
#include "visviva/material/mixed_energy.hpp"
#include "visviva/solid/solid_element.hpp"

namespace visviva::VISVIVA_ISA {

constexpr int mixed_max_unknowns = 3 * solid_max_nodes + solid_max_pressures;

template <int D, bool fbar>
struct MixedElement {
    static constexpr int n = fbar ? 12 : 6;  // strains
    const SolidElement<D, 0>& e;
    const SolidElement<D, 0>& at_centre;  // the same element with gradients at its centre alone
    const SolidView& v;
    const int n_motion, n_unknowns;
    const bool ends;  // the state at theta alone decides
    V par[material_max_parameters], pressure[solid_max_pressures];
    SolidPoint centre;
    V Bt[n * mixed_max_unknowns], B1[n * mixed_max_unknowns];  // at theta, and of dS

    MixedElement(const SolidElement<D, 0>& element, const SolidElement<D, 0>& middle)
        : e(element),
          at_centre(middle),
          v(element.v),
          n_motion(element.nodes() * D),
          n_unknowns(n_motion + v.n_pressures),
          ends(e.step.stress == Stress::at_theta) {
        for (int k = 0; k < v.n_par; ++k) par[k] = e.parameter(k);
        for (int k = 0; k < v.n_pressures; ++k) {
            const V p0 = gather(e.x.x0, pressure_index(k)), p1 = end_pressure(k);
            pressure[k] = p0 + share() * (p1 - p0);
        }
        if constexpr (!fbar) return;
        at_centre.strains(0, centre);
        rows(at_centre, 0, centre.Ft, Bt + 6 * n_motion);
        rows(at_centre, 0, ends ? centre.Ft : centre.F1, B1 + 6 * n_motion);
    }

    /// Share of the end in the pressure that acts: where the pressure is no state, all.
    VISVIVA_INLINE double share() const { return v.multiplier ? 1.0 : e.step.theta; }
    VISVIVA_INLINE const int* pressure_index(int k) const {
        return v.pressure_index + (e.block * v.n_pressures + k) * L8 + e.lane;
    }
    VISVIVA_INLINE V end_pressure(int k) const { return gather(e.x.x1, pressure_index(k)); }
    VISVIVA_INLINE V shape(int q, int k) const {
        return vload(v.shape +
                     ((static_cast<std::int64_t>(e.block) * v.n_points + q) * v.n_pressures + k) * L8 +
                     e.lane);
    }
    VISVIVA_INLINE V compliance(int k, int l) const {
        const std::int64_t at = (static_cast<std::int64_t>(e.block) * v.n_pressures + k) * v.n_pressures + l;
        return vload(v.compliance + at * L8 + e.lane);
    }
    VISVIVA_INLINE VolumeEnergy volume_energy() const {
        const auto measure = static_cast<VolumeMeasure>(v.measure);
        return {{}, measure, measure == VolumeMeasure::blatz_ko ? par[3] : V{}};
    }
    VISVIVA_INLINE FbarEnergy fbar_energy() const {
        return {{}, v.kind, v.small, D == 2 && !v.H ? 2 : 3, par};
    }
    VISVIVA_INLINE V acting_pressure(int q) const {
        V p{};
        for (int k = 0; k < v.n_pressures; ++k) p += shape(q, k) * pressure[k];
        return p;
    }
    VISVIVA_INLINE PressureEnergy pressure_energy(int q) const {
        return {{}, v.kind, par, volume_energy(), acting_pressure(q)};
    }

    // B[k][a D + i]; pairs off the diagonal count twice
    static void rows(const SolidElement<D, 0>& at, int q, const V* F, V* B) {
        const int n_columns = at.nodes() * D;
        for (int a = 0; a < at.nodes(); ++a) {
            V g[3] = {};
            for (int l = 0; l < D; ++l) g[l] = vload(at.gradients(q) + (a * D + l) * L8);
            for (int i = 0; i < D; ++i)
                for (int k = 0; k < 6; ++k) {
                    const int l = voigt_a[k], m = voigt_b[k];
                    V sum = F[3 * i + l] * g[m];
                    if (k > 2) sum += F[3 * i + m] * g[l];
                    B[k * n_columns + a * D + i] = sum;
                }
            if (D == 2 && at.v.H) B[2 * n_columns + a * D] = F[8] * at.hoop(q, a);
        }
    }

    // S = 2 dW/dC, and T = 2 dS/dC1
    template <bool tangent, class Energy>
    void stress_by(const Energy& energy, const V* c0, const V* c1, const V* ct, V* S, V* T) const {
        stress_of<tangent>(energy, e.step, c0, c1, ct, S, T);
        for (int k = 0; k < Energy::n; ++k) S[k] *= 2.0;
        const double factor = e.step.stress == Stress::at_theta ? 4 * e.step.theta : 4;
        for (int k = 0; tangent && k < Energy::n * Energy::n; ++k) T[k] *= factor;
    }

    // Stress at a point, and T = 2 dS/dC
    template <bool tangent>
    void stress(int q, const SolidPoint& p, V* S, V* T) const {
        if (v.kind == MaterialKind::user) {
            user_stress<tangent>(q, p, S, T);
        } else if constexpr (fbar) {
            V c0[12], ct[12], c1[12];
            for (int k = 0; k < 12; ++k) {
                const SolidPoint& from = k < 6 ? p : centre;
                c0[k] = from.c0[k % 6], ct[k] = from.ct[k % 6], c1[k] = from.c1[k % 6];
            }
            stress_by<tangent>(fbar_energy(), c0, c1, ct, S, T);
        } else {
            stress_by<tangent>(pressure_energy(q), p.c0, p.c1, p.ct, S, T);
        }
    }

    // Of a function of the user, whose derivatives by components count an off-diagonal pair once. A discrete
    // gradient is linear in the energy, so that of p g(J) may be added.
    template <bool tangent>
    void user_stress(int q, const SolidPoint& p, V* S, V* T) const {
        const std::int64_t at = e.point(q), stride = static_cast<std::int64_t>(v.n_blocks) * v.n_points * L8;
        const double factor = e.step.stress == Stress::at_theta ? 4 * e.step.theta : 4;
        V of_volume[6], change[36], acting{};
        if constexpr (!fbar) {
            acting = acting_pressure(q);
            stress_by<tangent>(volume_energy(), p.c0, p.c1, p.ct, of_volume, change);
        }
        for (int k = 0; k < n; ++k) {
            S[k] = (2.0 / tensor_weight(k)) * vload(v.user_S + k * stride + at);
            if constexpr (!fbar) S[k] += acting * of_volume[k];
            for (int l = 0; tangent && l < n; ++l) {
                const double share = 1.0 / (tensor_weight(k) * tensor_weight(l));
                T[n * k + l] = factor * share * vload(v.user_D + (n * k + l) * stride + at);
                if constexpr (!fbar) T[n * k + l] += acting * change[6 * k + l];
            }
        }
    }

    void forces(V* r) {
        V smallest = centre_determinant(), S0[6] = {};
        for (int k = 0; k < n_unknowns; ++k) r[k] = V{};
        for (int q = 0; q < v.n_points; ++q) {
            SolidPoint p;
            V S[n], T[n * n];
            e.strains(q, p);
            stress<false>(q, p, S, T);
            rows(e, q, p.Ft, Bt);
            for (int k = 0; fbar && k < 6; ++k) S0[k] += e.volume(q) * S[6 + k];
            for (int k = 0; k < 6; ++k) p.S[k] = S[k];
            if (v.damped) e.viscous_stress(p);
            add_forces(Bt, p.S, e.volume(q), r);
            smallest = select(p.det < smallest, p.det, smallest);
            if constexpr (!fbar) add_volume_change(q, p, r);
        }
        if constexpr (fbar) add_forces(Bt + 6 * n_motion, S0, broadcast(1.0), r);
        for (int k = 0; k < v.n_pressures; ++k)
            for (int l = 0; l < v.n_pressures; ++l)
                r[n_motion + k] -= share() * compliance(k, l) * end_pressure(l);
        vstore(v.smallest + e.block * L8 + e.lane, smallest);
        if (v.mass) e.inertia(r);
    }

    VISVIVA_INLINE V centre_determinant() const {
        if constexpr (fbar) return centre.det;
        return broadcast(1e300);
    }

    VISVIVA_INLINE void add_forces(const V* B, const V* S, V factor, V* r) const {
        for (int k = 0; k < 6; ++k) {
            const V s = factor * S[k];
            for (int j = 0; j < n_motion; ++j) r[j] += s * B[k * n_motion + j];
        }
    }

    // The pressure's equations, of the end of the step: that g(J) is what the pressure compresses.
    VISVIVA_INLINE void add_volume_change(int q, const SolidPoint& p, V* r) const {
        Response g;
        volume_energy().template evaluate<false>(p.c1, g);
        for (int k = 0; k < v.n_pressures; ++k) r[n_motion + k] += share() * e.volume(q) * shape(q, k) * g.W;
    }

    void tangent(V* K) {
        V S0[6] = {};
        for (int k = 0; k < n_unknowns * n_unknowns; ++k) K[k] = V{};
        for (int q = 0; q < v.n_points; ++q) {
            SolidPoint p;
            V S[n], T[n * n];
            e.strains(q, p);
            stress<true>(q, p, S, T);
            rows(e, q, p.Ft, Bt), rows(e, q, ends ? p.Ft : p.F1, B1);
            add_moduli(Bt, B1, n, T, e.volume(q), K);
            for (int k = 0; fbar && k < 6; ++k) S0[k] += e.volume(q) * S[6 + k];
            for (int k = 0; k < 6; ++k) p.S[k] = S[k];
            if (v.damped) add_viscous(q, p, K);
            add_geometric(e, q, p.S, e.volume(q), K);
            if constexpr (!fbar) add_pressure(q, p, K);
        }
        if constexpr (fbar) add_geometric(at_centre, 0, S0, broadcast(1.0), K);
        for (int k = 0; k < v.n_pressures; ++k)
            for (int l = 0; l < v.n_pressures; ++l)
                K[(n_motion + k) * n_unknowns + n_motion + l] -= share() * compliance(k, l);
        for (int a = 0; a < e.nodes(); ++a)
            for (int b = 0; b < e.nodes(); ++b)
                for (int i = 0; i < D; ++i) K[(a * D + i) * n_unknowns + b * D + i] += e.mass_factor(a, b);
    }

    // K += factor left^T T right
    void add_moduli(const V* left, const V* right, int n_rows, const V* T, V factor, V* K) const {
        for (int k = 0; k < n_rows; ++k) {
            V X[mixed_max_unknowns];
            for (int j = 0; j < n_motion; ++j) X[j] = V{};
            for (int l = 0; l < n_rows; ++l) {
                const V t = factor * T[n_rows * k + l];
                for (int j = 0; j < n_motion; ++j) X[j] += t * right[l * n_motion + j];
            }
            for (int i = 0; i < n_motion; ++i)
                for (int j = 0; j < n_motion; ++j) K[i * n_unknowns + j] += left[k * n_motion + i] * X[j];
        }
    }

    void add_geometric(const SolidElement<D, 0>& at, int q, const V* S, V factor, V* K) const {
        if (v.small) return;
        const double* G = at.gradients(q);
        for (int a = 0; a < e.nodes(); ++a)
            for (int b = 0; b < e.nodes(); ++b) {
                V sum{};
                for (int l = 0; l < D; ++l)
                    for (int m = 0; m < D; ++m)
                        sum += vload(G + (a * D + l) * L8) * S[voigt[l][m]] * vload(G + (b * D + m) * L8);
                sum *= factor * e.step.theta;
                for (int i = 0; i < D; ++i) K[(a * D + i) * n_unknowns + b * D + i] += sum;
                if (D == 2 && v.H)
                    K[a * D * n_unknowns + b * D] +=
                        factor * e.step.theta * S[2] * at.hoop(q, a) * at.hoop(q, b);
            }
    }

    void add_viscous(int q, SolidPoint& p, V* K) {
        e.viscous_stress(p);
        V X[9], T[36] = {};
        for (int k = 0; k < 9; ++k)
            X[k] = e.step.motion[0][0] * p.Ft[k] + (v.small ? V{} : e.step.theta * p.rate[k]);
        for (int k = 0; k < 6; ++k) T[7 * k] = (k < 3 ? 2.0 : 1.0) * e.viscosity(2);
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) T[6 * k + l] += e.viscosity(1);
        rows(e, q, X, B1);
        add_moduli(Bt, B1, 6, T, e.volume(q), K);
    }

    // Stress by the pressures, and change of volume at the end by the motion
    void add_pressure(int q, const SolidPoint& p, V* K) {
        V S[6], T[36];
        Response g;
        stress_by<false>(volume_energy(), p.c0, p.c1, p.ct, S, T);
        volume_energy().template evaluate<false>(p.c1, g);
        rows(e, q, p.F1, B1);
        const V factor = share() * e.volume(q);
        for (int j = 0; j < n_motion; ++j) {
            V force{}, change{};
            for (int k = 0; k < 6; ++k) {
                force += S[k] * Bt[k * n_motion + j];
                change += 2.0 * g.s[k] * B1[k * n_motion + j];
            }
            for (int k = 0; k < v.n_pressures; ++k) {
                const V N = factor * shape(q, k);
                K[j * n_unknowns + n_motion + k] += N * force;
                K[(n_motion + k) * n_unknowns + j] += N * change;
            }
        }
    }

    V energy() const {
        V sum{};
        for (int q = 0; q < v.n_points; ++q) {
            SolidPoint p;
            e.strains(q, p);
            sum += e.volume(q) * density(q, p);
        }
        for (int k = 0; k < v.n_pressures; ++k)
            for (int l = 0; l < v.n_pressures; ++l)
                sum += 0.5 * end_pressure(k) * compliance(k, l) * end_pressure(l);
        return sum;
    }

    // Energy at the end per reference volume, without that of the pressure
    V density(int q, const SolidPoint& p) const {
        if (v.kind == MaterialKind::user) return vload(v.user_W + e.point(q));
        Response r;
        V F[9] = {}, bar[6];
        for (int k = 0; k < 6; ++k) bar[k] = p.c1[k];
        if constexpr (fbar) scale(p, F, bar);
        respond<false>(v.kind, bar, par, r);
        return r.W;
    }

    // Deformation gradient that the material feels, its stress, its energy: what is shown
    void field(int q, V* row) const {
        SolidPoint p;
        V bar[6];
        e.strains(q, p);
        e.gradient(e.x1, q, 1.0, row);
        for (int k = 0; k < 6; ++k) bar[k] = p.c1[k];
        if constexpr (fbar) scale(p, row, bar);
        Response r;
        if (v.kind == MaterialKind::user)  // F-bar: by both tensors, not the stress; Python evaluates it
            e.template user<false>(q, p), r.W = vload(v.user_W + e.point(q));
        else
            respond<false>(v.kind, bar, par, r);
        for (int k = 0; v.kind == MaterialKind::user && k < 6; ++k) r.s[k] = 0.5 * p.S[k];
        for (int k = 0; k < 6; ++k) row[9 + k] = 2.0 * r.s[k];
        row[15] = r.W;
        if constexpr (!fbar) add_pressure_field(q, p, row);
    }

    // Fbar and Cbar - I
    void scale(const SolidPoint& p, V* F, V* bar) const {
        const FbarEnergy energy = fbar_energy();
        V c[12];
        for (int k = 0; k < 12; ++k) c[k] = k < 6 ? p.c1[k] : centre.c1[k - 6];
        energy.strain(c, bar);
        const V factor = v.small ? broadcast(1.0) : vsqrt((1.0 + bar[0]) / (1.0 + c[0]));
        for (int k = 0; k < (energy.directions == 3 ? 9 : 8); ++k) F[k] *= factor;
        for (int k = 0; v.small && k < 3; ++k) F[4 * k] += 0.5 * (bar[k] - c[k]);
    }

    void add_pressure_field(int q, const SolidPoint& p, V* row) const {
        Response g;
        V acting{};
        volume_energy().template evaluate<false>(p.c1, g);
        for (int k = 0; k < v.n_pressures; ++k) acting += shape(q, k) * end_pressure(k);
        for (int k = 0; k < 6; ++k) row[9 + k] += 2.0 * acting * g.s[k];
        row[15] += 0.5 * acting * g.W;
    }
};

}  // namespace visviva::VISVIVA_ISA
