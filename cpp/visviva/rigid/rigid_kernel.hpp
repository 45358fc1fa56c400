// The null-space map of rigid bodies, W bodies at a time: forces to force and torque, and back from
// translation and rotation to coordinates, directors kept orthonormal.
#pragma once
#include "visviva/base/simd.hpp"
#include "visviva/rigid/rigid.hpp"

namespace visviva::VISVIVA_ISA {

struct Frame {
    V d[9];
};

VISVIVA_INLINE void cross_add(const V* a, const V* b, V* c) {
    c[0] += a[1] * b[2] - a[2] * b[1];
    c[1] += a[2] * b[0] - a[0] * b[2];
    c[2] += a[0] * b[1] - a[1] * b[0];
}

VISVIVA_INLINE V dot(const V* a, const V* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

VISVIVA_INLINE Frame gather_frame(const RigidView& v, const double* x, int base) {
    Frame f;
    for (int k = 0; k < 9; ++k) f.d[k] = gather(x, v.q + (3 + k) * v.stride + base);
    return f;
}

VISVIVA_INLINE Frame frame_between(const Frame& f1, const RigidView& v, const Place& p, int base) {
    Frame f = gather_frame(v, p.x0, base);
    for (int k = 0; k < 9; ++k) f.d[k] += p.theta_g * (f1.d[k] - f.d[k]);
    return f;
}

VISVIVA_INLINE int count(const RigidView& v, int base) { return v.n - base < W ? v.n - base : W; }

VISVIVA_INLINE void put(V a, const int* index, int offset, int n, double* x) {
    for (int l = 0; l < n; ++l) x[index[l] + offset] = a[l];
}

// s = P(q_g)^T (-r), the torque by its components along the directors: there the inertia of a body stays the
// same while it turns, and a factorisation lasts.
void rigid_force(const RigidView& v, const double* r, const Place& p, double* s) {
    for (int base = 0; base < v.n; base += W) {
        const Frame f1 = gather_frame(v, p.x1, base), f = frame_between(f1, v, p, base);
        const Frame force = gather_frame(v, r, base);
        V torque[3];
        clear(torque, 3);
        for (int k = 0; k < 3; ++k) cross_add(force.d + 3 * k, f.d + 3 * k, torque);
        for (int c = 0; c < 3; ++c) {
            put(-gather(r, v.q + c * v.stride + base), v.at + base, c, count(v, base), s);
            put(dot(f1.d + 3 * c, torque), v.at + base, 3 + c, count(v, base), s);
        }
    }
}

// Cayley rotation about w (R d - d), then one Newton-Schulz sweep d (I - (d^T d - I)/2) against rounding.
VISVIVA_INLINE void rotate(const Frame& f, const V* w, V* change) {
    const V c = 1.0 / (1.0 + 0.25 * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
    Frame n = f;
    for (int k = 0; k < 3; ++k) {
        V once[3], twice[3];
        clear(once, 3), clear(twice, 3);
        cross_add(w, f.d + 3 * k, once);
        cross_add(w, once, twice);
        for (int i = 0; i < 3; ++i) {
            change[3 * k + i] = c * (once[i] + 0.5 * twice[i]);
            n.d[3 * k + i] += change[3 * k + i];
        }
    }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            V e = broadcast(i == j ? -1.0 : 0.0);
            for (int m = 0; m < 3; ++m) e += n.d[3 * i + m] * n.d[3 * j + m];
            for (int m = 0; m < 3; ++m) change[3 * j + m] -= 0.5 * e * n.d[3 * i + m];
        }
}

// The multipliers of orthonormality balance what is left of the director forces: Lambda_ij = -f_i . d^j, with
// the dual basis d^j at q_g; r must not contain their own contribution.
VISVIVA_INLINE void rigidity(const Frame& f, const Frame& force, V* lambda) {
    V g[9], m[3][3];
    clear(g, 9);
    cross_add(f.d + 3, f.d + 6, g);
    cross_add(f.d + 6, f.d, g + 3);
    cross_add(f.d, f.d + 3, g + 6);
    const V scale = -1.0 / (f.d[0] * g[0] + f.d[1] * g[1] + f.d[2] * g[2]);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            m[i][j] = broadcast(0.0);
            for (int c = 0; c < 3; ++c) m[i][j] += force.d[3 * i + c] * g[3 * j + c];
            m[i][j] *= scale;
        }
    for (int i = 0; i < 3; ++i) lambda[i] = m[i][i];
    lambda[3] = 0.5 * (m[0][1] + m[1][0]);
    lambda[4] = 0.5 * (m[0][2] + m[2][0]);
    lambda[5] = 0.5 * (m[1][2] + m[2][1]);
}

// The multipliers of orthonormality that belong to r at x1.
void rigid_balance(const RigidView& v, const double* r, const Place& p, double* dx, double* x1) {
    for (int base = 0; base < v.n; base += W) {
        V lambda[6];
        const Frame f = frame_between(gather_frame(v, p.x1, base), v, p, base);
        rigidity(f, gather_frame(v, r, base), lambda);
        for (int k = 0; k < 6; ++k) {
            const int* index = v.multiplier + k * v.stride + base;
            const V x0 = gather(p.x0, index), change = lambda[k] - x0;
            put(change, index, 0, count(v, base), dx);
            put(x0 + change, index, 0, count(v, base), x1);  // to the bit what a restart makes of x0 and dx
        }
    }
}

// The increment of coordinates; that of the multipliers of orthonormality is left to rigid_balance.
void rigid_expand(const RigidView& v, const double* s, const Place& p, double* d) {
    for (int base = 0; base < v.n; base += W) {
        const int n = count(v, base);
        V u[6], change[9];
        for (int c = 0; c < 6; ++c) u[c] = gather(s + c, v.at + base);
        const Frame f1 = gather_frame(v, p.x1, base);
        V turn[3];
        for (int c = 0; c < 3; ++c) turn[c] = u[3] * f1.d[c] + u[4] * f1.d[3 + c] + u[5] * f1.d[6 + c];
        rotate(f1, turn, change);
        for (int c = 0; c < 3; ++c) put(u[c], v.q + c * v.stride + base, 0, n, d);
        for (int k = 0; k < 9; ++k) put(change[k], v.q + (3 + k) * v.stride + base, 0, n, d);
    }
}

}  // namespace visviva::VISVIVA_ISA
