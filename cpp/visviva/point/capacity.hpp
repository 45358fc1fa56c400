// Heat capacities that depend on the temperature: entropy and heat content of them, and back.
#pragma once
#include "visviva/base/jet.hpp"

namespace visviva::VISVIVA_ISA {

/// c(theta) = c (1 + slope (theta - theta0)) + sum_k b_k max(0, theta - t_k): linear, or with bends as tables
/// have. The entropy at one strain is H with H' = c(theta) / theta, the heat content U with U' = c(theta),
/// both zero at theta0.
struct Capacity {
    static constexpr int n_bends = 6, n_par = 1 + 2 * n_bends;  // slope, then t_k and b_k
    V c, zero;
    const V* p;
    bool is_constant = true;

    Capacity(V capacity, V at, const V* par) : c(capacity), zero(at), p(par) {
        for (int k = 0; k < n_par; k += 2)  // the slope, and those behind bends
            is_constant = is_constant && all(p[k] == 0.0);
    }
    V at(V rise) const {
        V sum = c * (1.0 + p[0] * rise);
        for (int k = 1; !is_constant && k < n_par; k += 2) sum += p[k + 1] * vmax(zero + rise - p[k], V{});
        return sum;
    }
    /// dc / dtheta
    V bend(V rise) const {
        V sum = c * p[0];
        for (int k = 1; k < n_par; k += 2) sum += select(zero + rise > p[k], p[k + 1], V{});
        return sum;
    }
    V content(V rise) const {
        V sum = c * rise * (1.0 + 0.5 * p[0] * rise);
        for (int k = 1; !is_constant && k < n_par; k += 2) {
            const V here = vmax(zero + rise - p[k], V{}), there = vmax(zero - p[k], V{});
            sum += 0.5 * p[k + 1] * (here * here - there * there);
        }
        return sum;
    }
    /// H at theta0 e^y.
    V entropy(V y) const {
        V sum = c * ((1.0 - p[0] * zero) * y + p[0] * zero * expm1(y));
        for (int k = 1; k < n_par; k += 2)
            sum += p[k + 1] * (bent(p[k], zero * (1.0 + expm1(y))) - bent(p[k], zero));
        return sum;
    }
    static V bent(V t, V theta) {
        const V rise = vmax(theta - t, V{}), safe = select(t > 0.0, t, broadcast(1.0));
        return rise - t * vlog1p(rise / safe);
    }
    /// theta - theta0 at the entropy H.
    VISVIVA_INLINE V rise_of(V H) const { return is_constant ? zero * expm1(H / c) : sought(H); }
    /// By Newton's method in the logarithm of theta.
    __attribute__((noinline)) V sought(V H) const {
        V y = H / c;
        for (int k = 0; k < 60; ++k) {
            const V step = (entropy(y) - H) / at(zero * expm1(y));
            y -= select(step > 1.0, broadcast(1.0), select(step < -1.0, broadcast(-1.0), step));
            bool small = true;
            for (int l = 0; l < W; ++l) small = small && !(step[l] > 1e-15) && !(step[l] < -1e-15);
            if (small) break;
        }
        return zero * expm1(y);
    }
    /// Gain of the heat content where the entropy H grows by `more`.
    V increase(V H, V more) const {
        if (is_constant) return c * (zero + zero * expm1(H / c)) * expm1(more / c);
        return content(rise_of(H + more)) - content(rise_of(H));
    }
};

}  // namespace visviva::VISVIVA_ISA
