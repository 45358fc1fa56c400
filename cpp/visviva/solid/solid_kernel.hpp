// Residual, tangent and ledger of batches of solid elements.
#pragma once
#include "visviva/solid/solid_scatter.hpp"
#include "visviva/solid/solid_spatial.hpp"
#include "visviva/solid/solid_tangent.hpp"

namespace visviva::VISVIVA_ISA {

template <int D, int N, class F>
void each_element_of(const SolidView& v, const Step& step, const Vectors& x, int begin, int end, F&& work) {
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < L8; lane += W) work(SolidElement<D, N>(v, step, x, block, lane));
}

// Calls work(element) for W elements at a time, fillers of the last block included.
template <class F>
void each_element(const SolidView& v, const Step& step, const Vectors& x, int begin, int end, F&& work) {
    if (v.dim == 2) return each_element_of<2, 0>(v, step, x, begin, end, work);
    if (v.X) return each_element_of<3, 8>(v, step, x, begin, end, work);
    if (v.n_nodes == 4) return each_element_of<3, 4>(v, step, x, begin, end, work);
    return each_element_of<3, 0>(v, step, x, begin, end, work);
}

void solid_residual(const SolidView& v, const Step& step, const Vectors& x, int begin, int end, double* r) {
    each_element(v, step, x, begin, end, [r]<int D, int N>(const SolidElement<D, N>& e) {
        V f[e.max_nodes * D];
        e.forces(f);
        solid_scatter_forces(e, f, e.active(), r);
    });
}

// Adds the residual as well unless r is null.
void solid_tangent(const SolidView& v, const Step& step, const Vectors& x, int begin, int end, double* r,
                   double* values) {
    const bool symmetric = step.stress == Stress::at_theta && !v.damped;
    const bool spatial = symmetric && traits(v.kind).isotropic && !v.thermal;
    each_element(v, step, x, begin, end, [=, &v]<int D, int N>(const SolidElement<D, N>& e) {
        if constexpr (D == 3)
            if (spatial) {
                if (traits(v.kind).plain)
                    SpatialTangent<N, true>(e, r, values);
                else
                    SpatialTangent<N, false>(e, r, values);
                return;
            }
        SolidTangent<D, N>(e, symmetric, r, values);
    });
}

// Adds what a node moves, times its share of mass, and the force by which that is damped.
template <int D, int N>
VISVIVA_INLINE void add_momentum(const SolidElement<D, N>& e, const double* v1, bool by_mean, V mass, int b,
                                 V* momentum, V* damping) {
    for (int c = 0; c < D; ++c) {
        momentum[c] += mass * e.at(v1, b, c);
        if (!e.v.damped) continue;
        const V mean = (e.x1[b * D + c] - e.x0[b * D + c]) / e.step.h;
        damping[c] += e.viscosity(0) * mass * (by_mean ? mean : e.at(e.x.rate, b, c));
    }
}

// Energies, work of damping and momenta of W elements.
template <int D, int N>
VISVIVA_INLINE void solid_ledger_rows_of(const SolidElement<D, N>& e, const double* v1, V* row) {
    const SolidView& v = e.v;
    const bool by_mean = e.step.remembers();
    for (int k = 0; k < solid_ledger_rows; ++k) row[k] = V{};
    V par[material_max_parameters];
    for (int k = 0; k < v.n_par; ++k) par[k] = e.parameter(k);
    for (int q = 0; q < v.n_points; ++q) {
        SolidPoint p;
        e.strains(q, p);
        row[0] += e.volume(q) * e.energy(q, p.c1, par);
        if (!v.damped) continue;
        V F[9], F0[9], P[9];
        e.gradient(e.x1, q, 1.0, F);
        e.gradient(e.x0, q, 1.0, F0);
        for (int k = 0; by_mean && k < 9; ++k) {
            p.rate[k] = (F[k] - F0[k]) / e.step.h;
            if (!v.small) p.Ft[k] = 0.5 * (F0[k] + F[k]);
        }
        e.viscous_stress(p);
        e.piola(p.Ft, p.viscous, e.volume(q), P);
        for (int k = 0; k < 9; ++k) row[2] -= P[k] * (F[k] - F0[k]);
    }
    for (int a = 0; v.has_mass && a < e.nodes(); ++a) {
        V p[3] = {}, damping[3] = {}, place[3] = {};
        for (int c = 0; c < D; ++c) place[c] = e.x1[a * D + c];
        for (int b = 0; b < e.nodes(); ++b) add_momentum(e, v1, by_mean, e.mass(a, b), b, p, damping);
        for (int c = 0; c < D; ++c) {
            row[1] += 0.5 * e.at(v1, a, c) * p[c];
            row[2] -= damping[c] * (e.x1[a * D + c] - e.x0[a * D + c]);
            row[3 + c] += p[c];
        }
        row[6] += place[1] * p[2] - place[2] * p[1];
        row[7] += place[2] * p[0] - place[0] * p[2];
        row[8] += place[0] * p[1] - place[1] * p[0];
    }
}

// out [solid_ledger_rows][block - begin][8]; see solid.hpp.
void solid_ledger(const SolidView& v, const Step& step, const Vectors& x, const double* v1, int begin,
                  int end, double* out) {
    const std::int64_t stride = static_cast<std::int64_t>(end - begin) * L8;
    each_element(v, step, x, begin, end, [=]<int D, int N>(const SolidElement<D, N>& e) {
        V row[solid_ledger_rows];
        solid_ledger_rows_of(e, v1, row);
        for (int k = 0; k < solid_ledger_rows; ++k)
            vstore(out + k * stride + (e.block - begin) * L8 + e.lane, row[k]);
    });
}

// C at the start, theta and end of all points for laws outside the core: arrays [6][block][point][8].
void solid_strains(const SolidView& v, const Step& step, const Vectors& x, double* c0, double* ct,
                   double* c1) {
    const std::int64_t stride = static_cast<std::int64_t>(v.n_blocks) * v.n_points * L8;
    each_element(v, step, x, 0, v.n_blocks, [=]<int D, int N>(const SolidElement<D, N>& e) {
        for (int q = 0; q < e.v.n_points; ++q) {
            V F0[9], F1[9], Ft[9], c[6];
            auto put = [&](const V* F, double* to) {
                e.strain(F, c);
                if (e.v.thermal) strain_beyond(e.thermal(q), e.v.small, c, c);
                for (int k = 0; k < 6; ++k) vstore(to + k * stride + e.point(q), k < 3 ? 1.0 + c[k] : c[k]);
            };
            e.gradient(e.x0, q, 1.0, F0), e.gradient(e.x1, q, 1.0, F1);
            for (int k = 0; k < 9; ++k) Ft[k] = F0[k] + e.step.theta * (F1[k] - F0[k]);
            put(F0, c0), put(Ft, ct), put(F1, c1);
        }
    });
}

// Deformation gradient (9), second Piola-Kirchhoff stress (6) and energy at the points of elements, from the
// end of the step: out [element - 8 begin][point][16].
void solid_fields(const SolidView& v, const Step& step, const Vectors& x, int begin, int end, double* out) {
    each_element(v, step, x, begin, end, [=]<int D, int N>(const SolidElement<D, N>& e) {
        V par[material_max_parameters];
        for (int k = 0; k < e.v.n_par; ++k) par[k] = e.parameter(k);
        for (int q = 0; q < e.v.n_points; ++q) {
            SolidPoint p;
            V row[solid_field_rows];
            e.strains(q, p);
            e.template stress<false>(q, p);
            e.gradient(e.x1, q, 1.0, row);
            if (D == 2 && e.v.plane_stress) row[8] = e.across(q, p.c1, par);
            for (int k = 0; k < 6; ++k) row[9 + k] = p.S[k];
            row[15] = e.energy(q, p.c1, par);
            put_rows(row, solid_field_rows, (e.block - begin) * L8 + e.lane, e.v.n_points * solid_field_rows,
                     q * solid_field_rows, e.active(), out);
        }
    });
}

// Forces of the elements on their nodes: out [element - 8 begin][node][dim].
void solid_forces(const SolidView& v, const Step& step, const Vectors& x, int begin, int end, double* out) {
    each_element(v, step, x, begin, end, [=]<int D, int N>(const SolidElement<D, N>& e) {
        V f[e.max_nodes * D];
        e.forces(f);
        const int size = e.nodes() * D;
        put_rows(f, size, (e.block - begin) * L8 + e.lane, size, 0, e.active(), out);
    });
}

// Energy, its gradient and second gradient by C of one material: c = C - I (n, 6), out (n, 28).
void material_response(MaterialKind kind, const double* par, int n_par, int n, const double* c, double* out) {
    V p[material_max_parameters], strain[6];
    for (int k = 0; k < n_par; ++k) p[k] = broadcast(par[k]);
    for (int i = 0; i < n; i += W) {
        Response r;
        for (int k = 0; k < 6; ++k)
            for (int l = 0; l < W; ++l) strain[k][l] = c[(i + l < n ? i + l : n - 1) * 6 + k];
        respond<true>(kind, strain, p, r);
        for (int l = 0; l < W && i + l < n; ++l) {
            double* to = out + (i + l) * 28;
            to[0] = r.W[l];
            for (int k = 0; k < 6; ++k) to[1 + k] = r.s[k][l];
            for (int k = 0; k < 21; ++k) to[7 + k] = r.d[k][l];
        }
    }
}

}  // namespace visviva::VISVIVA_ISA
