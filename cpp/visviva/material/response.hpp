// From an energy to stress and tangent at one point, W points at a time. Symmetric tensors are six numbers
// (11, 22, 33, 12, 23, 31); c = C - I is the strain measure.
#pragma once
#include "visviva/material/materials.hpp"
#include "visviva/material/potential.hpp"

namespace visviva::VISVIVA_ISA {

constexpr int voigt_a[6] = {0, 1, 2, 0, 1, 2}, voigt_b[6] = {0, 1, 2, 1, 2, 0};
constexpr int voigt[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/// a : b
VISVIVA_INLINE V contract(const V* a, const V* b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
}

/// Energy, its gradient by C and its second gradient, all per reference volume.
using Response = Potential<6>;

struct Invariants {
    V i1, i2, j;
    V cofactor[6];  // of C
};

VISVIVA_INLINE Invariants invariants(const V* c) {
    Invariants i;
    const V x = 1.0 + c[0], y = 1.0 + c[1], z = 1.0 + c[2];
    i.i1 = c[0] + c[1] + c[2];
    const V q = c[0] * c[1] + c[1] * c[2] + c[2] * c[0] - c[3] * c[3] - c[4] * c[4] - c[5] * c[5];
    i.i2 = 2.0 * i.i1 + q;
    const V det =
        c[0] * (c[1] * c[2] - c[4] * c[4]) + c[3] * (2.0 * c[4] * c[5] - c[3] * c[2]) - c[5] * c[5] * c[1];
    const V d = i.i1 + q + det;
    i.j = d / (1.0 + vsqrt(1.0 + d));
    i.cofactor[0] = y * z - c[4] * c[4], i.cofactor[1] = z * x - c[5] * c[5];
    i.cofactor[2] = x * y - c[3] * c[3], i.cofactor[3] = c[4] * c[5] - c[3] * z;
    i.cofactor[4] = c[5] * c[3] - c[4] * x, i.cofactor[5] = c[3] * c[4] - c[5] * y;
    return i;
}

/// The derivative of the cofactor of C by C, as d(cof)_k = sum_l t[k][l] dC_l over tensor components.
VISVIVA_INLINE void add_cofactor_gradient(V factor, const V* c, V* d) {
    const V x = factor * (1.0 + c[0]), y = factor * (1.0 + c[1]), z = factor * (1.0 + c[2]);
    const V p = factor * c[3], q = factor * c[4], r = factor * c[5];
    // Second derivatives of det C by the six components, off-diagonal pairs halved per component.
    d[packed(6, 0, 1)] += z, d[packed(6, 0, 2)] += y, d[packed(6, 1, 2)] += x;
    d[packed(6, 0, 4)] -= q, d[packed(6, 1, 5)] -= r, d[packed(6, 2, 3)] -= p;
    d[packed(6, 3, 3)] -= 0.5 * z, d[packed(6, 4, 4)] -= 0.5 * x, d[packed(6, 5, 5)] -= 0.5 * y;
    d[packed(6, 3, 4)] += 0.5 * r, d[packed(6, 4, 5)] += 0.5 * p, d[packed(6, 3, 5)] += 0.5 * q;
}

template <bool second>
VISVIVA_INLINE void hooke(const V* c, const V* p, Response& r) {
    const V trace = 0.5 * (c[0] + c[1] + c[2]);
    for (int k = 0; k < 6; ++k) r.s[k] = 0.5 * (p[1] * c[k] + (k < 3 ? p[0] * trace : V{}));
    r.W = 0.5 * contract(r.s, c);
    if constexpr (second) {
        clear(r.d, 21);
        for (int a = 0; a < 3; ++a)
            for (int b = a; b < 3; ++b) r.d[packed(6, a, b)] = 0.25 * p[0];
        for (int a = 0; a < 6; ++a) r.d[packed(6, a, a)] += (a < 3 ? 0.5 : 0.25) * p[1];
    }
}

/// Energies of invariants: the chain rule through their gradients.
template <int n, bool second, class Energy>
VISVIVA_INLINE void from_invariants(const V* c, const V* fibre, Energy&& energy_of, Response& r) {
    using J = Jet<n, second>;
    const Invariants inv = invariants(c);
    J i[n];
    i[0] = J::variable(inv.i1, 0), i[1] = J::variable(inv.i2, 1), i[2] = J::variable(inv.j, 2);
    if constexpr (n > 3)
        for (int f = 0; f < 2; ++f) i[3 + f] = J::variable(contract(fibre + 6 * f, c), 3 + f);
    const J w = energy_of(i);
    r.W = w.v;
    V g[n][6];
    const V jacobian = 1.0 + inv.j, half = 0.5 / jacobian;
    for (int k = 0; k < 6; ++k) {
        g[0][k] = broadcast(k < 3 ? 1.0 : 0.0);
        g[1][k] = (k < 3 ? 2.0 + inv.i1 : V{}) - c[k];
        g[2][k] = half * inv.cofactor[k];
        if constexpr (n > 3) g[3][k] = fibre[k], g[4][k] = fibre[6 + k];
    }
    for (int k = 0; k < 6; ++k) {
        r.s[k] = V{};
        for (int a = 0; a < n; ++a) r.s[k] += w.g[a] * g[a][k];
    }
    if constexpr (second) {
        clear(r.d, 21);
        for (int k = 0; k < 6; ++k) {
            V row[n];
            for (int a = 0; a < n; ++a) {
                row[a] = V{};
                for (int b = 0; b < n; ++b)
                    row[a] += w.h[a < b ? packed(n, a, b) : packed(n, b, a)] * g[b][k];
            }
            row[2] -= (w.g[2] / jacobian) * g[2][k];  // of J = sqrt(det C)
            for (int l = k; l < 6; ++l)
                for (int a = 0; a < n; ++a) r.d[packed(6, k, l)] += row[a] * g[a][l];
        }
        // second gradients of I2 and det C
        for (int a = 0; a < 3; ++a)
            for (int b = a + 1; b < 3; ++b) r.d[packed(6, a, b)] += w.g[1];
        for (int a = 3; a < 6; ++a) r.d[packed(6, a, a)] -= 0.5 * w.g[1];
        add_cofactor_gradient(half * w.g[2], c, r.d);
    }
}

/// Kirchhoff stress and its moduli (upper triangle by rows): what C and its functions become when both sides
/// are pushed to the current configuration. There C is b b, C^-1 is I, and I is b.
/// Plain moduli are lambda and mu alone.
template <bool plain>
struct SpatialResponse {
    V tau[6], c[plain ? 2 : 21];
};

/// The same from b - I of isotropic energies.
template <bool plain, class Energy>
VISVIVA_INLINE void from_left_invariants(const V* e, Energy&& energy_of, SpatialResponse<plain>& r) {
    using J = Jet<3, true>;
    const Invariants inv = invariants(e);
    const J i[3] = {J::variable(inv.i1, 0), J::variable(inv.i2, 1), J::variable(inv.j, 2)};
    const J w = energy_of(i);
    V b[6], g[6];  // gradients of I1 and I2; that of J is J / 2 times the identity
    const V half = 0.5 * (1.0 + inv.j), first = 1.0 + inv.i1;
    VISVIVA_FLATTEN
    for (int k = 0; k < 6; ++k) {
        const int m = voigt_a[k], n = voigt_b[k];
        b[k] = e[k] + (k < 3 ? 1.0 : 0.0);
        g[k] = first * e[k] + (k < 3 ? 2.0 + inv.i1 : V{});
        VISVIVA_FLATTEN
        for (int l = 0; l < 3; ++l) g[k] -= e[voigt[m][l]] * e[voigt[l][n]];
    }
    const V w3 = half * w.g[2];
    VISVIVA_FLATTEN
    for (int k = 0; k < 6; ++k) r.tau[k] = 2.0 * (w.g[0] * b[k] + w.g[1] * g[k] + (k < 3 ? w3 : V{}));
    const V h02 = half * w.h[2], h12 = half * w.h[4], h22 = half * (half * w.h[5] + 0.5 * w.g[2]);
    if constexpr (plain) {
        r.c[0] = 4.0 * h22, r.c[1] = -2.0 * w3;
        return;
    }
    VISVIVA_FLATTEN
    for (int k = 0; k < 6; ++k) {
        const V of_b = w.h[0] * b[k] + w.h[1] * g[k] + (k < 3 ? h02 : V{});
        const V of_g = w.h[1] * b[k] + w.h[3] * g[k] + (k < 3 ? h12 : V{});
        const V of_j = h02 * b[k] + h12 * g[k] + (k < 3 ? h22 : V{});
        VISVIVA_FLATTEN
        for (int l = k; l < 6; ++l) {
            const V bb = 0.5 * (b[voigt[voigt_a[k]][voigt_a[l]]] * b[voigt[voigt_b[k]][voigt_b[l]]] +
                                b[voigt[voigt_a[k]][voigt_b[l]]] * b[voigt[voigt_b[k]][voigt_a[l]]]);
            V sum = of_b * b[l] + of_g * g[l] + w.g[1] * (b[k] * b[l] - bb) + (l < 3 ? of_j : V{});
            if (k == l) sum -= (k < 3 ? 1.0 : 0.5) * w3;
            r.c[packed(6, k, l)] = 4.0 * sum;
        }
    }
}

/// Principal values and directions (columns of n) of a symmetric tensor by cyclic Jacobi rotations.
VISVIVA_INLINE void principal(const V* c, V* value, V n[3][3]) {
    V a[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) a[i][j] = c[voigt[i][j]], n[i][j] = broadcast(i == j ? 1.0 : 0.0);
    constexpr int pairs[3][2] = {{0, 1}, {1, 2}, {0, 2}};
    for (int sweep = 0; sweep < 7; ++sweep)
        for (const auto& pq : pairs) {
            const int p = pq[0], q = pq[1];
            const VI zero = vabs(a[p][q]) < 1e-300;
            const V theta = 0.5 * (a[q][q] - a[p][p]) / select(zero, broadcast(1.0), a[p][q]);
            const V size = 1.0 / (vabs(theta) + vsqrt(1.0 + theta * theta));
            const V t = select(zero, V{}, select(theta < 0.0, -size, size));
            const V cosine = 1.0 / vsqrt(1.0 + t * t), sine = t * cosine;
            for (int k = 0; k < 3; ++k) {
                const V x = a[k][p], y = a[k][q];
                a[k][p] = cosine * x - sine * y, a[k][q] = sine * x + cosine * y;
            }
            for (int k = 0; k < 3; ++k) {
                const V x = a[p][k], y = a[q][k];
                a[p][k] = cosine * x - sine * y, a[q][k] = sine * x + cosine * y;
                const V u = n[k][p], w = n[k][q];
                n[k][p] = cosine * u - sine * w, n[k][q] = sine * u + cosine * w;
            }
        }
    for (int k = 0; k < 3; ++k) value[k] = a[k][k];
}

/// Two principal values that count as one, and the slope between them there.
struct Coinciding {
    VI close;
    V slope;
};

/// Gradients along principal directions n of an energy w of principal values e; `coincide(a, b, h)` tells
/// where two of them are one, h their mixed second derivative.
template <bool second, class Coincide>
VISVIVA_INLINE void along_directions(const Jet<3, second>& w, const V* e, const V n[3][3],
                                     Coincide&& coincide, Response& r) {
    r.W = w.v;
    V m[3][3][6];  // sym(n_a x n_b)
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int k = 0; k < 6; ++k)
                m[a][b][k] =
                    0.5 * (n[voigt_a[k]][a] * n[voigt_b[k]][b] + n[voigt_b[k]][a] * n[voigt_a[k]][b]);
    for (int k = 0; k < 6; ++k) r.s[k] = w.g[0] * m[0][0][k] + w.g[1] * m[1][1][k] + w.g[2] * m[2][2][k];
    if constexpr (second) {
        clear(r.d, 21);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) {
                const V h = w.h[a < b ? packed(3, a, b) : packed(3, b, a)];
                const V gap = e[a] - e[b];
                const Coinciding one = coincide(a, b, h);
                const V slope =
                    select(one.close, one.slope, (w.g[a] - w.g[b]) / select(one.close, broadcast(1.0), gap));
                for (int k = 0; k < 6; ++k)
                    for (int l = k; l < 6; ++l) {
                        r.d[packed(6, k, l)] += h * m[a][a][k] * m[b][b][l];
                        if (a != b) r.d[packed(6, k, l)] += slope * m[a][b][k] * m[a][b][l];
                    }
            }
    }
}

/// Energies of principal stretches.
template <bool second, class Energy>
VISVIVA_INLINE void from_stretches(const V* c, Energy&& energy_of, Response& r) {
    using J = Jet<3, second>;
    V e[3], n[3][3];
    principal(c, e, n);
    const J i[3] = {J::variable(e[0], 0), J::variable(e[1], 1), J::variable(e[2], 2)};
    const J w = energy_of(i);
    auto coincide = [&](int a, int b, const V& h) -> Coinciding {
        return {vabs(e[a] - e[b]) < 1e-6 * (2.0 + e[a] + e[b]), w.h[packed(3, a, a)] - h};
    };
    along_directions<second>(w, e, n, coincide, r);
}

// Not inlined: it is called from many places, and eight evaluations outweigh a call.
template <bool second>
__attribute__((noinline)) void respond(MaterialKind kind, const V* c, const V* p, Response& r) {
    switch (kind) {
        case MaterialKind::hooke:
            hooke<second>(c, p, r);
            break;
        case MaterialKind::ogden:
            from_stretches<second>(c, [&](const auto* e) { return ogden(e, p); }, r);
            break;
        case MaterialKind::hencky:
            from_stretches<second>(c, [&](const auto* e) { return hencky(e, p); }, r);
            break;
        case MaterialKind::holzapfel:
            from_invariants<5, second>(c, p + 6, [&](const auto* i) { return holzapfel(i, p); }, r);
            break;
        default:
            with_energy(kind, p, [&](auto energy) { from_invariants<3, second>(c, p, energy, r); });
    }
}

template <bool plain>
__attribute__((noinline)) void respond_in_space(MaterialKind kind, const V* e, const V* p,
                                                SpatialResponse<plain>& r) {
    with_energy(kind, p, [&](auto energy) { from_left_invariants(e, energy, r); });
}

}  // namespace visviva::VISVIVA_ISA
