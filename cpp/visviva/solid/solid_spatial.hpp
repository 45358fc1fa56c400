// Symmetric tangents of isotropic solids in the current configuration, and their forces:
// K_ab = sum_q (g_a . tau g_b) I + g_a c g_b and r_a = sum_q tau g_a with the gradients g_a = F^-T G_a.
// Where the energy is plain, g_a c g_b = lambda g_a x g_b + mu g_b x g_a + mu (g_a . g_b) I.
#pragma once
#include <algorithm>

#include "visviva/solid/solid_scatter.hpp"

namespace visviva::VISVIVA_ISA {

template <int N, bool plain>
struct SpatialTangent : SolidBlocks<3, N> {
    using Blocks = SolidBlocks<3, N>;
    using Blocks::K;
    const SolidElement<3, N>& e;
    double *const forces, *const values;
    static constexpr int max_nodes = SolidElement<3, N>::max_nodes;
    // Points at a time: what their blocks read stays in the first cache. Those of a brick, all at once, leave
    // the registers for where they belong.
    static constexpr int points = plain ? 8 : 4;
    static constexpr int n_moduli = plain ? 2 : 21;
    static constexpr int n_left = plain ? 9 : 21;
    alignas(64) V g[points * max_nodes * 3];   // gradients by position
    alignas(64) V C[points * (n_moduli + 6)];  // moduli and stress, times the volume
    alignas(64) V T[points * n_left];          // what g_a contracts them to, of one node
    alignas(64) V r[max_nodes * 3];
    V smallest = broadcast(1e300);

    VISVIVA_INLINE SpatialTangent(const SolidElement<3, N>& element, double* to_forces, double* to_values)
        : Blocks(element.nodes() * element.nodes() * 9), e(element), forces(to_forces), values(to_values) {
        for (int a = 0; a < e.nodes() * 3; ++a) r[a] = V{};
        for (int first = 0; first < e.v.n_points; first += points)
            add_points(first, std::min(points, e.v.n_points - first));
        for (int a = 0; a < e.nodes(); ++a) solid_scatter_row(e, a, K, true, values);
        if (forces) add_forces();
    }

    // Points from `first` on
    VISVIVA_INLINE void add_points(int first, int n) {
        for (int q = 0; q < n; ++q) point(first + q, g + q * e.nodes() * 3, C + q * (n_moduli + 6));
        for (int a = 0; a < e.nodes(); ++a) {
            V force[3] = {r[3 * a], r[3 * a + 1], r[3 * a + 2]};
            for (int q = 0; q < n; ++q)
                left(g + (q * e.nodes() + a) * 3, C + q * (n_moduli + 6), T + q * n_left, force);
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) r[3 * a + i] = force[i];
            for (int b = a; b < e.nodes(); ++b) block(first, n, a, b);
        }
    }

    // The stress contracted with the gradients carries the share of the end.
    VISVIVA_INLINE void add_forces() {
        const double share = 1 / e.step.theta;
        for (int k = 0; k < e.nodes() * 3; ++k) r[k] *= share;
        e.finish(r, smallest);
        solid_scatter_forces(e, r, e.active(), forces);
    }

    VISVIVA_INLINE void point(int q, V* gradients, V* moduli) {
        V F[9], left[6], inverse[9], par[material_max_parameters];
        e.gradient(e.x1, q, 1.0, F);
        const V det = determinant(F);
        smallest = select(det < smallest, det, smallest);
        if (!e.ends) {
            V F0[9];
            e.gradient(e.x0, q, 1.0, F0);
            VISVIVA_FLATTEN
            for (int k = 0; k < 9; ++k) F[k] = F0[k] + e.step.theta * (F[k] - F0[k]);
        }
        left_strain(F, left);
        for (int k = 0; k < e.v.n_par; ++k) par[k] = e.parameter(k);
        SpatialResponse<plain> response;
        respond_in_space(e.v.kind, left, par, response);
        const V factor = e.volume(q) * e.step.theta;
        VISVIVA_FLATTEN
        for (int k = 0; k < n_moduli; ++k) moduli[k] = factor * response.c[k];
        VISVIVA_FLATTEN
        for (int k = 0; k < 6; ++k) moduli[n_moduli + k] = factor * response.tau[k];
        invert(F, inverse);
        const double* G = e.gradients(q);
        for (int a = 0; a < e.nodes(); ++a) {
            const V G0 = vload(G + 3 * a * e.stride), G1 = vload(G + (3 * a + 1) * e.stride),
                    G2 = vload(G + (3 * a + 2) * e.stride);
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

    VISVIVA_INLINE static void left(const V* ga, const V* c, V* t, V* force) {
        const V g0 = ga[0], g1 = ga[1], g2 = ga[2], *tau = c + n_moduli;
        if constexpr (plain) {
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) t[i] = c[0] * ga[i], t[3 + i] = c[1] * ga[i];
        } else {
            VISVIVA_FLATTEN
            for (int m = 0; m < 6; ++m) VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) {
                auto modulus = [c, m](int k) { return c[k < m ? packed(6, k, m) : packed(6, m, k)]; };
                t[3 * m + i] =
                    g0 * modulus(voigt[i][0]) + g1 * modulus(voigt[i][1]) + g2 * modulus(voigt[i][2]);
            }
        }
        VISVIVA_FLATTEN
        for (int i = 0; i < 3; ++i) {
            const V f = g0 * tau[voigt[i][0]] + g1 * tau[voigt[i][1]] + g2 * tau[voigt[i][2]];
            force[i] += f;
            t[n_left - 3 + i] = plain ? f + t[3 + i] : f;
        }
    }

    // Block (a, b): K[i][j]
    VISVIVA_INLINE void block(int first, int n, int a, int b) {
        V *to = K + (a * e.nodes() + b) * 9, sum[9], geometric[3] = {};
        if (first == 0) geometric[0] = e.mass_factor(a, b);
        VISVIVA_FLATTEN
        for (int k = 0; k < 9; ++k) sum[k] = first == 0 ? V{} : to[k];
        for (int q = 0; q < n; ++q) {
            const V *t = T + q * n_left, *h = g + (q * e.nodes() + b) * 3;
            contract_right(t, h, sum);
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) geometric[i] += t[n_left - 3 + i] * h[i];
        }
        const V trace = geometric[0] + geometric[1] + geometric[2];
        VISVIVA_FLATTEN
        for (int k = 0; k < 9; ++k) to[k] = sum[k] + (k % 4 == 0 ? trace : V{});
    }

    VISVIVA_INLINE static void contract_right(const V* t, const V* h, V* sum) {
        if constexpr (plain) {
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) VISVIVA_FLATTEN
            for (int j = 0; j < 3; ++j) sum[3 * i + j] += t[i] * h[j] + h[i] * t[3 + j];
        } else {
            VISVIVA_FLATTEN
            for (int m = 0; m < 6; ++m) VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) {
                const int j = voigt_a[m], k = voigt_b[m];
                sum[3 * i + j] += t[3 * m + i] * h[k];
                if (m >= 3) sum[3 * i + k] += t[3 * m + i] * h[j];
            }
        }
    }
};

}  // namespace visviva::VISVIVA_ISA
