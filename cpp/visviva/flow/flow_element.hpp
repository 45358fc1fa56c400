// Fluid elements, W at a time: the incompressible flow of a Newtonian fluid at a point, paper (24) to (30),
// (43).
#pragma once
#include "visviva/base/simd.hpp"
#include "visviva/flow/flow.hpp"

namespace visviva::VISVIVA_ISA {

constexpr int L8 = 8;

VISVIVA_INLINE V inverse_root(V a) { return 1.0 / vsqrt(a); }

/// State at a point, velocities at the evaluation point of the step.
template <int D, int N>
struct FlowPoint {
    V v[D], rate[D], L[D * D];  // velocity, its rate, its gradient dv_i/dx_j
    V c[D], conv[D];            // velocity that carries, zero in Stokes flow; (c . grad) v
    V p, div, div1;             // pressure, divergence, also that of the end of the step
    V s[N];                     // c . grad N_a
    // Stabilised elements: residual of the momentum balance, Tezduyar's tau and its derivative by v, the same
    // of what penalises the divergence
    V R[D], tau, dtau[D], lsic, dlsic[D];
    V blind[D];  // direction along which R is left out, or zero
};

template <int D, int N, int P>
struct FlowElement {
    static constexpr bool stabilised = N == P;  // pairs of equal order
    static constexpr int slots = N + P;

    const FlowView& f;
    const Step& step;
    const int block, lane;  // lane: first of the W lanes
    alignas(64) V v[N * D], v1[N * D], rate[N * D], p[P];

    VISVIVA_INLINE FlowElement(const FlowView& view, const Step& s, const Vectors& x, int b, int l)
        : f(view), step(s), block(b), lane(l) {
        for (int a = 0; a < N; ++a)
            for (int c = 0; c < D; ++c) {
                const V v0 = gather(x.x0 + c, index(a));
                v1[a * D + c] = gather(x.x1 + c, index(a));
                v[a * D + c] = v0 + step.theta * (v1[a * D + c] - v0);
                rate[a * D + c] = gather(x.rate + c, index(a));
            }
        for (int b1 = 0; b1 < P; ++b1) p[b1] = gather(x.x1, index(N + b1));
    }
    // Number of the W lanes that hold elements; none or less in groups that fill the last block.
    VISVIVA_INLINE int active() const { return f.n - block * L8 - lane < W ? f.n - block * L8 - lane : W; }
    VISVIVA_INLINE const int* index(int slot) const { return f.index + (block * slots + slot) * L8 + lane; }
    VISVIVA_INLINE std::int64_t point(int q) const {
        return (static_cast<std::int64_t>(block) * f.n_points + q);
    }
    VISVIVA_INLINE V gradient(int q, int a, int c) const {
        return vload(f.G + ((point(q) * N + a) * D + c) * L8 + lane);
    }
    VISVIVA_INLINE V volume(int q) const { return vload(f.w + point(q) * L8 + lane); }
    VISVIVA_INLINE V force(int q, int c) const {
        return f.force ? vload(f.force + (point(q) * D + c) * L8 + lane) : V{};
    }
    VISVIVA_INLINE double N_at(int q, int a) const { return f.N[q * N + a]; }
    VISVIVA_INLINE double M_at(int q, int a) const { return f.M[q * P + a]; }

    // Share of the rates in the derivative by the end's velocity
    VISVIVA_INLINE double inertia() const { return step.flow[0][0]; }

    VISVIVA_INLINE void load(int q, V (*G)[D]) const {
        for (int a = 0; a < N; ++a)
            for (int c = 0; c < D; ++c) G[a][c] = gradient(q, a, c);
    }

    VISVIVA_INLINE void evaluate(int q, const V (*G)[D], FlowPoint<D, N>& at) const {
        for (int i = 0; i < D; ++i) at.v[i] = at.rate[i] = V{};
        for (int k = 0; k < D * D; ++k) at.L[k] = V{};
        at.p = at.div = at.div1 = V{};
        for (int a = 0; a < N; ++a)
            for (int i = 0; i < D; ++i) {
                at.v[i] += N_at(q, a) * v[a * D + i];
                at.rate[i] += N_at(q, a) * rate[a * D + i];
                at.div1 += v1[a * D + i] * G[a][i];
                for (int j = 0; j < D; ++j) at.L[i * D + j] += v[a * D + i] * G[a][j];
            }
        for (int b = 0; b < P; ++b) at.p += M_at(q, b) * p[b];
        for (int i = 0; i < D; ++i) at.c[i] = f.convection * at.v[i];
        for (int i = 0; i < D; ++i) {
            at.div += at.L[i * D + i];
            at.conv[i] = V{};
            for (int j = 0; j < D; ++j) at.conv[i] += at.L[i * D + j] * at.c[j];
        }
        for (int a = 0; a < N; ++a) {
            at.s[a] = V{};
            for (int i = 0; i < D; ++i) at.s[a] += at.c[i] * G[a][i];
        }
        if constexpr (stabilised) {
            for (int i = 0; i < D; ++i) {
                at.R[i] = f.rho * (at.rate[i] + at.conv[i]) - force(q, i);
                for (int b = 0; b < P; ++b) at.R[i] += p[b] * G[b][i];
                at.blind[i] = f.blind ? vload(f.blind + (block * D + i) * L8 + lane) : V{};
            }
            leave_out(at.blind, at.R);
            scales(q, at);
        }
    }

    // Takes off what a vector has along a direction.
    VISVIVA_INLINE static void leave_out(const V* blind, V* a) {
        V along = V{};
        for (int i = 0; i < D; ++i) along += blind[i] * a[i];
        for (int i = 0; i < D; ++i) a[i] -= along * blind[i];
    }

    // Tezduyar (1991): 1/tau^2 = (2/h)^2 + (2|v|/l)^2 + (4 nu/l^2)^2 with the length l along v from the
    // metric; the divergence is penalised by tau |v|^2 (Tezduyar & Osawa 2000).
    VISVIVA_INLINE void scales(int q, FlowPoint<D, N>& at) const {
        constexpr int packed = D * (D + 1) / 2;
        V m[packed + 1], Gv[D], along = V{}, speed2 = V{};
        for (int k = 0; k <= packed; ++k) m[k] = vload(f.metric + (point(q) * (packed + 1) + k) * L8 + lane);
        for (int i = 0; i < D; ++i) {
            Gv[i] = V{};
            for (int j = 0; j < D; ++j) {
                const int low = i < j ? i : j, high = i < j ? j : i;
                Gv[i] += m[low * D - low * (low - 1) / 2 + high - low] * at.c[j];
            }
            along += Gv[i] * at.c[i];
            speed2 += at.c[i] * at.c[i];
        }
        const double nu = f.mu / f.rho, in_time = inertia() != 0 ? 4 / (step.h * step.h) : 0;
        at.tau = inverse_root(in_time + along + (nu * nu / D) * m[packed]);
        at.lsic = at.tau * speed2;
        const V cube = at.tau * at.tau * at.tau;
        for (int i = 0; i < D; ++i) {
            at.dtau[i] = -cube * Gv[i];
            at.dlsic[i] = at.dtau[i] * speed2 + 2.0 * at.tau * at.c[i];
        }
    }

    // Residual by slot: r[a * D + i] of velocities, then of pressures
    VISVIVA_INLINE void forces(V* r) const {
        for (int k = 0; k < N * D + P; ++k) r[k] = V{};
        for (int q = 0; q < f.n_points; ++q) {
            V G[N][D];
            FlowPoint<D, N> at;
            load(q, G);
            evaluate(q, G, at);
            add_galerkin(q, G, at, r);
            if constexpr (stabilised) add_stabilisation(q, G, at, r);
        }
    }

    // rho (dv/dt + skew-symmetric convection) - div sigma, and the constraint of the end of the step
    VISVIVA_INLINE void add_galerkin(int q, const V (*G)[D], const FlowPoint<D, N>& at, V* r) const {
        const V w = volume(q), rho = f.rho * w;
        V first[D], sigma[D * D];
        for (int i = 0; i < D; ++i) {
            first[i] = rho * (at.rate[i] + 0.5 * at.conv[i]) - w * force(q, i);
            for (int j = 0; j < D; ++j)
                sigma[i * D + j] = w * f.mu * (at.L[i * D + j] + at.L[j * D + i]) - (i == j ? w * at.p : V{});
        }
        for (int a = 0; a < N; ++a)
            for (int i = 0; i < D; ++i) {
                V sum = N_at(q, a) * first[i] - 0.5 * rho * at.s[a] * at.v[i];
                for (int j = 0; j < D; ++j) sum += sigma[i * D + j] * G[a][j];
                r[a * D + i] += sum;
            }
        for (int b = 0; b < P; ++b) r[N * D + b] -= w * M_at(q, b) * at.div1;
    }

    // SUPG, LSIC and PSPG
    VISVIVA_INLINE void add_stabilisation(int q, const V (*G)[D], const FlowPoint<D, N>& at, V* r) const {
        const V w = volume(q), tau = w * at.tau, push = w * f.rho * at.lsic * at.div;
        for (int a = 0; a < N; ++a) {
            V along = V{};
            for (int i = 0; i < D; ++i) {
                r[a * D + i] += tau * at.s[a] * at.R[i] + push * G[a][i];
                along += G[a][i] * at.R[i];
            }
            r[N * D + a] -= tau * (1 / f.rho) * along;
        }
    }
};

}  // namespace visviva::VISVIVA_ISA
