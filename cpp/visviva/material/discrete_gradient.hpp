// The discrete gradient of an energy of any number of strains, and its tangent (Gonzalez 1996; partitioned as
// by Gross & Betsch 2011). Energies say n, weight(k), n_blocks, block(k), is_quadratic(), evaluate<second>(e,
// potential).
#pragma once
#include "visviva/material/potential.hpp"
#include "visviva/term/step.hpp"

namespace visviva::VISVIVA_ISA {

/// Where the first block of strains stands: at e0, in the middle, at e1.
enum Place : int { at_start, in_middle, at_end };

/// What an energy takes from the first block of strains alone, found once at each of its places, if the
/// energy has a type `Shared` for it: it says share<second>(e, shared), evaluate<second>(shared, e,
/// potential) and increase(shared0, e0, shared1, e1). Second derivatives by these strains are asked for in
/// the middle alone.
template <bool tangent, class Energy>
struct Places {
    Places(const Energy&, const V*, const V*) {}
    template <bool second>
    VISVIVA_INLINE void evaluate(const Energy& energy, Place, const V* e, Potential<Energy::n>& p) const {
        energy.template evaluate<second>(e, p);
    }
    VISVIVA_INLINE V increase(const Energy& energy, Place, const V* from, Place, const V* to) const {
        return energy.increase(from, to);
    }
};
template <bool tangent, class Energy>
    requires requires { typename Energy::Shared; }
struct Places<tangent, Energy> {
    typename Energy::Shared at[3];
    Places(const Energy& energy, const V* e0, const V* e1) {
        V middle[Energy::n];
        for (int k = 0; k < Energy::n; ++k) middle[k] = 0.5 * (e0[k] + e1[k]);
        energy.template share<false>(e0, at[at_start]), energy.template share<false>(e1, at[at_end]);
        energy.template share<tangent>(middle, at[in_middle]);
    }
    template <bool second>
    VISVIVA_INLINE void evaluate(const Energy& energy, Place place, const V* e,
                                 Potential<Energy::n>& p) const {
        energy.template evaluate<second>(at[place], e, p);
    }
    VISVIVA_INLINE V increase(const Energy& energy, Place a, const V* from, Place b, const V* to) const {
        return energy.increase(at[a], from, at[b], to);
    }
};

/// All strains go from e0 to e1.
struct Whole {
    static constexpr bool moves(int) { return true; }
    static constexpr bool ends(int) { return false; }
};

/// One block of strains does, while the others rest: those before it at their ends and those behind it at
/// their starts, or the other way round.
template <class Energy>
struct Part {
    int block;
    bool forward;
    VISVIVA_INLINE bool moves(int k) const { return Energy::block(k) == block; }
    VISVIVA_INLINE bool ends(int k) const {
        return forward ? Energy::block(k) < block : Energy::block(k) > block;
    }
};

/// Place of the first block on a path: at its start, on the way, at its end.
template <class Path>
constexpr Place first_block(const Path& path, Place on_the_way) {
    return path.moves(0) ? on_the_way : path.ends(0) ? at_end : at_start;
}

/// W(to) - W(from): energies with a large part that hardly changes, such as the heat that a body holds, say
/// it without the digits which that part would take.
template <class Places, class Energy, class Path>
VISVIVA_INLINE V increase(const Places& places, const Energy& energy, const Path& path, const V* from,
                          const V* to, V before, V after) {
    if constexpr (requires { energy.increase(from, to); })
        return places.increase(energy, first_block(path, at_start), from, first_block(path, at_end), to);
    else
        return after - before;
}

/// The factor f of the correction f d to the gradient m in the middle, and its derivatives df by strains at
/// their ends. f d.d = b = W1 - W0 - m.d; where that difference would drown in rounding it is Simpson's rule
/// in the gradients, and nothing where it is below the rounding of the energy or where the strains hardly
/// change: what is left out is of third order, what rounding leaves of f d and its gradient is not. Changes
/// are small beside the strains, or beside their natural_square(k), which an energy may give to those that
/// vanish at an origin that is anywhere, as entropy does.
template <bool tangent, class Places, class Energy, class Path, int n = Energy::n>
VISVIVA_INLINE V correction(const Places& places, const Energy& energy, const Path& path, const V* from,
                            const V* to, const V* d, const Potential<n>& m, const Potential<n>& p0,
                            const Potential<n>& p1, V* df) {
    V first{}, second{}, simpson{}, size{}, place{}, work{}, stress{};
    for (int k = 0; k < n; ++k) {
        if (!path.moves(k)) continue;
        const V w = broadcast(Energy::weight(k));
        const V change = p1.s[k] - p0.s[k], bend = change - 2.0 * (m.s[k] - p0.s[k]);
        first += w * change * change, second += w * bend * bend, simpson += w * bend * d[k];
        size += w * d[k] * d[k], place += w * (from[k] * from[k] + to[k] * to[k]);
        work += w * m.s[k] * d[k], stress += w * m.s[k] * m.s[k];
        if constexpr (requires { energy.natural_square(k); }) place = vmax(place, energy.natural_square(k));
    }
    const VI smooth = second <= Energy::smooth * first;
    V b = simpson / 6.0;
    if (!all(smooth)) b = select(smooth, b, increase(places, energy, path, from, to, p0.W, p1.W) - work);
    const VI idle =
        (size <= 1e-20 * vmax(place, broadcast(Energy::natural))) | (b * b <= 1e-30 * stress * place);
    const V inverse = select(idle, V{}, 1.0 / select(idle, broadcast(1.0), size)), f = b * inverse;
    for (int l = 0; tangent && l < n; ++l) {
        const double half = path.moves(l) ? 0.5 : 1.0;
        V slope = p1.s[l] - (path.moves(l) ? m.s[l] + 2.0 * f * d[l] : p0.s[l]);
        for (int k = 0; k < n; ++k)
            if (path.moves(k)) slope -= (half * Energy::weight(k)) * m.second(k, l) * d[k];
        df[l] = inverse * slope;
    }
    return f;
}

/// Energies at the strains that paths go from and to, all blocks one after the other in both orders: each end
/// of one path is the start of the next.
template <class Energy, int n = Energy::n>
struct Corners {
    static constexpr int last = Energy::n_blocks;
    Potential<n> p[2][last + 1];  // [forward][blocks that have moved]; start and end are those of [1]
    template <class Places>
    Corners(const Places& places, const Energy& energy, const V* e0, const V* e1) {
        for (int moved = 0; moved <= last; ++moved)
            for (int forward = moved % last == 0; forward < 2; ++forward) {
                V e[n];
                for (int k = 0; k < n; ++k) {
                    const int at = forward == 1 ? Energy::block(k) : last - 1 - Energy::block(k);
                    e[k] = at < moved ? e1[k] : e0[k];
                }
                const Place first = (forward == 1 ? 0 : last - 1) < moved ? at_end : at_start;
                places.template evaluate<false>(energy, first, e, p[forward][moved]);
            }
    }
    const Potential<n>& operator()(const Part<Energy>& path, bool end) const {
        const int moved = (path.forward ? path.block : last - 1 - path.block) + (end ? 1 : 0);
        return p[path.forward || moved % last == 0][moved];
    }
};

/// Adds a share of s along a path, with s . (e1 - e0) = W(e1) - W(e0) for what moves, and of T = ds/de1, both
/// per component of the metric.
template <bool tangent, class Places, class Energy, class Path, class Ends, int n = Energy::n>
VISVIVA_INLINE void add_along(const Places& places, const Energy& energy, const Path& path, const Ends& at,
                              double share, const V* e0, const V* e1, V* s, V* T) {
    V from[n], to[n], middle[n], d[n], f{}, df[n] = {};
    for (int k = 0; k < n; ++k) {
        from[k] = path.ends(k) ? e1[k] : e0[k];
        to[k] = path.moves(k) ? e1[k] : from[k];
        middle[k] = 0.5 * (from[k] + to[k]), d[k] = to[k] - from[k];
    }
    Potential<n> m;
    places.template evaluate<tangent>(energy, first_block(path, in_middle), middle, m);
    if (!energy.is_quadratic())
        f = correction<tangent>(places, energy, path, from, to, d, m, at(path, false), at(path, true), df);
    for (int k = 0; k < n; ++k) {
        if (!path.moves(k)) continue;
        s[k] += share * (m.s[k] + f * d[k]);
        for (int l = 0; tangent && l < n; ++l) {
            if (!path.moves(l) && !path.ends(l)) continue;
            T[n * k + l] += share * ((path.moves(l) ? 0.5 : 1.0) * m.second(k, l) + d[k] * df[l]);
        }
        if constexpr (tangent) T[n * k + k] += (share / Energy::weight(k)) * f;
    }
}

/// s with s . (e1 - e0) = W(e1) - W(e0), and T = ds/de1. Several blocks of strains go one after the other, in
/// both orders, so that each keeps its own units: the mean is of second order.
template <bool tangent, class Energy, int n = Energy::n>
VISVIVA_INLINE void discrete_gradient(const Energy& energy, const V* e0, const V* e1, V* s, V* T) {
    for (int k = 0; k < n; ++k) s[k] = V{};
    for (int k = 0; tangent && k < n * n; ++k) T[k] = V{};
    const Places<tangent, Energy> places(energy, e0, e1);
    if constexpr (Energy::n_blocks == 1) {
        Potential<n> ends[2];
        if (!energy.is_quadratic())
            energy.template evaluate<false>(e0, ends[0]), energy.template evaluate<false>(e1, ends[1]);
        auto at = [&](const Whole&, bool end) -> const Potential<n>& { return ends[end]; };
        add_along<tangent>(places, energy, Whole(), at, 1.0, e0, e1, s, T);
    } else {
        const Corners<Energy> at(places, energy, e0, e1);
        for (int forward = 0; forward < 2; ++forward)
            for (int block = 0; block < Energy::n_blocks; ++block)
                add_along<tangent>(places, energy, Part<Energy>{block, forward == 1}, at, 0.5, e0, e1, s, T);
    }
}

/// Stresses s, and moduli T: by the strains at the end for discrete gradients, else by those at theta, et.
template <bool tangent, class Energy, int n = Energy::n>
VISVIVA_INLINE void stress_of(const Energy& energy, const Step& step, const V* e0, const V* e1, const V* et,
                              V* s, V* T) {
    if (step.stress == Stress::discrete_gradient) return discrete_gradient<tangent>(energy, e0, e1, s, T);
    Potential<n> p;
    energy.template evaluate<tangent>(et, p);
    for (int k = 0; k < n; ++k) s[k] = p.s[k];
    for (int k = 0; tangent && k < n; ++k)
        for (int l = 0; l < n; ++l) T[n * k + l] = p.second(k, l);
}

}  // namespace visviva::VISVIVA_ISA
