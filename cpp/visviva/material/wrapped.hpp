// The energy of a material, and energies that wrap energies: of what heat has stretched, and in plane stress.
// A wrapper keeps the strains of what it wraps, of which C - I comes first.
#pragma once
#include "visviva/material/response.hpp"

namespace visviva::VISVIVA_ISA {

struct MaterialEnergy : TensorEnergy {
    static constexpr int n = 6;
    MaterialKind kind;
    const V* par;
    bool is_quadratic() const { return kind == MaterialKind::hooke; }
    template <bool second>
    VISVIVA_INLINE void evaluate(const V* c, Response& r) const {
        respond<second>(kind, c, par, r);
    }
};

/// Strain from the place that heat alone, of strain e, would lead to: C / (1 + e)^2 - I, or twice the small
/// strain less that of heat.
VISVIVA_INLINE void strain_beyond(V e, bool small, const V* c, V* beyond) {
    const V shrink = small ? broadcast(1.0) : 1.0 / ((1.0 + e) * (1.0 + e));
    const V less = small ? 2.0 * e : e * (2.0 + e) * shrink;
    for (int k = 0; k < 6; ++k) beyond[k] = shrink * c[k] - (k < 3 ? less : V{});
}

/// stretch^3 W(C / stretch^2), the energy being that per volume of the heated material; W(c - 2 e) of small
/// strains.
template <class Energy>
struct Stretched : Energy {
    const V* strain;  // that heat alone would leave, or null
    bool small;

    template <bool second>
    VISVIVA_INLINE void evaluate(const V* c, Potential<Energy::n>& p) const {
        strain ? evaluate_beyond<second>(c, p) : Energy::template evaluate<second>(c, p);
    }

    // Not inlined: most materials are cold.
    template <bool second, int n = Energy::n>
    __attribute__((noinline)) void evaluate_beyond(const V* c, Potential<n>& p) const {
        V beyond[n];
        strain_beyond(*strain, small, c, beyond);
        for (int k = 6; k < n; ++k) beyond[k] = c[k];
        Energy::template evaluate<second>(beyond, p);
        if (small) return;
        const V stretch = 1.0 + *strain, volume = stretch * stretch * stretch;
        auto share = [shrink = 1.0 / (stretch * stretch)](int k) { return k < 6 ? shrink : broadcast(1.0); };
        p.W *= volume;
        for (int k = 0; k < n; ++k) p.s[k] *= volume * share(k);
        for (int k = 0; second && k < n; ++k)
            for (int l = k; l < n; ++l) p.d[packed(n, k, l)] *= volume * share(k) * share(l);
    }
};

/// The energy at the stretch across the plane that leaves no stress there, min over C33 of W(C). It keeps
/// nothing between steps, and its discrete gradient is that of any energy.
template <class Energy>
struct PlaneStress : Energy {
    bool is_on;

    template <bool second>
    VISVIVA_INLINE void evaluate(const V* c, Potential<Energy::n>& p) const {
        is_on ? evaluate_in_plane<second>(c, p) : Energy::template evaluate<second>(c, p);
    }

    template <bool second, int n = Energy::n>
    __attribute__((noinline)) void evaluate_in_plane(const V* in_plane, Potential<n>& p) const {
        V c[n];
        for (int k = 0; k < n; ++k) c[k] = in_plane[k];
        c[2] = across(in_plane);
        Energy::template evaluate<second>(c, p);
        p.s[2] = V{};
        if constexpr (second) {
            V beside[n];
            for (int k = 0; k < n; ++k) beside[k] = p.second(k, 2);
            const V inverse = 1.0 / beside[2];
            for (int k = 0; k < n; ++k)
                for (int l = k; l < n; ++l) p.d[packed(n, k, l)] -= inverse * beside[k] * beside[l];
        }
    }

    /// C33 - 1: dW/dC33 = 0 by Newton's method in ln C33, begun at no change of volume; energies quadratic in
    /// C need one step.
    template <int n = Energy::n>
    __attribute__((noinline)) V across(const V* in_plane) const {
        Potential<n> p;
        V c[n];
        for (int k = 0; k < n; ++k) c[k] = in_plane[k];
        c[2] = V{};
        if (Energy::is_quadratic()) {
            Energy::template evaluate<true>(c, p);
            return -p.s[2] / p.second(2, 2);
        }
        V y = -vlog1p(c[0] + c[1] + c[0] * c[1] - c[3] * c[3]);
        VI moving = vabs(y) >= 0.0;
        for (int k = 0; k < 60 && any(moving); ++k) {
            c[2] = expm1(y);
            Energy::template evaluate<true>(c, p);
            const V slope = p.s[2] + (1.0 + c[2]) * p.second(2, 2);
            const V dy = -p.s[2] / vmax(slope, vabs(p.s[2]));  // downhill, never further than by a factor e
            moving = vabs(dy) > 1e-9;
            y += dy;
        }
        return expm1(y);
    }
};

}  // namespace visviva::VISVIVA_ISA
