// Beams and shells: strains of positions and directors, which are interpolated alike; see theory of beams,
// Betsch & Steinmann (2002), and of shells, Betsch & Saenger (2009).
#pragma once
#include "visviva/point/maps.hpp"

namespace visviva::VISVIVA_ISA {

/// a . b of vectors with strides
template <class T>
constexpr T dot(const T* a, int i, const T* b, int j) {
    return a[0] * b[0] + a[i] * b[j] + a[2 * i] * b[2 * j];
}

/// Gamma_i = d_i . phi', K_i = (d_k . d_j' - d_j . d_k') / 2 with (i, j, k) cyclic, and Gamma_3 less
/// d_3 . d_3 / 2: between nodes that are turned the mean of d_3 is shorter than one, by which a force along
/// the line would bend it. Columns: of phi the derivative, of directors the value and the derivative.
struct BeamMap : Layout<BeamMap> {
    static constexpr int n_groups = 4, n_components = 12, n_local = 21, n_strains = 6;
    static constexpr Group groups[] = {{3, 1, 2}, {3, 2, 2}, {3, 2, 2}, {3, 2, 2}};
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        for (int i = 0; i < 3; ++i) {
            const T *d = y + 3 + 6 * i, *dj = y + 3 + 6 * ((i + 1) % 3), *dk = y + 3 + 6 * ((i + 2) % 3);
            e[i] = dot(d, 2, y, 1);
            e[3 + i] = 0.5 * (dot(dk, 2, dj + 1, 2) - dot(dj, 2, dk + 1, 2));
        }
        e[2] = dot(y + 15, 2, y, 1) - 0.5 * dot(y + 15, 2, y + 15, 2);
    }
};

/// Membrane (phi,a . phi,b) / 2, bending (phi,a . d,b + phi,b . d,a) / 2, shear phi,a . d assumed from tying
/// points A, C (along 1) and B, D (along 2) after Dvorkin & Bathe (1984). Columns of phi: derivatives along 1
/// and 2, then those along 1 at A and C and along 2 at B and D times their shares in the point's shear; of d:
/// its derivatives along 1 and 2, its values at A, C, B, D.
struct ShellMap : Layout<ShellMap> {
    static constexpr int n_groups = 2, n_components = 6, n_local = 36, n_strains = 8;
    static constexpr Group groups[] = {{3, 6, 2}, {3, 6, 2}};
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        const T* d = y + 18;
        e[0] = 0.5 * dot(y, 6, y, 6), e[1] = 0.5 * dot(y + 1, 6, y + 1, 6), e[2] = dot(y, 6, y + 1, 6);
        e[3] = dot(y, 6, d, 6), e[4] = dot(y + 1, 6, d + 1, 6);
        e[5] = dot(y, 6, d + 1, 6) + dot(y + 1, 6, d, 6);
        e[6] = dot(y + 2, 6, d + 2, 6) + dot(y + 3, 6, d + 3, 6);
        e[7] = dot(y + 4, 6, d + 4, 6) + dot(y + 5, 6, d + 5, 6);
    }
};

}  // namespace visviva::VISVIVA_ISA
