// The number type of the element kernels: one element per lane.
// Included only by the translation units that are compiled once per instruction set, inside their namespace.
#pragma once

#ifndef VISVIVA_ISA
#error "simd.hpp belongs to the kernels: compile with -DVISVIVA_ISA=... -DVISVIVA_WIDTH=..."
#endif

namespace visviva::VISVIVA_ISA {

constexpr int W = VISVIVA_WIDTH;
typedef double V __attribute__((vector_size(W * sizeof(double)), aligned(8)));
typedef long long VI __attribute__((vector_size(W * sizeof(double)), aligned(8)));

#define VISVIVA_INLINE inline __attribute__((always_inline))
// Before loops whose indices must be known at compile time for their arrays to live in registers.
#if defined(__clang__)
#define VISVIVA_FLATTEN _Pragma("clang loop unroll(full)")
#else
#define VISVIVA_FLATTEN _Pragma("GCC unroll 36")
#endif

VISVIVA_INLINE V broadcast(double a) { return V{} + a; }
VISVIVA_INLINE V vload(const double* p) { return *reinterpret_cast<const V*>(p); }
VISVIVA_INLINE void vstore(double* p, V a) { *reinterpret_cast<V*>(p) = a; }
// Lane by lane: the processors' own gathers take longer (Intel's since they are kept from leaking data).
VISVIVA_INLINE V gather(const double* x, const int* index) {
    V a;
    for (int l = 0; l < W; ++l) a[l] = x[index[l]];
    return a;
}
// A loop over references to the entries of an array whose length is a template's would take them as aligned
// to their size.
VISVIVA_INLINE void clear(V* a, int n) {
    for (int k = 0; k < n; ++k) a[k] = V{};
}
VISVIVA_INLINE V select(VI mask, V a, V b) { return mask ? a : b; }
/// Whether a mask is set in all lanes.
VISVIVA_INLINE bool all(VI mask) {
    long long found = -1;
    for (int l = 0; l < W; ++l) found &= mask[l];
    return found != 0;
}
VISVIVA_INLINE bool any(VI mask) {
    long long found = 0;
    for (int l = 0; l < W; ++l) found |= mask[l];
    return found != 0;
}
VISVIVA_INLINE V vabs(V a) { return a < 0.0 ? -a : a; }
VISVIVA_INLINE V vmax(V a, V b) { return a > b ? a : b; }
VISVIVA_INLINE V vsqrt(V a) {
    for (int l = 0; l < W; ++l) a[l] = __builtin_sqrt(a[l]);
    return a;
}
VISVIVA_INLINE V vsin(V a) {
    for (int l = 0; l < W; ++l) a[l] = __builtin_sin(a[l]);
    return a;
}
VISVIVA_INLINE V vcos(V a) {
    for (int l = 0; l < W; ++l) a[l] = __builtin_cos(a[l]);
    return a;
}

// log(1 + x) for x > -1 to about one unit in the last place: 1 + x = 2^k (1 + f) with 1 + f between sqrt(1/2)
// and sqrt(2), log(1 + f) by its odd series in f / (2 + f) (coefficients: Remez fit of the C library's
// classic).
VISVIVA_INLINE V vlog1p(V x) {
    const V u = 1.0 + x;
    const VI bits = (VI)u + (0x3ff0000000000000LL - 0x3fe6a09e667f3bcdLL);
    const VI k = (bits >> 52) - 1023;
    const V m = (V)((bits & 0x000fffffffffffffLL) + 0x3fe6a09e667f3bcdLL);
    const V lost = (x - (u - 1.0)) / u;  // what rounding took from 1 + x
    const V f = select(k == 0, x, m - 1.0), kd = __builtin_convertvector(k, V);
    const V s = f / (2.0 + f), z = s * s, half = 0.5 * f * f;
    const V series =
        z * (6.666666666666735130e-01 +
             z * (3.999999999940941908e-01 +
                  z * (2.857142874366239149e-01 +
                       z * (2.222219843214978396e-01 +
                            z * (1.818357216161805012e-01 +
                                 z * (1.531383769920937332e-01 + z * 1.479819860511658591e-01))))));
    const V tail = s * (half + series) + (kd * 1.90821492927058770002e-10 + select(k == 0, V{}, lost));
    return kd * 6.93147180369123816490e-01 - ((half - tail) - f);
}

// exp(x): x = k ln 2 + r, exp(r) by its Taylor polynomial to r^13.
VISVIVA_INLINE V vexp(V x) {
    x = select(x > 700.0, broadcast(700.0), select(x < -700.0, broadcast(-700.0), x));
    const V shifted = x * 1.44269504088896338700 + 6755399441055744.0;  // 1.5 * 2^52: rounds to an integer
    const V kd = shifted - 6755399441055744.0;
    const VI k = (VI)shifted - 0x4338000000000000LL;
    const V r = (x - kd * 6.93147180369123816490e-01) - kd * 1.90821492927058770002e-10;
    V p = broadcast(1.0 / 6227020800.0);
    const double c[12] = {1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880,
                          1.0 / 40320,     1.0 / 5040,     1.0 / 720,     1.0 / 120,
                          1.0 / 24,        1.0 / 6,        0.5,           1.0};
    for (int i = 0; i < 12; ++i) p = p * r + c[i];
    return (p * r + 1.0) * (V)((k + 1023) << 52);
}

}  // namespace visviva::VISVIVA_ISA
