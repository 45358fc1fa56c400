// Tangents of solid elements, W at a time: K_ab = sum_q G_a A G_b + mass.
#pragma once
#include <algorithm>

#include "solid_element.hpp"

namespace visviva::VISVIVA_ISA {

template <int D, int N>
struct SolidTangent {
    const SolidElement<D, N>& e;
    alignas(64) V A[tangent_points * 81];         // dP/dF of the points as [jN][iL], times the volume
    alignas(64) V T[tangent_points * D * D * D];  // G_a A of one node as [jN][i]
    alignas(64) V K[(N > 0 ? N * N : solid_max_nodes * solid_max_nodes) * D * D];

    VISVIVA_INLINE SolidTangent(const SolidElement<D, N>& element, bool symmetric) : e(element) {
        for (int first = 0; first < e.v.n_points; first += tangent_points)
            add_points(first, std::min(first + tangent_points, e.v.n_points), symmetric);
    }
    VISVIVA_INLINE V* block(int a, int b) { return K + (a * e.nodes() + b) * D * D; }

    void add_points(int first, int end, bool symmetric) {
        for (int q = first; q < end; ++q) {
            SolidPoint p;
            e.strains(q, p);
            e.template stress<true>(q, p);
            moduli(p, e.volume(q), A + 81 * (q - first));
        }
        for (int a = 0; a < e.nodes(); ++a) {
            left(first, end, a);
            int b = symmetric ? a : 0;
            for (; b + tangent_columns <= e.nodes(); b += tangent_columns)
                blocks<tangent_columns>(first, end, a, b);
            if (b < e.nodes()) blocks<1>(first, end, a, b);
        }
    }

    VISVIVA_INLINE void moduli(const SolidPoint& p, V factor, V* to) const {
        const V* F1 = e.step.stress == Stress::at_theta || e.v.symmetric ? p.Ft : p.F1;
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
        V X[9];  // derivative of the strain rate: sym(X^T dF)
        for (int k = 0; k < 9; ++k)
            X[k] =
                e.step.motion[0][0] * p.Ft[k] + (e.v.small || e.v.symmetric ? V{} : e.step.theta * p.rate[k]);
        for (int i = 0; i < 3; ++i)
            for (int l = 0; l < 3; ++l)
                for (int j = 0; j < 3; ++j)
                    for (int n = 0; n < 3; ++n) {
                        V sum = lambda * p.Ft[3 * i + l] * X[3 * j + n] + mu * p.Ft[3 * i + n] * X[3 * j + l];
                        for (int k = 0; l == n && k < 3; ++k) sum += mu * p.Ft[3 * i + k] * X[3 * j + k];
                        to[(3 * j + n) * 9 + 3 * i + l] += sum;
                    }
    }

    VISVIVA_INLINE void left(int first, int end, int a) {
        for (int q = first; q < end; ++q) {
            const double* G = e.gradients(q) + a * D * L8;
            V g[D];
            for (int l = 0; l < D; ++l) g[l] = vload(G + l * L8);
            const V* M = A + 81 * (q - first);
            V* t = T + (q - first) * D * D * D;
            VISVIVA_FLATTEN
            for (int j = 0; j < D; ++j) VISVIVA_FLATTEN
            for (int n = 0; n < D; ++n) VISVIVA_FLATTEN
            for (int i = 0; i < D; ++i) {
                const V* m = M + (3 * j + n) * 9 + 3 * i;
                V sum = g[0] * m[0];
                VISVIVA_FLATTEN
                for (int l = 1; l < D; ++l) sum += g[l] * m[l];
                t[(j * D + n) * D + i] = sum;
            }
        }
    }

    // Blocks (a, b) to (a, b + columns - 1): K[i][j] each
    template <int columns>
    VISVIVA_INLINE void blocks(int first, int end, int a, int b) {
        V* to = block(a, b);
        V sum[columns * D * D];
        if (first == 0) {
            VISVIVA_FLATTEN
            for (int c = 0; c < columns; ++c) {
                const V m = e.mass_factor(a, b + c);
                VISVIVA_FLATTEN
                for (int k = 0; k < D * D; ++k) sum[c * D * D + k] = k % (D + 1) == 0 ? m : V{};
            }
        } else {
            VISVIVA_FLATTEN
            for (int k = 0; k < columns * D * D; ++k) sum[k] = to[k];
        }
        for (int q = first; q < end; ++q) {
            const double* G = e.gradients(q) + b * D * L8;
            const V* t = T + (q - first) * D * D * D;
            V g[columns * D];
            VISVIVA_FLATTEN
            for (int k = 0; k < columns * D; ++k) g[k] = vload(G + k * L8);
            VISVIVA_FLATTEN
            for (int j = 0; j < D; ++j) VISVIVA_FLATTEN
            for (int n = 0; n < D; ++n) VISVIVA_FLATTEN
            for (int i = 0; i < D; ++i) {
                const V m = t[(j * D + n) * D + i];
                VISVIVA_FLATTEN
                for (int c = 0; c < columns; ++c) sum[(c * D + i) * D + j] += g[c * D + n] * m;
            }
        }
        VISVIVA_FLATTEN
        for (int k = 0; k < columns * D * D; ++k) to[k] = sum[k];
        if (D == 2 && e.v.H)
            for (int c = 0; c < columns; ++c) add_hoop(first, end, a, b + c, to + c * D * D);
    }

    VISVIVA_INLINE void add_hoop(int first, int end, int a, int b, V* K) const {
        for (int q = first; q < end; ++q) {
            const V* M = A + 81 * (q - first);
            const double* G = e.gradients(q);
            const V ha = e.hoop(q, a), hb = e.hoop(q, b);
            K[0] += ha * hb * M[80];
            for (int j = 0; j < D; ++j)
                for (int n = 0; n < D; ++n) {
                    K[j] += ha * vload(G + (b * D + n) * L8) * M[(3 * j + n) * 9 + 8];
                    K[j * D] += vload(G + (a * D + n) * L8) * hb * M[8 * 9 + 3 * j + n];
                }
        }
    }
};

}  // namespace visviva::VISVIVA_ISA
