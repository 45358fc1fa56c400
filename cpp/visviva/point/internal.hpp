// Stresses of energies at a point, and the internal variables that evolve there.
#pragma once
#include <numbers>

#include "visviva/material/discrete_gradient.hpp"

namespace visviva::VISVIVA_ISA {

/// Part of energies of C and A, the inverse of the viscous Cauchy-Green tensor, both less I: A is internal.
struct ViscousEnergy : TensorEnergy {
    static constexpr int n = 12, n_internal = 6;
    V warms{};  // d ln(rate of A) / d theta
    /// Where A is positive definite; elsewhere its equation has solutions that mean nothing.
    VI admits(const V* internal) const {
        const V x = internal[0] + 1.0, y = internal[1] + 1.0, z = internal[2] + 1.0;
        const V q = internal[3], r = internal[4], s = internal[5], plane = x * y - q * q;
        return (x > 0.0) & (plane > 0.0) & (z * plane - x * r * r + 2.0 * q * r * s - y * s * s > 0.0);
    }
    /// By which changes of A are judged: its largest entry.
    V size(const V* internal) const {
        V largest{};
        for (int k = 0; k < 6; ++k) largest = vmax(largest, vabs(internal[k] + (k < 3 ? 1.0 : 0.0)));
        return largest;
    }
};

/// Takes the metric off stresses and moduli.
template <bool tangent, class Energy, int n = Energy::n>
void conjugate(const Energy&, V* s, V* T) {
    for (int k = 0; k < n; ++k) {
        s[k] *= Energy::weight(k);
        for (int l = 0; tangent && l < n; ++l) T[n * k + l] *= Energy::weight(k) * Energy::weight(l);
    }
}

/// Stresses and moduli conjugate to strains as they stand, s_k = dW/de_k: no metric.
template <bool tangent, class Energy>
void conjugate_stress(const Energy& energy, const Step& step, const V* e0, const V* e1, const V* et, V* s,
                      V* T) {
    stress_of<tangent>(energy, step, e0, e1, et, s, T);
    conjugate<tangent>(energy, s, T);
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

/// Internal variables h, the last strains of an energy, follow dh/dt = flow(-dW/dh, h) by h1 = h0 + ahead +
/// dt flow: the same discrete gradient decides dW/dh, so that what is lost is exactly -dW/dh . dh. Solved at
/// the point by Newton's method from the start of the step; T is then that of the other strains with h
/// following them.
template <class Energy, int n = Energy::n>
struct Evolution {
    static constexpr int n_h = Energy::n_internal, n_s = n - n_h, n_x = n_s + 1, most = 40;
    const Energy& energy;
    const Step& step;
    const V* e0;
    V *e1, *et, *s, *T;
    double dt;
    // By an earlier stage of the step; less its slope.
    V ahead[n_h] = {}, by_ahead[n_h * n_x] = {};
    V A[n_h * n_h] = {}, slope[n_h * n_h] = {}, R[n_h] = {}, X[n_h * n_x] = {};

    bool ends() const { return step.stress == Stress::discrete_gradient; }

    /// R = h1 - h0 - part (ahead + dt flow(-s, h at theta or in the middle)), A = dR/dh1, slope = dR/ds.
    void linearise(double part) {
        const double length = part * dt;
        for (int k = n_s; k < n; ++k) et[k] = e0[k] + step.theta * (e1[k] - e0[k]);
        conjugate_stress<true>(energy, step, e0, e1, et, s, T);
        using J = Jet<2 * n_h, false>;
        J force[n_h], h[n_h], rate[n_h];
        const double share = ends() ? 0.5 : step.theta;
        for (int k = 0; k < n_h; ++k) {
            force[k] = J::variable(-s[n_s + k], k);
            h[k] = J::variable(e0[n_s + k] + share * (e1[n_s + k] - e0[n_s + k]), n_h + k);
        }
        energy.flow(force, h, rate);
        for (int k = 0; k < n_h; ++k) {
            R[k] = e1[n_s + k] - e0[n_s + k] - part * ahead[k] - length * rate[k].v;
            for (int l = 0; l < n_h; ++l) {
                slope[n_h * k + l] = length * rate[k].g[l];
                V a = broadcast(k == l ? 1.0 : 0.0) - (share * length) * rate[k].g[n_h + l];
                for (int m = 0; m < n_h; ++m)
                    a += (ends() ? 1.0 : step.theta) * length * rate[k].g[m] * T[n * (n_s + m) + n_s + l];
                A[n_h * k + l] = a;
            }
        }
    }

    /// Newton's method from where h1 is, in lanes that are not done; steps that do not lower R are cut. Done
    /// are lanes whose corrections are rounding: no larger than that, or full ones that lower R no further
    /// where the error before was so small that its square is rounding.
    VI solve(double part, VI done) {
        V from[n_h], move[n_h] = {}, lowest = broadcast(1e300), share = broadcast(1.0), taken = lowest;
        for (int k = 0; k < n_h; ++k) from[k] = e1[n_s + k];
        for (int round = 0; round < most; ++round) {
            linearise(part);
            V B[n_h * n_h], d[n_h], norm{}, largest{};
            for (int k = 0; k < n_h * n_h; ++k) B[k] = A[k];
            for (int k = 0; k < n_h; ++k) d[k] = R[k], norm += R[k] * R[k];
            solve_at_point<n_h>(B, d, 1);
            for (int k = 0; k < n_h; ++k) largest = vmax(largest, vabs(d[k]));
            const V size = energy.size(e1 + n_s);
            const VI better = (norm < lowest) & energy.admits(e1 + n_s);  // never where it is no number
            done |=
                (better & (largest <= 1e-15 * size)) | (~better & (share == 1.0) & (taken <= 1e-9 * size));
            if (all(done)) break;
            lowest = select(better, norm, lowest);
            share = select(better, broadcast(1.0), 0.25 * share);
            taken = V{};
            for (int k = 0; k < n_h; ++k) {
                from[k] = select(better, e1[n_s + k], from[k]), move[k] = select(better, d[k], move[k]);
                e1[n_s + k] = select(done, e1[n_s + k], from[k] - share * move[k]);
                taken = vmax(taken, vabs(share * move[k]));
            }
        }
        return done;
    }

    /// Where Newton's method does not get there at once, it follows h1 from shorter steps to longer ones.
    VI solve_by_parts(VI done) {
        done = solve(1, done);
        if (all(done)) return done;
        for (int k = n_s; k < n; ++k) e1[k] = select(done, e1[k], e0[k]);
        for (double part = 0x1p-20; part < 1; part *= 1.42) solve(part, done);
        return solve(1, done);
    }

    /// What h1 changes by in this stage, and what that loses.
    V change(int k) const { return e1[n_s + k] - e0[n_s + k] - ahead[k]; }
    V lost() const {
        V sum{};
        for (int k = 0; k < n_h; ++k) sum -= s[n_s + k] * change(k);
        return sum;
    }

    /// The change of h1 by the other strains and by the temperature that the rate depends on, -X (de,
    /// dtheta): dR/de = slope T_hs, dR/dtheta = -change d ln(rate)/dtheta, less what an earlier stage says.
    void follow() {
        for (int k = 0; k < n_h; ++k) {
            for (int j = 0; j < n_s; ++j) {
                V sum = by_ahead[n_x * k + j];
                for (int m = 0; m < n_h; ++m) sum += slope[n_h * k + m] * T[n * (n_s + m) + j];
                X[n_x * k + j] = sum;
            }
            X[n_x * k + n_s] = by_ahead[n_x * k + n_s] - energy.warms * change(k);
        }
        solve_at_point<n_h>(A, X, n_x);
    }

    /// Adds what the stresses of the other strains change by h.
    void condense() {
        for (int i = 0; i < n_s; ++i)
            for (int j = 0; j < n_s; ++j)
                for (int k = 0; k < n_h; ++k)
                    T[n * i + j] -= (ends() ? 1.0 : step.theta) * T[n * i + n_s + k] * X[n_x * k + j];
    }
};

/// Share of the step after which the first of two stages stands (Alexander 1977): with this one they are
/// L-stable and of second order.
inline constexpr double first_stage = 1 - std::numbers::sqrt2 / 2;

/// Finds the end of a step from where `at` begins; `early` is the energy as it is after the first stage.
/// Steps that balance forces at their ends take two stages of backward Euler, of which each loses energy; the
/// other strains at the first one are between those of the ends. Returned are the lanes, of the first
/// `active` ones, that found it; the others count as found.
template <bool tangent, class Energy>
VI evolve(const Energy& early, Evolution<Energy>& at, int active, V& lost) {
    constexpr int n_h = Energy::n_internal, n = Energy::n, n_s = n - n_h;
    VI idle, found = broadcast(0.0) == 0.0;
    for (int l = 0; l < W; ++l) idle[l] = l < active ? 0 : -1;
    for (int k = n_s; k < n; ++k) at.e1[k] = at.e0[k];
    lost = V{};
    if (at.step.balances_ends()) {
        const double g = first_stage;
        V e[n], t[n], s[n], T[n * n];
        for (int k = 0; k < n_s; ++k) e[k] = t[k] = at.e0[k] + g * (at.e1[k] - at.e0[k]);
        for (int k = n_s; k < n; ++k) e[k] = at.e0[k];
        Evolution<Energy> first{early, at.step, at.e0, e, t, s, T, g * at.dt};
        at.dt = first.dt;
        found = first.solve_by_parts(idle);
        lost = (1 - g) / g * first.lost();
        if constexpr (tangent) first.follow();
        for (int k = 0; k < n_h; ++k) {
            at.ahead[k] = (1 - g) / g * first.change(k), at.e1[n_s + k] = e[n_s + k];
            for (int j = 0; tangent && j <= n_s; ++j)
                at.by_ahead[(n_s + 1) * k + j] = (1 - g) * first.X[(n_s + 1) * k + j];
        }
    }
    found &= at.solve_by_parts(idle | ~found);
    lost += at.lost();
    if constexpr (tangent) at.follow(), at.condense();
    return found;
}

/// The same where the energy depends on nothing else; s and T are those of the other strains alone.
template <bool tangent, class Energy>
VI evolve(const Energy& energy, const Step& step, int active, const V* e0, V* e1, V* et, V* s, V* T,
          V& lost) {
    // nothing evolves on the way back
    Evolution<Energy> at{energy, step, e0, e1, et, s, T, step.h > 0 ? step.h : 0};
    return evolve<tangent>(energy, at, active, lost);
}

}  // namespace visviva::VISVIVA_ISA
