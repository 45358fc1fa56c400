// Plane stress: the energy at the stretch across the plane that leaves no stress there, W*(C11, C22, C12) =
// min over C33 of W(C). It keeps nothing between steps, and its discrete gradient is that of any energy.
#pragma once
#include "visviva/material/response.hpp"

namespace visviva::VISVIVA_ISA {

VISVIVA_INLINE bool any(VI mask) {
    long long found = 0;
    for (int l = 0; l < W; ++l) found |= mask[l];
    return found != 0;
}

/// Puts C33 - 1 into c[2]: dW/dC33 = 0 by Newton's method in ln C33, begun at no change of volume; energies
/// quadratic in C need one step.
template <class Respond>
VISVIVA_INLINE void stretch_across(bool quadratic, Respond&& respond_to, V* c, Response& r) {
    c[2] = V{};
    if (quadratic) {
        respond_to(c, r);
        c[2] = -r.s[2] / r.d[packed(6, 2, 2)];
        return;
    }
    V y = -vlog1p(c[0] + c[1] + c[0] * c[1] - c[3] * c[3]);
    VI moving = vabs(y) >= 0.0;
    for (int k = 0; k < 60 && any(moving); ++k) {
        c[2] = expm1(y);
        respond_to(c, r);
        const V C = 1.0 + c[2], slope = r.s[2] + C * r.d[packed(6, 2, 2)];
        V dy = -r.s[2] / vmax(slope, vabs(r.s[2]));  // downhill, and never further than by a factor e
        moving = vabs(dy) > 1e-9;
        y += dy;
    }
    c[2] = expm1(y);
}

/// The response in the plane; c[2] of the solution is left in `c33`.
template <bool second>
__attribute__((noinline)) void plane_stress(MaterialKind kind, const V* in_plane, const V* p, Response& r,
                                            V& c33) {
    V c[6];
    for (int k = 0; k < 6; ++k) c[k] = in_plane[k];
    stretch_across(
        kind == MaterialKind::hooke, [&](const V* x, Response& to) { respond<true>(kind, x, p, to); }, c, r);
    c33 = c[2];
    respond<second>(kind, c, p, r);
    r.s[2] = V{};
    if constexpr (second) {
        V across[6];
        for (int k = 0; k < 6; ++k) across[k] = r.d[k < 2 ? packed(6, k, 2) : packed(6, 2, k)];
        const V inverse = 1.0 / across[2];
        for (int k = 0; k < 6; ++k)
            for (int l = k; l < 6; ++l) r.d[packed(6, k, l)] -= inverse * across[k] * across[l];
    }
}

}  // namespace visviva::VISVIVA_ISA
