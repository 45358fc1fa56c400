// The materials' energies per reference volume, once each, over any number type: values alone or with
// derivatives by the invariants. Invariants come less their values at rest (i1 = I1 - 3, i2 = I2 - 3, j = J -
// 1, i4 = a.Ca - 1, i6), so that small strains lose no digits.
#pragma once
#include "visviva/base/jet.hpp"
#include "visviva/material/material.hpp"

namespace visviva::VISVIVA_ISA {

/// Volumetric energies by number, 0: ln^2 J / 2, 1: (J - 1)^2 / 2, 2: (J^2 - 1 - 2 ln J) / 4.
template <class T>
VISVIVA_INLINE T volumetric(const T& j, V kind) {
    const T log_j = log1p(j);
    const V one = broadcast(1.0), zero{};
    const V a = select(kind == 0.0, one, zero), b = select(kind == 1.0, one, zero);
    const V c = select(kind == 2.0, one, zero);
    return (0.5 * a) * (log_j * log_j) + (0.5 * b) * (j * j) + (0.25 * c) * (j * j + 2.0 * (j - log_j));
}

template <class T>
VISVIVA_INLINE T neo_hooke(const T* i, const V* p) {
    return (0.5 * p[0]) * (i[0] - 2.0 * log1p(i[2])) + p[1] * volumetric(i[2], p[2]);
}

template <class T>
VISVIVA_INLINE T mooney(const T* i, const V* p) {
    return p[0] * i[0] + p[1] * i[1] - p[2] * log1p(i[2]) + p[3] * volumetric(i[2], p[4]);
}

/// I1 J^(-2/3) - 3 and I2 J^(-4/3) - 3
template <class T>
VISVIVA_INLINE T isochoric_first(const T* i) {
    return i[0] + powm1(i[2], broadcast(-2.0 / 3)) * (i[0] + 3.0);
}
template <class T>
VISVIVA_INLINE T isochoric_second(const T* i) {
    return i[1] + powm1(i[2], broadcast(-4.0 / 3)) * (i[1] + 3.0);
}

template <class T>
VISVIVA_INLINE T isochoric(const T* i, const V* p) {
    const T a = isochoric_first(i), b = isochoric_second(i), aa = a * a;
    return p[0] * a + p[1] * aa + p[2] * (aa * a) + p[3] * b + p[4] * volumetric(i[2], p[5]);
}

template <class T>
VISVIVA_INLINE T gent(const T* i, const V* p) {
    return (-0.5 * p[0] * p[1]) * log1p((-1.0 / p[1]) * isochoric_first(i)) + p[2] * volumetric(i[2], p[3]);
}

/// Holzapfel, Gasser & Ogden: fibres with dispersion kappa that carry tension only.
template <class T>
VISVIVA_INLINE T holzapfel(const T* i, const V* p) {
    const T a = isochoric_first(i), shrink = powm1(i[2], broadcast(-2.0 / 3));
    T w = (0.5 * p[0]) * a + p[4] * volumetric(i[2], p[5]);
    for (int f = 3; f < 5; ++f) {
        const T stretch = i[f] + shrink * (i[f] + 1.0);  // isochoric a.Ca - 1
        const T e = positive(p[3] * a + (1.0 - 3.0 * p[3]) * stretch);
        w = w + (0.5 * p[1] / p[2]) * expm1(p[2] * (e * e));
    }
    return w;
}

template <class T>
VISVIVA_INLINE T blatz_ko(const T* i, const V* p) {
    return (0.5 * p[0]) * i[0] + (p[0] / p[1]) * powm1(i[2], -p[1]);
}

/// Ogden: i holds the principal values of C less 1.
template <class T>
VISVIVA_INLINE T ogden(const T* e, const V* p) {
    const T log_j = 0.5 * (log1p(e[0]) + log1p(e[1]) + log1p(e[2]));
    const T j = expm1(log_j);
    T w = p[0] * volumetric(j, p[1]);
    for (int k = 0; k < 3; ++k) {
        const V mu = p[3 + 2 * k], alpha = p[4 + 2 * k];
        const V factor = select(mu == 0.0, V{}, mu / alpha);
        for (int a = 0; a < 3; ++a)
            w = w + factor * expm1((0.5 * alpha) * log1p(e[a]) - (p[2] * alpha / 3.0) * log_j);
        w = w - (mu * (1.0 - p[2])) * log_j;  // stress-free at rest without the isochoric split
    }
    return w;
}

/// Hencky: quadratic in the logarithms of principal stretches; i holds the principal values of C less 1.
template <class T>
VISVIVA_INLINE T hencky(const T* e, const V* p) {
    const T log_a = 0.5 * log1p(e[0]), log_b = 0.5 * log1p(e[1]), log_c = 0.5 * log1p(e[2]);
    const T log_j = log_a + log_b + log_c, third = (1.0 / 3) * log_j;
    const T a = log_a - third, b = log_b - third, c = log_c - third;
    return p[0] * volumetric(expm1(log_j), p[1]) + p[2] * (a * a + b * b + c * c);
}

/// Calls `use` with the energy of an isotropic material as a function of invariants. Every material has a
/// call of its own that is always inlined, so that derivatives that are constant or zero drop out.
template <class Use>
VISVIVA_INLINE void with_energy(MaterialKind kind, const V* p, Use&& use) {
    switch (kind) {
#define VISVIVA_MATERIAL(energy, ...)                                                               \
    case MaterialKind::energy:                                                                      \
        if constexpr (traits(MaterialKind::energy).isotropic)                                       \
            return use([&](const auto* i) __attribute__((always_inline)) { return energy(i, p); }); \
        break;
#include "visviva/material/material_list.hpp"
#undef VISVIVA_MATERIAL
    }
}

}  // namespace visviva::VISVIVA_ISA
