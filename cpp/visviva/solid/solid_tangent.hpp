// Tangents of solid elements and their forces, W at a time: K_ab = sum_q G_a A G_b + mass.
#pragma once
#include <algorithm>

#include "visviva/solid/solid_scatter.hpp"

namespace visviva::VISVIVA_ISA {

template <int D, int N>
struct SolidTangent : SolidBlocks<D, N> {
    using Blocks = SolidBlocks<D, N>;
    using Blocks::K;
    // Points at a time: their moduli and factors stay in the first cache. Nodes at a time that share the
    // moduli, and blocks beside each other that share the left factor; as many as the registers hold.
    static constexpr int points = 4, rows = 2, columns = W == 8 ? 2 : 1;
    static constexpr int factor = D * D * D;
    const SolidElement<D, N>& e;
    const bool symmetric;
    double *const forces, *const values;
    alignas(64) V A[points * 81];             // dP/dF of the points as [jN][iL], times the volume
    alignas(64) V T[rows * points * factor];  // G_a A of some nodes as [jN][i]
    alignas(64) V r[SolidElement<D, N>::max_nodes * D];
    V smallest = broadcast(1e300);

    VISVIVA_INLINE SolidTangent(const SolidElement<D, N>& element, bool half, double* to_forces,
                                double* to_values)
        : Blocks(element.nodes() * element.nodes() * D * D),
          e(element),
          symmetric(half),
          forces(to_forces),
          values(to_values) {
        for (int k = 0; k < e.nodes() * D; ++k) r[k] = V{};
        for (int first = 0; first < e.v.n_points; first += points)
            add_points(first, std::min(first + points, e.v.n_points));
        for (int a = 0; symmetric && a < e.nodes(); ++a) solid_scatter_row(e, a, K, true, values);
        if (!forces) return;
        e.finish(r, smallest);
        solid_scatter_forces(e, r, e.active(), forces);
    }

    VISVIVA_INLINE void add_points(int first, int end) {
        for (int q = first; q < end; ++q) {
            SolidPoint p;
            e.strains(q, p);
            e.template stress<true>(q, p);
            if (forces) e.add_forces(q, p, r, smallest);
            if (e.v.start_stress && e.step.stress == Stress::discrete_gradient) take_start_stress(q, p);
            moduli(p, e.volume(q), A + 81 * (q - first));
        }
        int a = 0;
        for (; a + rows <= e.nodes(); a += rows) add_rows<rows>(first, end, a);
        if (a < e.nodes()) add_rows<1>(first, end, a);
    }

    // A trial state of a thin solid holds stress that the next iteration takes away again; its geometric
    // stiffness would lead astray.
    VISVIVA_INLINE void take_start_stress(int q, SolidPoint& p) const {
        V par[material_max_parameters];
        for (int k = 0; k < e.v.n_par; ++k) par[k] = e.parameter(k);
        Response start;
        e.energy_at(q, par).template evaluate<false>(p.c0, start);
        for (int k = 0; k < 6; ++k) p.S[k] = 2.0 * start.s[k];
    }

    template <int n>
    VISVIVA_INLINE void add_rows(int first, int end, int a) {
        left<n>(first, end, a);
        for (int k = 0; k < n; ++k) {
            int b = symmetric ? a + k : 0;
            for (; b + columns <= e.nodes(); b += columns)
                blocks<columns>(first, end, a + k, b, T + k * factor);
            if (b < e.nodes()) blocks<1>(first, end, a + k, b, T + k * factor);
            if (!symmetric && end == e.v.n_points) solid_scatter_row(e, a + k, K, false, values);
        }
    }

    VISVIVA_INLINE void moduli(const SolidPoint& p, V factor, V* to) const {
        const V* F1 = e.step.stress == Stress::at_theta ? p.Ft : p.F1;
        VISVIVA_FLATTEN
        for (int i = 0; i < 3; ++i) VISVIVA_FLATTEN
        for (int l = 0; l < 3; ++l) {
            V Q[6];
            VISVIVA_FLATTEN
            for (int m = 0; m < 6; ++m)
                Q[m] = factor *
                       (p.Ft[3 * i] * p.T[6 * voigt[0][l] + m] + p.Ft[3 * i + 1] * p.T[6 * voigt[1][l] + m] +
                        p.Ft[3 * i + 2] * p.T[6 * voigt[2][l] + m]);
            VISVIVA_FLATTEN
            for (int j = 0; j < 3; ++j) VISVIVA_FLATTEN
            for (int n = 0; n < 3; ++n)
                to[(3 * j + n) * 9 + 3 * i + l] = Q[voigt[0][n]] * F1[3 * j] +
                                                  Q[voigt[1][n]] * F1[3 * j + 1] +
                                                  Q[voigt[2][n]] * F1[3 * j + 2];
        }
        if (e.v.damped) add_viscous_moduli(p, factor, to);
        if (e.v.small) return;
        const V scale = factor * e.step.theta;
        VISVIVA_FLATTEN
        for (int l = 0; l < 3; ++l) VISVIVA_FLATTEN
        for (int n = 0; n < 3; ++n) {
            const V s = scale * p.S[voigt[l][n]];
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) to[(3 * i + n) * 9 + 3 * i + l] += s;
        }
    }

    VISVIVA_INLINE void add_viscous_moduli(const SolidPoint& p, V factor, V* to) const {
        const V lambda = factor * e.viscosity(1), mu = factor * e.viscosity(2);
        V X[9];
        e.rate_gradient(p, X);
        for (int i = 0; i < 3; ++i)
            for (int l = 0; l < 3; ++l)
                for (int j = 0; j < 3; ++j)
                    for (int n = 0; n < 3; ++n) {
                        V sum = lambda * p.Ft[3 * i + l] * X[3 * j + n] + mu * p.Ft[3 * i + n] * X[3 * j + l];
                        for (int k = 0; l == n && k < 3; ++k) sum += mu * p.Ft[3 * i + k] * X[3 * j + k];
                        to[(3 * j + n) * 9 + 3 * i + l] += sum;
                    }
    }

    template <int n>
    VISVIVA_INLINE void left(int first, int end, int a) {
        for (int q = first; q < end; ++q) {
            const double* G = e.gradients(q) + a * D * e.stride;
            V g[n * D];
            VISVIVA_FLATTEN
            for (int l = 0; l < n * D; ++l) g[l] = vload(G + l * e.stride);
            const V* M = A + 81 * (q - first);
            V* t = T + (q - first) * rows * factor;
            VISVIVA_FLATTEN
            for (int j = 0; j < D; ++j) VISVIVA_FLATTEN
            for (int m = 0; m < D; ++m) VISVIVA_FLATTEN
            for (int i = 0; i < D; ++i) {
                const V* row = M + (3 * j + m) * 9 + 3 * i;
                V sum[n] = {};
                VISVIVA_FLATTEN
                for (int l = 0; l < D; ++l) {
                    const V modulus = row[l];
                    VISVIVA_FLATTEN
                    for (int k = 0; k < n; ++k) sum[k] += g[k * D + l] * modulus;
                }
                VISVIVA_FLATTEN
                for (int k = 0; k < n; ++k) t[k * factor + (j * D + m) * D + i] = sum[k];
            }
        }
    }

    // Blocks (a, b) to (a, b + n - 1): K[i][j] each
    template <int n>
    VISVIVA_INLINE void blocks(int first, int end, int a, int b, const V* t) {
        V *to = K + (a * e.nodes() + b) * D * D, sum[n * D * D];
        VISVIVA_FLATTEN
        for (int c = 0; c < n; ++c) {
            const V m = first == 0 ? e.mass_factor(a, b + c) : V{};
            VISVIVA_FLATTEN
            for (int k = c * D * D; k < (c + 1) * D * D; ++k)
                sum[k] = first > 0 ? to[k] : k % (D * D) % (D + 1) == 0 ? m : V{};
        }
        for (int q = first; q < end; ++q, t += rows * factor) {
            const double* G = e.gradients(q) + b * D * e.stride;
            V g[n * D];
            VISVIVA_FLATTEN
            for (int k = 0; k < n * D; ++k) g[k] = vload(G + k * e.stride);
            VISVIVA_FLATTEN
            for (int j = 0; j < D; ++j) VISVIVA_FLATTEN
            for (int m = 0; m < D; ++m) VISVIVA_FLATTEN
            for (int i = 0; i < D; ++i) {
                const V f = t[(j * D + m) * D + i];
                VISVIVA_FLATTEN
                for (int c = 0; c < n; ++c) sum[(c * D + i) * D + j] += g[c * D + m] * f;
            }
        }
        VISVIVA_FLATTEN
        for (int k = 0; k < n * D * D; ++k) to[k] = sum[k];
        for (int c = 0; D == 2 && e.v.H && c < n; ++c) add_hoop(first, end, a, b + c, to + c * D * D);
    }

    VISVIVA_INLINE void add_hoop(int first, int end, int a, int b, V* K) const {
        for (int q = first; q < end; ++q) {
            const V* M = A + 81 * (q - first);
            const double* G = e.gradients(q);
            const V ha = e.hoop(q, a), hb = e.hoop(q, b);
            K[0] += ha * hb * M[80];
            for (int j = 0; j < D; ++j)
                for (int n = 0; n < D; ++n) {
                    K[j] += ha * vload(G + (b * D + n) * e.stride) * M[(3 * j + n) * 9 + 8];
                    K[j * D] += vload(G + (a * D + n) * e.stride) * hb * M[8 * 9 + 3 * j + n];
                }
        }
    }
};

}  // namespace visviva::VISVIVA_ISA
