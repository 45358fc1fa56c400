// Values with first and second derivatives by n variables, one evaluation per lane: forward differentiation
// of energies in their few invariants.
#pragma once
#include "visviva/base/simd.hpp"

namespace visviva::VISVIVA_ISA {

/// Place of (a, b), a <= b, in the packed upper triangle of a symmetric n x n matrix.
constexpr int packed(int n, int a, int b) { return a * n - a * (a - 1) / 2 + (b - a); }

template <int n, bool second>
struct Jet {
    static constexpr int size = n;
    V v, g[n], h[second ? n * (n + 1) / 2 : 1];

    VISVIVA_INLINE static Jet variable(V value, int k) {
        Jet u = constant(value);
        u.g[k] = broadcast(1.0);
        return u;
    }
    VISVIVA_INLINE static Jet constant(V value) {
        Jet u;
        u.v = value;
        clear(u.g, n);
        clear(u.h, second ? n * (n + 1) / 2 : 1);
        return u;
    }
};

/// f(u) from the value and the derivatives of f at u.
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> chain(const Jet<n, second>& u, V f, V f1, V f2) {
    Jet<n, second> r;
    r.v = f;
    for (int a = 0; a < n; ++a) r.g[a] = f1 * u.g[a];
    if constexpr (second)
        for (int a = 0; a < n; ++a)
            for (int b = a; b < n; ++b)
                r.h[packed(n, a, b)] = f1 * u.h[packed(n, a, b)] + f2 * u.g[a] * u.g[b];
    return r;
}

template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator+(const Jet<n, second>& u, const Jet<n, second>& w) {
    Jet<n, second> r;
    r.v = u.v + w.v;
    for (int a = 0; a < n; ++a) r.g[a] = u.g[a] + w.g[a];
    if constexpr (second)
        for (int k = 0; k < n * (n + 1) / 2; ++k) r.h[k] = u.h[k] + w.h[k];
    return r;
}

template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator*(const Jet<n, second>& u, const Jet<n, second>& w) {
    Jet<n, second> r;
    r.v = u.v * w.v;
    for (int a = 0; a < n; ++a) r.g[a] = u.g[a] * w.v + u.v * w.g[a];
    if constexpr (second)
        for (int a = 0; a < n; ++a)
            for (int b = a; b < n; ++b) {
                const int k = packed(n, a, b);
                r.h[k] = u.h[k] * w.v + u.v * w.h[k] + u.g[a] * w.g[b] + u.g[b] * w.g[a];
            }
    return r;
}

template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator*(V c, const Jet<n, second>& u) {
    return chain(u, c * u.v, c, V{});
}
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator*(double c, const Jet<n, second>& u) {
    return broadcast(c) * u;
}
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator+(const Jet<n, second>& u, V c) {
    Jet<n, second> r = u;
    r.v += c;
    return r;
}
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator+(const Jet<n, second>& u, double c) {
    return u + broadcast(c);
}
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator-(const Jet<n, second>& u, const Jet<n, second>& w) {
    return u + broadcast(-1.0) * w;
}

template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator-(const Jet<n, second>& u) {
    return -1.0 * u;
}
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator-(const Jet<n, second>& u, double c) {
    return u + -c;
}
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator/(const Jet<n, second>& u, const Jet<n, second>& w) {
    const V i = 1.0 / w.v;
    return u * chain(w, i, -i * i, 2.0 * i * i * i);
}

template <int n, bool second>
VISVIVA_INLINE Jet<n, second> operator-(const Jet<n, second>& u, V c) {
    return u + -c;
}

VISVIVA_INLINE V inverse(V u) { return 1.0 / u; }
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> inverse(const Jet<n, second>& u) {
    const V i = 1.0 / u.v;
    return chain(u, i, -i * i, 2.0 * i * i * i);
}

VISVIVA_INLINE V root(V u) { return vsqrt(u); }
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> root(const Jet<n, second>& u) {
    const V s = vsqrt(u.v), ds = 0.5 / s;
    return chain(u, s, ds, -0.5 * ds / u.v);
}

VISVIVA_INLINE V log1p(V u) { return vlog1p(u); }
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> log1p(const Jet<n, second>& u) {
    const V i = 1.0 / (1.0 + u.v);
    return chain(u, vlog1p(u.v), i, -i * i);
}

/// exp(u) - 1
VISVIVA_INLINE V expm1(V u) {
    const V small = u * (1.0 + u * (0.5 + u * (1.0 / 6 + u * (1.0 / 24 + u * (1.0 / 120 + u / 720.0)))));
    return select(vabs(u) < 1e-2, small, vexp(u) - 1.0);
}
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> expm1(const Jet<n, second>& u) {
    const V e = expm1(u.v);
    return chain(u, e, e + 1.0, e + 1.0);
}

/// (1 + u)^a - 1, accurate for small u
VISVIVA_INLINE V powm1(V u, V a) { return expm1(a * vlog1p(u)); }
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> powm1(const Jet<n, second>& u, V a) {
    const V p = powm1(u.v, a), i = 1.0 / (1.0 + u.v), p1 = a * (p + 1.0) * i;
    return chain(u, p, p1, (a - 1.0) * p1 * i);
}

/// 1 where it is positive, 0 elsewhere
VISVIVA_INLINE V is_positive(V u) { return select(u > 0.0, broadcast(1.0), V{}); }
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> is_positive(const Jet<n, second>& u) {
    return Jet<n, second>::constant(is_positive(u.v));
}

/// The positive part
VISVIVA_INLINE V positive(V u) { return vmax(u, V{}); }
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> positive(const Jet<n, second>& u) {
    return chain(u, positive(u.v), is_positive(u.v), V{});
}

}  // namespace visviva::VISVIVA_ISA
