// Passes over the state vectors of an iteration.
#pragma once
#include "visviva/base/simd.hpp"

namespace visviva::VISVIVA_ISA {

// The numbers from p on, as many of the lanes as are left; the others are zero.
VISVIVA_INLINE V load(const double* p, int left) {
    if (left >= W) return vload(p);
    V a = broadcast(0.0);
    for (int l = 0; l < left; ++l) a[l] = p[l];
    return a;
}

VISVIVA_INLINE void store(double* p, V a, int left) {
    if (left >= W) return vstore(p, a);
    for (int l = 0; l < left; ++l) p[l] = a[l];
}

VISVIVA_INLINE double greatest(V a) {
    double largest = a[0];
    for (int l = 1; l < W; ++l) largest = a[l] > largest ? a[l] : largest;
    return largest;
}

// dx += d, x1 = x + dx; the largest |d| * weight, infinite if any is not a number.
double vector_update(int n, const double* d, const double* weight, const double* x, double* dx, double* x1) {
    V largest = broadcast(0.0), broken = largest;
    for (int i = 0; i < n; i += W) {
        const V change = load(d + i, n - i), sum = load(dx + i, n - i) + change;
        store(dx + i, sum, n - i);
        store(x1 + i, load(x + i, n - i) + sum, n - i);
        const V size = vabs(change) * load(weight + i, n - i);
        largest = vmax(size, largest);
        broken += size - size;  // zero, unless infinite or not a number
    }
    for (int l = 0; l < W; ++l)
        if (broken[l] != 0) return 1.0 / 0.0;
    return greatest(largest);
}

// The largest |a| * weight.
double vector_largest(int n, const double* a, const double* weight) {
    V largest = broadcast(0.0);
    for (int i = 0; i < n; i += W)
        largest = vmax(vabs(load(a + i, n - i)) * load(weight + i, n - i), largest);
    return greatest(largest);
}

void vector_affine(int n, double factor, const double* x, const double* base, double* y) {
    for (int i = 0; i < n; ++i) y[i] = base[i] + factor * x[i];
}

// d[0] = x, d[k] = the change of d[k - 1], k < n_d. The largest |change of d[k]| * weight, and the largest
// |d[k] + its predecessor| * weight.
void vector_differences(int n, int n_d, const double* x, const double* weight, double* const* d,
                        double* change, double* sum) {
    V changes[8], sums[8];
    for (int k = 0; k < n_d; ++k) changes[k] = sums[k] = broadcast(0.0);
    for (int i = 0; i < n; i += W) {
        const V w = load(weight + i, n - i);
        V value = load(x + i, n - i);
        for (int k = 0; k < n_d; ++k) {
            const V last = load(d[k] + i, n - i);
            store(d[k] + i, value, n - i);
            sums[k] = vmax(vabs(value + last) * w, sums[k]);
            value -= last;
            changes[k] = vmax(vabs(value) * w, changes[k]);
        }
    }
    for (int k = 0; k < n_d; ++k) change[k] = greatest(changes[k]), sum[k] = greatest(sums[k]);
}

}  // namespace visviva::VISVIVA_ISA
