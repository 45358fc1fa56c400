// Passes over the state vectors of an iteration.
#pragma once
#include "simd.hpp"

namespace visviva::VISVIVA_ISA {

// dx += d, x1 = x + dx; the largest |d| * weight, infinite if any is not a number.
double vector_update(int n, const double* d, const double* weight, const double* x, double* dx, double* x1) {
    double largest = 0, broken = 0;
    for (int i = 0; i < n; ++i) {
        dx[i] += d[i];
        x1[i] = x[i] + dx[i];
        const double size = (d[i] < 0 ? -d[i] : d[i]) * weight[i];
        largest = size > largest ? size : largest;
        broken += size - size;  // zero, unless infinite or not a number
    }
    return broken == 0 ? largest : 1.0 / 0.0;
}

void vector_affine(int n, double factor, const double* x, const double* base, double* y) {
    for (int i = 0; i < n; ++i) y[i] = base[i] + factor * x[i];
}

}  // namespace visviva::VISVIVA_ISA
