// Solid elements in terms of rows B of the variation of Green's strain, dE = B du, one loop for all: a map
// says which strains the energy has beside C at a point (those behind the first six live elsewhere in the
// element), which unknowns beside the motion, and what these add. See solid_fbar.hpp and solid_pressure.hpp.
#pragma once
#include "visviva/material/mixed_energy.hpp"
#include "visviva/solid/solid_element.hpp"

namespace visviva::VISVIVA_ISA {

constexpr int mixed_max_unknowns = 3 * solid_common_nodes + solid_max_pressures;

/// What maps build on; what they add is nothing unless they say otherwise.
template <int D, int n>
struct SolidRows {
    static constexpr int dim = D, n_strains = n;
    const SolidElement<D, 0>& e;
    const SolidView& v;
    const int n_motion, n_unknowns;
    const bool ends;  // the state at theta alone decides
    V par[material_max_parameters];
    V Bt[n * mixed_max_unknowns], B1[n * mixed_max_unknowns];  // at theta, and of dS

    explicit SolidRows(const SolidElement<D, 0>& element)
        : e(element),
          v(element.v),
          n_motion(element.nodes() * D),
          n_unknowns(n_motion + v.n_pressures),
          ends(e.step.stress == Stress::at_theta) {
        for (int k = 0; k < v.n_par; ++k) par[k] = e.parameter(k);
    }

    V least_determinant() const { return broadcast(1e300); }
    void add_point_forces(int, const SolidPoint&, V*) const {}
    void add_point_moduli(int, const SolidPoint&, V*) {}
    void add_element_forces(const V*, V*) const {}  // of the stresses of the other strains
    void add_element_moduli(const V*, V*) const {}
    V element_energy() const { return V{}; }
    void add_field(int, const SolidPoint&, V*) const {}
    void strains(const SolidPoint& p, V* c0, V* ct, V* c1) const {
        for (int k = 0; k < 6; ++k) c0[k] = p.c0[k], ct[k] = p.ct[k], c1[k] = p.c1[k];
    }
    void feel(const SolidPoint&, V*, V*) const {}  // F and C - I that the material feels
    template <bool tangent>
    void add_to_user_stress(int, const SolidPoint&, V*, V*) const {}

    // B[k][a D + i]; pairs off the diagonal count twice
    static void rows(const SolidElement<D, 0>& at, int q, const V* F, V* B) {
        const int n_columns = at.nodes() * D;
        for (int a = 0; a < at.nodes(); ++a) {
            V g[3] = {};
            for (int l = 0; l < D; ++l) g[l] = vload(at.gradients(q) + (a * D + l) * at.stride);
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

    VISVIVA_INLINE void add_forces(const V* B, const V* S, V factor, V* r) const {
        for (int k = 0; k < 6; ++k) {
            const V s = factor * S[k];
            for (int j = 0; j < n_motion; ++j) r[j] += s * B[k * n_motion + j];
        }
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
                        sum += vload(G + (a * D + l) * at.stride) * S[voigt[l][m]] *
                               vload(G + (b * D + m) * at.stride);
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
        e.rate_gradient(p, X);
        for (int k = 0; k < 6; ++k) T[7 * k] = (k < 3 ? 2.0 : 1.0) * e.viscosity(2);
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) T[6 * k + l] += e.viscosity(1);
        rows(e, q, X, B1);
        add_moduli(Bt, B1, 6, T, e.volume(q), K);
    }
};

/// The loop over the points.
template <class Map>
struct SolidOfMap : Map {
    static constexpr int n = Map::n_strains;
    using Map::e, Map::v, Map::par, Map::Bt, Map::B1, Map::Map;

    // Stress at a point, and T = 2 dS/dC
    template <bool tangent>
    void stress(int q, const SolidPoint& p, V* S, V* T) const {
        if (v.kind == MaterialKind::user) {
            e.template user<tangent, n>(q, S, T);
            Map::template add_to_user_stress<tangent>(q, p, S, T);
        } else {
            V c0[n], ct[n], c1[n];
            Map::strains(p, c0, ct, c1);
            e.template stress_by<tangent>(Map::energy_at(q), e.step, c0, c1, ct, S, T);
        }
    }

    void forces(V* r) {
        V smallest = Map::least_determinant(), behind[6] = {};
        for (int k = 0; k < Map::n_unknowns; ++k) r[k] = V{};
        for (int q = 0; q < v.n_points; ++q) {
            SolidPoint p;
            V S[n], T[n * n];
            e.strains(q, p);
            stress<false>(q, p, S, T);
            Map::rows(e, q, p.Ft, Bt);
            for (int k = 6; k < n; ++k) behind[k - 6] += e.volume(q) * S[k];
            for (int k = 0; k < 6; ++k) p.S[k] = S[k];
            if (v.damped) e.viscous_stress(p);
            Map::add_forces(Bt, p.S, e.volume(q), r);
            smallest = select(p.det < smallest, p.det, smallest);
            Map::add_point_forces(q, p, r);
        }
        Map::add_element_forces(behind, r);
        e.finish(r, smallest);
    }

    void tangent(V* K) {
        V behind[6] = {};
        for (int k = 0; k < Map::n_unknowns * Map::n_unknowns; ++k) K[k] = V{};
        for (int q = 0; q < v.n_points; ++q) {
            SolidPoint p;
            V S[n], T[n * n];
            e.strains(q, p);
            stress<true>(q, p, S, T);
            Map::rows(e, q, p.Ft, Bt), Map::rows(e, q, Map::ends ? p.Ft : p.F1, B1);
            Map::add_moduli(Bt, B1, n, T, e.volume(q), K);
            for (int k = 6; k < n; ++k) behind[k - 6] += e.volume(q) * S[k];
            for (int k = 0; k < 6; ++k) p.S[k] = S[k];
            if (v.damped) Map::add_viscous(q, p, K);
            Map::add_geometric(e, q, p.S, e.volume(q), K);
            Map::add_point_moduli(q, p, K);
        }
        Map::add_element_moduli(behind, K);
        for (int a = 0; a < e.nodes(); ++a)
            for (int b = 0; b < e.nodes(); ++b)
                for (int i = 0; i < Map::dim; ++i)
                    K[(a * Map::dim + i) * Map::n_unknowns + b * Map::dim + i] += e.mass_factor(a, b);
    }

    V energy() const {
        V sum = Map::element_energy();
        for (int q = 0; q < v.n_points; ++q) {
            SolidPoint p;
            V F[9] = {}, c[6];
            e.strains(q, p);
            sum += e.volume(q) * response(q, p, F, c).W;
        }
        return sum;
    }

    // Of the material at the end to what it feels
    Response response(int q, const SolidPoint& p, V* F, V* c) const {
        Response r;
        for (int k = 0; k < 6; ++k) c[k] = p.c1[k];
        Map::feel(p, F, c);
        if (v.kind != MaterialKind::user) {
            e.material(q, par).template evaluate<false>(c, r);
            return r;
        }
        V S[n], T[n * n];  // by all strains, which is not the stress of F-bar; Python evaluates that
        e.template user<false, n>(q, S, T);
        r.W = e.user_energy(q);
        for (int k = 0; k < 6; ++k) r.s[k] = 0.5 * S[k];
        return r;
    }

    // Deformation gradient that the material feels, its stress, its energy: what is shown
    void field(int q, V* row) const {
        SolidPoint p;
        V c[6];
        e.strains(q, p);
        e.gradient(e.x1, q, 1.0, row);
        const Response r = response(q, p, row, c);
        for (int k = 0; k < 6; ++k) row[9 + k] = 2.0 * r.s[k];
        row[15] = r.W;
        Map::add_field(q, p, row);
    }
};

}  // namespace visviva::VISVIVA_ISA
