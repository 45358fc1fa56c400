// Symmetric tangents of isotropic solids in the current configuration:
// K_ab = sum_q (g_a . tau g_b) I + g_a c g_b with the gradients g_a = F^-T G_a, two thirds of the work of
// moduli between two configurations.
#pragma once
#include <algorithm>

#include "solid_element.hpp"

namespace visviva::VISVIVA_ISA {

template <int N>
struct SpatialTangent {
    const SolidElement<3, N>& e;
    static constexpr int max_nodes = N > 0 ? N : solid_max_nodes;
    alignas(64) V g[tangent_points * max_nodes * 3];  // gradients by position
    alignas(64) V C[tangent_points * 27];             // moduli (21) and stress (6), times the volume
    alignas(64) V T[tangent_points * 21];             // g_a c (three rows of six) and tau g_a of one node
    alignas(64) V K[max_nodes * max_nodes * 9];

    VISVIVA_INLINE explicit SpatialTangent(const SolidElement<3, N>& element) : e(element) {
        for (int first = 0; first < e.v.n_points; first += tangent_points)
            add_points(first, std::min(tangent_points, e.v.n_points - first));
    }

    // Points from `first` on
    VISVIVA_INLINE void add_points(int first, int n) {
        for (int q = 0; q < n; ++q) point(first + q, g + q * e.nodes() * 3, C + q * 27);
        for (int a = 0; a < e.nodes(); ++a) {
            for (int q = 0; q < n; ++q) left(g + (q * e.nodes() + a) * 3, C + q * 27, T + q * 21);
            int b = a;
            for (; b + tangent_columns <= e.nodes(); b += tangent_columns)
                blocks<tangent_columns>(first, n, a, b);
            if (b < e.nodes()) blocks<1>(first, n, a, b);
        }
    }

    VISVIVA_INLINE void point(int q, V* gradients, V* moduli) const {
        SolidPoint p;
        e.strains(q, p);
        V left[6], inverse[9], par[material_max_parameters];
        left_strain(p.Ft, left);
        for (int k = 0; k < e.v.n_par; ++k) par[k] = e.parameter(k);
        SpatialResponse r;
        respond_in_space(e.v.kind, left, par, r);
        const V factor = e.volume(q) * e.step.theta;
        VISVIVA_FLATTEN
        for (int k = 0; k < 21; ++k) moduli[k] = factor * r.c[k];
        VISVIVA_FLATTEN
        for (int k = 0; k < 6; ++k) moduli[21 + k] = factor * r.tau[k];
        invert(p.Ft, inverse);
        const double* G = e.gradients(q);
        for (int a = 0; a < e.nodes(); ++a) {
            const V G0 = vload(G + 3 * a * L8), G1 = vload(G + (3 * a + 1) * L8),
                    G2 = vload(G + (3 * a + 2) * L8);
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i)
                gradients[3 * a + i] = inverse[i] * G0 + inverse[3 + i] * G1 + inverse[6 + i] * G2;
        }
    }

    // b - I
    VISVIVA_INLINE static void left_strain(const V* F, V* b) {
        V f[9];
        VISVIVA_FLATTEN
        for (int k = 0; k < 9; ++k) f[k] = F[k] - (k % 4 == 0 ? 1.0 : 0.0);
        VISVIVA_FLATTEN
        for (int k = 0; k < 6; ++k) {
            const int i = voigt_a[k], j = voigt_b[k];
            b[k] = f[3 * i + j] + f[3 * j + i];
            VISVIVA_FLATTEN
            for (int m = 0; m < 3; ++m) b[k] += f[3 * i + m] * f[3 * j + m];
        }
    }

    VISVIVA_INLINE static void invert(const V* F, V* to) {
        V cofactor[9];
        VISVIVA_FLATTEN
        for (int i = 0; i < 3; ++i) VISVIVA_FLATTEN
        for (int j = 0; j < 3; ++j) {
            const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
            cofactor[3 * i + j] = F[3 * k + m] * F[3 * l + n] - F[3 * k + n] * F[3 * l + m];
        }
        const V scale = 1.0 / (F[0] * cofactor[0] + F[1] * cofactor[1] + F[2] * cofactor[2]);
        VISVIVA_FLATTEN
        for (int i = 0; i < 3; ++i) VISVIVA_FLATTEN
        for (int j = 0; j < 3; ++j) to[3 * j + i] = scale * cofactor[3 * i + j];
    }

    VISVIVA_INLINE static void left(const V* ga, const V* c, V* t) {
        const V g0 = ga[0], g1 = ga[1], g2 = ga[2];
        VISVIVA_FLATTEN
        for (int m = 0; m < 6; ++m) {
            V column[6];
            VISVIVA_FLATTEN
            for (int k = 0; k < 6; ++k) column[k] = c[k < m ? packed(6, k, m) : packed(6, m, k)];
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i)
                t[3 * m + i] = g0 * column[voigt[i][0]] + g1 * column[voigt[i][1]] + g2 * column[voigt[i][2]];
        }
        VISVIVA_FLATTEN
        for (int i = 0; i < 3; ++i)
            t[18 + i] = g0 * c[21 + voigt[i][0]] + g1 * c[21 + voigt[i][1]] + g2 * c[21 + voigt[i][2]];
    }

    // Blocks (a, b) to (a, b + columns - 1): K[i][j] each
    template <int columns>
    VISVIVA_INLINE void blocks(int first, int n, int a, int b) {
        V* to = K + (a * e.nodes() + b) * 9;
        V sum[columns * 9], geometric[columns];
        VISVIVA_FLATTEN
        for (int k = 0; k < columns * 9; ++k) sum[k] = first == 0 ? V{} : to[k];
        VISVIVA_FLATTEN
        for (int c = 0; c < columns; ++c) geometric[c] = first == 0 ? e.mass_factor(a, b + c) : V{};
        for (int q = 0; q < n; ++q) {
            const V *t = T + q * 21, *gb = g + (q * e.nodes() + b) * 3;
            V h[columns * 3];
            VISVIVA_FLATTEN
            for (int k = 0; k < columns * 3; ++k) h[k] = gb[k];
            VISVIVA_FLATTEN
            for (int m = 0; m < 6; ++m) VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) {
                const V f = t[3 * m + i];
                const int j = voigt_a[m], k = voigt_b[m];
                VISVIVA_FLATTEN
                for (int c = 0; c < columns; ++c) {
                    sum[9 * c + 3 * i + j] += f * h[3 * c + k];
                    if (m >= 3) sum[9 * c + 3 * i + k] += f * h[3 * c + j];
                }
            }
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) VISVIVA_FLATTEN
            for (int c = 0; c < columns; ++c) geometric[c] += t[18 + i] * h[3 * c + i];
        }
        VISVIVA_FLATTEN
        for (int c = 0; c < columns; ++c) VISVIVA_FLATTEN
        for (int k = 0; k < 9; ++k) to[9 * c + k] = sum[9 * c + k] + (k % 4 == 0 ? geometric[c] : V{});
    }
};

}  // namespace visviva::VISVIVA_ISA
