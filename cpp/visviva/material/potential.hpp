// Energies of any number of strains, and what follows from one that is written once over a number type.
#pragma once
#include "visviva/base/jet.hpp"

namespace visviva::VISVIVA_ISA {

/// An energy of n strains, its gradient s and second gradient d (upper triangle by rows), per component of
/// the metric in which strains are measured: dW = sum_k weight(k) s_k de_k, ds_k = sum_l weight(l) d_kl de_l.
/// Symmetric tensors are six numbers (11, 22, 33, 12, 23, 31), and an entry off the diagonal stands for two:
/// its weight is 2.
template <int n>
struct Potential {
    V W, s[n], d[n * (n + 1) / 2];
    VISVIVA_INLINE V second(int k, int l) const { return d[k < l ? packed(n, k, l) : packed(n, l, k)]; }
};

/// Weights of tensors one after the other.
constexpr double tensor_weight(int k) { return k % 6 < 3 ? 1.0 : 2.0; }

/// det C - 1 of c = C - I, alone in the plane of 11, 22 and 12 or in space.
template <class T>
VISVIVA_INLINE T determinant_less_one(const T* c, bool in_plane = false) {
    const T plane = c[0] + c[1] + (c[0] * c[1] - c[3] * c[3]);
    if (in_plane) return plane;
    const T cofactors = (2.0 * c[3]) * (c[4] * c[5]) - c[0] * (c[4] * c[4]) - c[1] * (c[5] * c[5]);
    return plane + c[2] * (plane + 1.0) + (cofactors - c[4] * c[4] - c[5] * c[5]);
}

/// Defaults of energies: one block of strains of equal units, no internal
/// variables.
struct PlainEnergy {
    static constexpr int n_blocks = 1, n_internal = 0;
    static constexpr int n_turned =
        0;  // strains that its own are linear in, see PointElement; 0: they are its own
    static constexpr int block(int) { return 0; }
    static constexpr double weight(int) { return 1.0; }
    static constexpr double natural =
        0;  // size of strains that counts as large, whatever they are; 0: unknown
    // Relative squares of what bends stresses, up to which Simpson's rule in them tells a difference of
    // energies: it does not see kinks.
    static constexpr double smooth = 1e-8;
    bool is_quadratic() const { return false; }
};

/// Energies of symmetric tensors, one after the other.
struct TensorEnergy : PlainEnergy {
    static constexpr double weight(int k) { return tensor_weight(k); }
    static constexpr double natural = 1;
};

/// The potential of an energy given as a function of jets.
template <bool second, class Owner, class Energy, int n = Owner::n>
VISVIVA_INLINE void differentiate(const Owner&, const V* e, Energy&& energy, Potential<n>& p) {
    Jet<n, second> x[n];
    for (int k = 0; k < n; ++k) x[k] = Jet<n, second>::variable(e[k], k);
    const Jet<n, second> w = energy(x);
    p.W = w.v;
    for (int a = 0; a < n; ++a) {
        p.s[a] = w.g[a] / Owner::weight(a);
        for (int b = a; second && b < n; ++b)
            p.d[packed(n, a, b)] = w.h[packed(n, a, b)] / (Owner::weight(a) * Owner::weight(b));
    }
}

}  // namespace visviva::VISVIVA_ISA
