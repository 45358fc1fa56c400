// Tangents of fluid elements, W at a time: derivatives of FlowElement::forces by the end of the step.
#pragma once
#include "visviva/flow/flow_element.hpp"

namespace visviva::VISVIVA_ISA {

template <int D, int N, int P>
struct FlowTangent {
    using Element = FlowElement<D, N, P>;
    static constexpr int size = N * D + P;
    const Element& e;
    alignas(64) V K[size * size];  // rows and columns: velocities node by node, then pressures

    VISVIVA_INLINE explicit FlowTangent(const Element& element) : e(element) {
        for (int k = 0; k < size * size; ++k) K[k] = V{};
        for (int q = 0; q < e.f.n_points; ++q) {
            V G[N][D];
            FlowPoint<D, N> at;
            e.load(q, G);
            e.evaluate(q, G, at);
            add_velocities(q, G, at);
            add_pressures(q, G, at);
        }
    }
    VISVIVA_INLINE V& entry(int row, int column) { return K[row * size + column]; }

    // K_ab = delta_ij (N_a alpha_b + s_a beta_b + G_a . gamma_b) + U_a N_b + mu G_a(j) G_b(i) + G_a(i) H_b(j)
    VISVIVA_INLINE void add_velocities(int q, const V (*G)[D], const FlowPoint<D, N>& at) {
        const V w = e.volume(q), wt = e.step.theta * w, rho = e.f.rho * wt, mu = e.f.mu * wt;
        V alpha[N], beta[N], supg[N], H[N][D];
        for (int b = 0; b < N; ++b) {
            const V inertial = e.f.rho * e.inertia() * e.N_at(q, b) * w;
            alpha[b] = inertial + 0.5 * rho * at.s[b];
            beta[b] = -0.5 * rho * e.N_at(q, b);
            if constexpr (Element::stabilised) {
                supg[b] = at.tau * (inertial + rho * at.s[b]);
                beta[b] += supg[b];
                for (int j = 0; j < D; ++j)
                    H[b][j] = rho * (at.lsic * G[b][j] + at.div * e.N_at(q, b) * at.dlsic[j]);
            }
        }
        for (int a = 0; a < N; ++a) {
            V U[D * D];
            outer(q, a, G[a], at, U);
            for (int b = 0; b < N; ++b) {
                V same = e.N_at(q, a) * alpha[b] + at.s[a] * beta[b];
                for (int i = 0; i < D; ++i) same += mu * G[a][i] * G[b][i];
                for (int i = 0; i < D; ++i)
                    for (int j = 0; j < D; ++j) {
                        V k = U[i * D + j] * e.N_at(q, b) + mu * G[a][j] * G[b][i];
                        if constexpr (Element::stabilised)
                            k += G[a][i] * H[b][j] - at.s[a] * supg[b] * at.blind[i] * at.blind[j];
                        entry(a * D + i, b * D + j) += i == j ? k + same : k;
                    }
            }
        }
    }

    // factors of N_b: derivatives of the carrying velocity
    VISVIVA_INLINE void outer(int q, int a, const V* G, const FlowPoint<D, N>& at, V* U) const {
        const V wt = e.f.convection * e.step.theta * e.volume(q), rho = e.f.rho * wt;
        V seen[D * D];  // gradient of the velocity in the residual of stabilisation
        if constexpr (Element::stabilised)
            for (int j = 0; j < D; ++j) {
                V column[D];
                for (int i = 0; i < D; ++i) column[i] = at.L[i * D + j];
                Element::leave_out(at.blind, column);
                for (int i = 0; i < D; ++i) seen[i * D + j] = column[i];
            }
        for (int i = 0; i < D; ++i) {
            V behind = -0.5 * rho * at.v[i];
            if constexpr (Element::stabilised) behind += wt * at.tau * at.R[i];
            for (int j = 0; j < D; ++j) {
                V k = 0.5 * e.N_at(q, a) * rho * at.L[i * D + j] + G[j] * behind;
                if constexpr (Element::stabilised)
                    k += at.s[a] * (rho * at.tau * seen[i * D + j] + wt * at.R[i] * at.dtau[j]);
                U[i * D + j] = k;
            }
        }
    }

    VISVIVA_INLINE void add_pressures(int q, const V (*G)[D], const FlowPoint<D, N>& at) {
        const V w = e.volume(q);
        for (int a = 0; a < N; ++a)
            for (int b = 0; b < P; ++b)
                for (int i = 0; i < D; ++i) {
                    const V k = -w * e.M_at(q, b) * G[a][i];
                    entry(a * D + i, N * D + b) += k;
                    entry(N * D + b, a * D + i) += k;
                }
        if constexpr (Element::stabilised) add_stabilised_pressures(q, G, at);
    }

    // SUPG's share of the pressure gradient; rows of PSPG
    VISVIVA_INLINE void add_stabilised_pressures(int q, const V (*G)[D], const FlowPoint<D, N>& at) {
        const V w = e.volume(q), tau = w * at.tau, pspg = tau * (1 / e.f.rho);
        for (int b = 0; b < P; ++b) {
            V GL[D], GR = V{}, seen[D];
            for (int i = 0; i < D; ++i) seen[i] = G[b][i];
            Element::leave_out(at.blind, seen);
            for (int j = 0; j < D; ++j) {
                GL[j] = V{};
                for (int i = 0; i < D; ++i) GL[j] += e.f.convection * seen[i] * at.L[i * D + j];
                GR += G[b][j] * at.R[j];
            }
            for (int j = 0; j < D; ++j)
                GL[j] = e.step.theta * (tau * GL[j] + w * (1 / e.f.rho) * GR * at.dtau[j]);
            for (int a = 0; a < N; ++a) {
                const V carried = tau * (e.inertia() * e.N_at(q, a) + e.step.theta * at.s[a]);
                V laplace = V{};
                for (int i = 0; i < D; ++i) {
                    entry(a * D + i, N * D + b) += tau * at.s[a] * seen[i];
                    entry(N * D + b, a * D + i) -= carried * seen[i] + e.N_at(q, a) * GL[i];
                    laplace += G[a][i] * seen[i];
                }
                entry(N * D + b, N * D + a) -= pspg * laplace;
            }
        }
    }
};

}  // namespace visviva::VISVIVA_ISA
