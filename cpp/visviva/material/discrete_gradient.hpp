// The discrete gradient of an energy of any number of strains, and its tangent (Gonzalez 1996; partitioned as
// by Gross & Betsch 2011).
#pragma once
#include "visviva/base/jet.hpp"

namespace visviva::VISVIVA_ISA {

/// An energy of n strains, its derivatives s and second derivatives d [n][n] by them.
template <int n>
struct Potential {
    V W, s[n], d[n * n];
};

/// The potential of an energy that is written once over any number type.
template <int n, bool second, class Energy>
VISVIVA_INLINE void differentiate(const V* e, Energy&& energy, Potential<n>& p) {
    Jet<n, second> x[n];
    for (int k = 0; k < n; ++k) x[k] = Jet<n, second>::variable(e[k], k);
    const Jet<n, second> w = energy(x);
    p.W = w.v;
    for (int a = 0; a < n; ++a) {
        p.s[a] = w.g[a];
        for (int b = a; second && b < n; ++b) p.d[n * a + b] = p.d[n * b + a] = w.h[packed(n, a, b)];
    }
}

/// One block of strains goes from e0 to e1 while the others rest: share * D adds up in s and T = ds/de1, with
/// s . (e1 - e0) = W(e1) - W(e0). `moves` and `ends` mark the strains of the block, and those of the others
/// that rest at their ends.
///
/// s = W'(em) + f w d, d = e1 - e0, with f d.wd = b = W1 - W0 - W'(em).d, weights w. Where that difference
/// would drown in rounding it is Simpson's rule in the gradients, and nothing where it is below the rounding
/// of the energy or where the strains hardly change: what is left out is of third order, what rounding leaves
/// of f d and its gradient is not.
template <bool tangent, class Energy, int n = Energy::n>
void add_discrete_gradient(const Energy& energy, double share, const bool* moves, const bool* ends,
                           const V* e0, const V* e1, V* s, V* T) {
    V from[n], to[n], middle[n], d[n], first{}, second{}, simpson{}, size{}, place{}, work{}, scale{};
    for (int k = 0; k < n; ++k) {
        from[k] = ends[k] ? e1[k] : e0[k];
        to[k] = moves[k] ? e1[k] : from[k];
        middle[k] = 0.5 * (from[k] + to[k]), d[k] = to[k] - from[k];
    }
    Potential<n> m, p0, p1;
    energy.template evaluate<tangent>(middle, m);
    V f{}, inverse{};
    if (!energy.is_quadratic()) {
        energy.template evaluate<false>(from, p0), energy.template evaluate<false>(to, p1);
        for (int k = 0; k < n; ++k) {
            if (!moves[k] || Energy::weight(k) == 0.0) continue;
            const double w = Energy::weight(k);
            const V change = p1.s[k] - p0.s[k], bend = change - 2.0 * (m.s[k] - p0.s[k]);
            first += change * change / w, second += bend * bend / w;
            size += w * d[k] * d[k], scale += m.s[k] * m.s[k] / w;
            place += w * (from[k] * from[k] + to[k] * to[k]);
        }
        for (int k = 0; k < n; ++k) {
            if (!moves[k]) continue;
            simpson += (p1.s[k] - 2.0 * m.s[k] + p0.s[k]) * d[k], work += m.s[k] * d[k];
        }
        const V b = select(second <= 1e-8 * first, simpson / 6.0, p1.W - p0.W - work);
        const VI idle = (size <= 1e-20 * place) | (b * b <= 1e-30 * scale * place);
        inverse = select(idle, V{}, 1.0 / select(idle, broadcast(1.0), size));
        f = b * inverse;
    }
    for (int k = 0; k < n; ++k) {
        if (!moves[k]) continue;
        s[k] += share * (m.s[k] + (Energy::weight(k) * f) * d[k]);
        if constexpr (tangent) T[n * k + k] += (share * Energy::weight(k)) * f;
    }
    if constexpr (tangent)
        for (int j = 0; j < n; ++j) {
            if (!moves[j] && !ends[j]) continue;
            const double half = moves[j] ? 0.5 : 1.0;
            V df = p1.s[j] - (moves[j] ? m.s[j] : p0.s[j]);
            for (int k = 0; k < n; ++k)
                if (moves[k]) df -= half * m.d[n * k + j] * d[k];
            df = inverse * (df - (moves[j] ? 2.0 * Energy::weight(j) : 0.0) * f * d[j]);
            if (energy.is_quadratic()) df = V{};
            for (int k = 0; k < n; ++k)
                if (moves[k]) T[n * k + j] += share * (half * m.d[n * k + j] + Energy::weight(k) * d[k] * df);
        }
}

/// s with s . (e1 - e0) = W(e1) - W(e0), and T = ds/de1. Several blocks of strains (Energy::block) go one
/// after the other, in both orders, so that each keeps its own units: the mean is of second order.
template <bool tangent, class Energy, int n = Energy::n>
void discrete_gradient(const Energy& energy, const V* e0, const V* e1, V* s, V* T) {
    for (int k = 0; k < n; ++k) s[k] = V{};
    for (int k = 0; tangent && k < n * n; ++k) T[k] = V{};
    constexpr int orders = Energy::n_blocks > 1 ? 2 : 1;
    for (int forward = 0; forward < orders; ++forward)
        for (int block = 0; block < Energy::n_blocks; ++block) {
            bool moves[n], ends[n];
            for (int k = 0; k < n; ++k) {
                moves[k] = Energy::block(k) == block;
                ends[k] = forward ? Energy::block(k) < block : Energy::block(k) > block;
            }
            add_discrete_gradient<tangent>(energy, 1.0 / orders, moves, ends, e0, e1, s, T);
        }
}

}  // namespace visviva::VISVIVA_ISA
