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

VISVIVA_INLINE V broadcast(double a) { return V{} + a; }
VISVIVA_INLINE V vload(const double* p) { return *reinterpret_cast<const V*>(p); }
VISVIVA_INLINE void vstore(double* p, V a) { *reinterpret_cast<V*>(p) = a; }
VISVIVA_INLINE V gather(const double* x, const int* index) {
#if defined(__AVX512F__)
    typedef int I8 __attribute__((vector_size(32), aligned(4)));
    return (V)__builtin_ia32_gathersiv8df((V){}, x, *reinterpret_cast<const I8*>(index), (char)-1, 8);
#else
    V a;
    for (int l = 0; l < W; ++l) a[l] = x[index[l]];
    return a;
#endif
}
VISVIVA_INLINE V select(VI mask, V a, V b) { return mask ? a : b; }
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

}  // namespace visviva::VISVIVA_ISA
