// Heat capacities that depend on the temperature: entropy and heat content of them, and back.
#pragma once
#include "visviva/base/jet.hpp"
#include "visviva/material/wrapped.hpp"

namespace visviva::VISVIVA_ISA {

/// c(theta) = c (1 + slope (theta - theta0)) + sum_k b_k max(0, theta - t_k): linear, or with bends as tables
/// have, t_k in order. The entropy at one strain is H with H' = c(theta) / theta, the heat content U with U'
/// = c(theta), both zero at theta0. What they gain is summed over the pieces between bends: sums over bends
/// would lose, far above a narrow hump, the digits of what its bends have in common.
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
        V sum = c * (1.0 + p[0] * rise), m{}, v{};
        for (int k = 1; !is_constant && k < n_par; k += 2) {
            m = k + 2 < n_par ? m + p[k + 1] : V{};  // constant behind the last bend, not but for rounding
            const V end = k + 2 < n_par ? p[k + 2] : broadcast(1e300), theta = zero + rise;
            sum += select((theta >= p[k]) & (theta < end), v + m * (theta - p[k]), V{});
            v += m * (end - p[k]);
        }
        return sum;
    }
    /// dc / dtheta
    V bend(V rise) const {
        V sum = c * p[0];
        for (int k = 1; k < n_par; k += 2) sum += select(zero + rise > p[k], p[k + 1], V{});
        return sum;
    }
    /// Calls f(v, m, a, d) for the pieces v + m (theta - a) of what bends add that a change of the
    /// temperature passes, from a by d.
    template <class F>
    void for_pieces(V theta, V change, F&& f) const {
        V m{}, v{};
        for (int k = 1; !is_constant && k < n_par; k += 2) {
            m = k + 2 < n_par ? m + p[k + 1] : V{};  // constant behind the last bend, not but for rounding
            const V t = p[k], end = k + 2 < n_par ? p[k + 2] : broadcast(1e300), then = theta + change;
            const VI inside = (theta >= t) & (theta <= end) & (then >= t) & (then <= end);
            const V a = vmax(t, theta < end ? theta : end), b = vmax(t, then < end ? then : end);
            f(v + m * (a - t), m, a, select(inside, change, b - a));
            v += m * (end - t);
        }
    }
    /// Gain of the content.
    V gain(V theta, V change) const {
        V sum = c * change * (1.0 + p[0] * ((theta - zero) + 0.5 * change));
        for_pieces(theta, change, [&](V v, V m, V, V d) { sum += d * (v + 0.5 * m * d); });
        return sum;
    }
    V content(V rise) const { return gain(zero, rise); }
    /// Gain of the entropy.
    V entropy(V theta, V change) const {
        V sum = c * ((1.0 - p[0] * zero) * vlog1p(change / theta) + p[0] * change);
        for_pieces(theta, change, [&](V v, V m, V a, V d) {
            const V x = d / select(a > 0.0, a, broadcast(1.0));
            sum += v * vlog1p(x) + m * a * less_logarithm(x);
        });
        return sum;
    }
    /// x - ln(1 + x)
    static V less_logarithm(V x) {
        V sum{};
        for (int k = 12; k > 1; --k) sum = (k % 2 ? -1.0 : 1.0) / k + x * sum;
        return select(vabs(x) < 0.03, x * x * sum, x - vlog1p(x));
    }
    /// The mean between two temperatures, which times their difference is what the content gains, and its
    /// derivative by the second.
    V mean(V from, V to, V& slope) const {
        const V change = to - from, here = at(to);
        const VI apart = change != 0.0;
        const V inverse = 1.0 / select(apart, change, broadcast(1.0)),
                found = select(apart, gain(zero + from, change) * inverse, here);
        slope = select(apart, (here - found) * inverse, 0.5 * bend(to));
        return found;
    }
    /// theta - theta0 at the entropy H.
    VISVIVA_INLINE V rise_of(V H) const { return is_constant ? zero * expm1(H / c) : sought(zero, H); }
    static V by_one(V y) { return select(y > 1.0, broadcast(1.0), select(y < -1.0, broadcast(-1.0), y)); }
    /// The change of a temperature where the entropy grows by `more`, by Newton's method in the logarithm of
    /// theta, within what is known to hold it.
    __attribute__((noinline)) V sought(V theta, V more) const {
        V low = broadcast(-700.0), high = broadcast(700.0), y = by_one(more / at(theta - zero));
        VI moving =
            vabs(y) >= 0.0;  // lanes that are not yet found; others rest, maybe at an end of what holds them
        for (int k = 0; k < 200 && any(moving); ++k) {
            // Across a narrow hump Newton's steps may go to and fro: from the tenth on every second halves.
            const VI halves = k > 8 && k % 2 ? (low > -700.0) & (high < 700.0) : (y <= low) | (y >= high);
            y = select(moving & halves, 0.5 * (low + high), y);
            const V change = theta * expm1(y), off = entropy(theta, change) - more;
            low = select(off < 0.0, y, low), high = select(off > 0.0, y, high);
            const V here = at(theta + change - zero), step = off / here,
                    tiny = 4e-16 * (vabs(y) + vabs(more) / here);
            y -= select(moving, by_one(step), V{});
            moving &= (vabs(step) > tiny) & (high - low > tiny);
        }
        return theta * expm1(y);
    }
    /// Gain of the heat content where the entropy H grows by `more`.
    V increase(V H, V more) const {
        if (is_constant) return c * (zero + zero * expm1(H / c)) * expm1(more / c);
        const V theta = zero + rise_of(H);
        return gain(theta, sought(theta, more));
    }
};

}  // namespace visviva::VISVIVA_ISA
