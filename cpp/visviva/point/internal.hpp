// Stresses of energies at a point, and the internal variables that evolve there.
#pragma once
#include "visviva/material/discrete_gradient.hpp"

namespace visviva::VISVIVA_ISA {

/// Stresses and moduli conjugate to strains as they stand, s_k = dW/de_k: no metric.
template <bool tangent, class Energy, int n = Energy::n>
void conjugate_stress(const Energy& energy, const Step& step, const V* e0, const V* e1, const V* et, V* s,
                      V* T) {
    stress_of<tangent>(energy, step, e0, e1, et, s, T);
    for (int k = 0; k < n; ++k) {
        s[k] *= Energy::weight(k);
        for (int l = 0; tangent && l < n; ++l) T[n * k + l] *= Energy::weight(k) * Energy::weight(l);
    }
}

/// Solves A x = b in place for m right sides b [n][m], without pivots: A is near the identity.
template <int n>
void solve_at_point(V* A, V* b, int m) {
    for (int i = 0; i < n; ++i) {
        const V inverse = 1.0 / A[n * i + i];
        for (int k = i + 1; k < n; ++k) {
            const V factor = A[n * k + i] * inverse;
            for (int j = i; j < n; ++j) A[n * k + j] -= factor * A[n * i + j];
            for (int j = 0; j < m; ++j) b[m * k + j] -= factor * b[m * i + j];
        }
    }
    for (int i = n - 1; i >= 0; --i)
        for (int j = 0; j < m; ++j) {
            for (int k = i + 1; k < n; ++k) b[m * i + j] -= A[n * i + k] * b[m * k + j];
            b[m * i + j] /= A[n * i + i];
        }
}

/// Internal variables h, the last strains of an energy, follow dh/dt = flow(-dW/dh, h): the same discrete
/// gradient decides dW/dh, so that what is lost is exactly -dW/dh . dh. Solved at the point by Newton's
/// method from the start of the step; T is then that of the other strains with h following them.
template <bool tangent, class Energy, int n = Energy::n>
void evolve(const Energy& energy, const Step& step, const V* e0, V* e1, V* et, V* s, V* T) {
    constexpr int n_h = Energy::n_internal, n_s = n - n_h, most = 25;
    const bool ends = step.stress == Stress::discrete_gradient;
    const double theta = step.theta, dt = step.h > 0 ? step.h : 0;  // nothing evolves on the way back
    V A[n_h * n_h], right[n_h * (n_s > 0 ? n_s : 1)], slope[n_h * n_h];
    for (int k = n_s; k < n; ++k) e1[k] = e0[k];
    for (int iteration = 0; iteration <= most; ++iteration) {
        for (int k = n_s; k < n; ++k) et[k] = e0[k] + theta * (e1[k] - e0[k]);
        conjugate_stress<true>(energy, step, e0, e1, et, s, T);
        // R = h1 - h0 - dt flow(-s, h at theta or in the middle)
        using J = Jet<2 * n_h, false>;
        J force[n_h], h[n_h], rate[n_h];
        const double share = ends ? 0.5 : theta;
        for (int k = 0; k < n_h; ++k) {
            force[k] = J::variable(-s[n_s + k], k);
            h[k] = J::variable(e0[n_s + k] + share * (e1[n_s + k] - e0[n_s + k]), n_h + k);
        }
        energy.flow(force, h, rate);
        V R[n_h], largest{};
        for (int k = 0; k < n_h; ++k) {
            R[k] = e1[n_s + k] - e0[n_s + k] - dt * rate[k].v;
            for (int l = 0; l < n_h; ++l) {
                slope[n_h * k + l] = dt * rate[k].g[l];  // dR/ds
                V a = broadcast(k == l ? 1.0 : 0.0) - (share * dt) * rate[k].g[n_h + l];
                for (int m = 0; m < n_h; ++m)
                    a += (ends ? 1.0 : theta) * dt * rate[k].g[m] * T[n * (n_s + m) + n_s + l];
                A[n_h * k + l] = a;
            }
            largest = vmax(largest, vabs(R[k]));
        }
        bool done = true;
        for (int l = 0; l < W; ++l) done = done && largest[l] <= 1e-15;
        if (done || iteration == most) break;
        solve_at_point<n_h>(A, R, 1);
        V step_size{};
        for (int k = 0; k < n_h; ++k) e1[n_s + k] -= R[k], step_size = vmax(step_size, vabs(R[k]));
    }
    if constexpr (tangent) {
        // dh1 = -A^-1 dR/ds T_hs de
        for (int k = 0; k < n_h; ++k)
            for (int j = 0; j < n_s; ++j) {
                V sum{};
                for (int m = 0; m < n_h; ++m) sum += slope[n_h * k + m] * T[n * (n_s + m) + j];
                right[n_s * k + j] = sum;
            }
        solve_at_point<n_h>(A, right, n_s);
        for (int i = 0; i < n_s; ++i)
            for (int j = 0; j < n_s; ++j)
                for (int k = 0; k < n_h; ++k)
                    T[n * i + j] -= (ends ? 1.0 : theta) * T[n * i + n_s + k] * right[n_s * k + j];
    }
}

}  // namespace visviva::VISVIVA_ISA
