// Constant mass: residual, tangent, kinetic energy and momenta, W elements at a time.
#pragma once
#include "visviva/base/simd.hpp"
#include "visviva/term/inertia.hpp"

namespace visviva::VISVIVA_ISA {

void inertia_residual(const InertiaView& v, const Vectors& x, double* r) {
    const double* rate = v.order == 2 ? x.second_rate : x.rate;
    for (int base = 0; base < v.n; base += W) {
        const int n = v.n - base < W ? v.n - base : W;
        for (int p = 0; p < v.n_pairs; ++p) {
            const int a = v.pair[2 * p] * v.dim, b = v.pair[2 * p + 1] * v.dim;
            const V m = vload(v.mass + p * v.stride + base);
            for (int c = 0; c < v.dim; ++c) {
                const V f = m * gather(rate, v.index + (b + c) * v.stride + base);
                const int* index = v.index + (a + c) * v.stride + base;
                for (int l = 0; l < n; ++l) r[index[l]] += f[l];
            }
        }
    }
}

void inertia_tangent(const InertiaView& v, const Step& step, double* values) {
    const double factor = v.order == 2 ? step.motion[1][0] : step.transport[0][0];
    const long* position = reinterpret_cast<const long*>(v.position);
    for (int base = 0; base < v.n; base += W) {
        const int n = v.n - base < W ? v.n - base : W;
        for (int p = 0; p < v.n_pairs; ++p) {
            const V m = factor * vload(v.mass + p * v.stride + base);
            for (int c = 0; c < v.dim; ++c) {
                const long* at = position + static_cast<long>(p * v.dim + c) * v.stride + base;
                for (int l = 0; l < n; ++l) values[at[l]] += m[l];
            }
        }
    }
}

void inertia_ledger(const InertiaView& v, const double* x, const double* rate, const InertiaLedger& out) {
    for (int base = 0; base < v.n; base += W) {
        V energy = broadcast(0.0), momentum[6];
        clear(momentum, 6);
        for (int p = 0; p < v.n_pairs; ++p) {
            const int a = v.pair[2 * p], b = v.pair[2 * p + 1];
            const V m = vload(v.mass + p * v.stride + base);
            V f[3], va[3], xa[3];
            for (int c = 0; c < v.dim; ++c) {
                f[c] = m * gather(rate, v.index + (b * v.dim + c) * v.stride + base);
                va[c] = gather(rate, v.index + (a * v.dim + c) * v.stride + base);
                energy += 0.5 * f[c] * va[c];
            }
            if (v.dim == 1) continue;
            f[2] = v.dim == 3 ? f[2] : broadcast(0.0);
            xa[2] = broadcast(0.0);
            for (int c = 0; c < v.dim; ++c) xa[c] = gather(x, v.index + (a * v.dim + c) * v.stride + base);
            for (int c = 0; c < 3; ++c) {
                if (v.is_position[a]) momentum[c] += f[c];
                momentum[3 + c] += xa[(c + 1) % 3] * f[(c + 2) % 3] - xa[(c + 2) % 3] * f[(c + 1) % 3];
            }
        }
        vstore(out.energy + base, energy);
        for (int c = 0; c < 6; ++c) vstore(out.momentum + c * v.stride + base, momentum[c]);
    }
}

}  // namespace visviva::VISVIVA_ISA
