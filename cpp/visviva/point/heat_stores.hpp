// Stores of heat beside solids: springs, lumps, sections of beams and layers of shells. Entropies are
// transported, temperatures act as multipliers do, see HeatPairing.
#pragma once
#include "visviva/point/layer.hpp"
#include "visviva/point/thermoelastic.hpp"

namespace visviva::VISVIVA_ISA {

/// (s, theta)
struct StoreMap : Layout<StoreMap> {
    static constexpr int n_groups = 2, n_components = 2, n_local = 2, n_strains = 2;
    static constexpr Group groups[] = {{1, 1, 1}, {1, 1, 0, true}};
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        e[0] = y[0], e[1] = y[1];
    }
};

/// c (theta - theta0) with theta = theta0 exp(s / c). Parameters: c, theta0.
struct StoreEnergy : PlainEnergy {
    static constexpr int n = 1, max_par = 2, first_entropy = 0, n_entropies = 1;
    const V* p;
    explicit StoreEnergy(const V* par) : p(par) {}
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        const V rise = p[1] * expm1(e[0] / p[0]);
        to.W = p[0] * rise, to.s[0] = p[1] + rise;
        if constexpr (second) to.d[0] = to.s[0] / p[0];
    }
};

struct StorePairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        f[0] = z.warming(0, z.e(1)), f[1] = z.e(1) - z.s(0);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

/// (|r|^2, s, theta), r what lies between two points, each of its components a group: points of rigid bodies
/// are no nodes of three unknowns.
struct SpringMap : Layout<SpringMap> {
    static constexpr int n_groups = 5, n_components = 5, n_local = 5, n_strains = 3;
    static constexpr Group groups[] = {{1, 1, 2}, {1, 1, 2}, {1, 1, 2}, {1, 1, 1}, {1, 1, 0, true}};
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        e[0] = y[0] * y[0] + y[1] * y[1] + y[2] * y[2];
        e[1] = y[3], e[2] = y[4];
    }
};

/// e(l^2, s) of psi = W (1 + a (theta - theta0)) - beta (theta - theta0) g + c (theta - theta0 - theta
/// ln(theta / theta0)) with W = k g^2 / 2 and g = ln(l / free), or l - free. Parameters: whether g is the
/// logarithm, k, free, beta, a, c, theta0, and of the pairing a viscosity.
struct SpringEnergy : PlainEnergy {
    static constexpr int n = 2, max_par = 8, n_blocks = 2, first_entropy = 1, n_entropies = 1;
    static constexpr int block(int k) { return k; }
    const V* p;
    explicit SpringEnergy(const V* par) : p(par) {}
    V increase(const V* from, const V* to) const {
        V w[2], M[2];
        for (int k = 0; k < 2; ++k) {
            const V square = (k == 0 ? from : to)[0] / (p[2] * p[2]) - 1.0;
            const V g = p[0][0] > 0 ? 0.5 * vlog1p(square) : p[2] * (square / (vsqrt(square + 1.0) + 1.0));
            w[k] = 0.5 * p[1] * g * g, M[k] = p[3] * g - p[4] * w[k];
        }
        const V theta = p[6] + p[6] * expm1((from[1] - M[0]) / p[5]);
        return (w[1] - w[0]) + p[6] * (M[1] - M[0]) +
               p[5] * theta * expm1(((to[1] - from[1]) - (M[1] - M[0])) / p[5]);
    }
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        differentiate<second>(
            *this, e,
            [this](const auto* x) {
                const V inverse = 1.0 / p[2];
                const auto square = (inverse * inverse) * x[0] - 1.0;
                const auto g =
                    p[0][0] > 0 ? 0.5 * log1p(square) : p[2] * (square / (root(square + 1.0) + 1.0));
                const auto w = (0.5 * p[1]) * (g * g), M = p[3] * g - p[4] * w;
                const auto rise = p[6] * expm1((1.0 / p[5]) * (x[1] - M));
                return w + p[6] * M + p[5] * rise;
            },
            to);
    }
};

/// With a damper of tension viscosity l' beside it, whose work is heat.
struct SpringPairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        const auto stress = (0.25 * z.par[7]) * (z.rate(0) / z.e(0));
        f[0] = z.s(0) + stress;
        f[1] = z.warming(1, z.e(2)) - stress * z.rate(0) / z.e(2);
        f[2] = z.e(2) - z.s(1);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

/// Strains of a beam, entropies for the mean temperature and its slopes along d1 and d2, their derivatives
/// along the line, those temperatures, and theirs.
struct HeatedBeamMap : Layout<HeatedBeamMap> {
    static constexpr int n_groups = 6, n_components = 18, n_local = 33, n_strains = 18;
    static constexpr Group groups[] = {{3, 1, 2}, {3, 2, 2}, {3, 2, 2},
                                       {3, 2, 2}, {3, 2, 1}, {3, 2, 0, true}};
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        BeamMap::strains(y, e);
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 2; ++k) {
                e[6 + 3 * k + i] = y[21 + 2 * i + k];
                e[12 + 3 * k + i] = y[27 + 2 * i + k];
            }
    }
};

/// Of a section with strains e and entropies S_0, S_1, S_2, whose material lies at four points, r_1 and r_2
/// to both sides of its axes: its area and second moments are theirs. With the entropy of a point, in units
/// of the capacity c of the section, z = y_0 +- y_1 +- y_2 where y_i = (S_i - m_i . e) / (c r_i) and r_0 = 1,
/// its temperature is theta0 exp(z), and e . C e / 2 + theta0 m_0 . e + c (mean of these - theta0) the
/// energy: what entropies work on is the mean temperature and its slopes in the mean square. Parameters: C,
/// upper triangle by rows; m_0, m_1, m_2; c, theta0, r_1, r_2; and of the pairing the conductance along.
struct HeatedSectionEnergy : PlainEnergy {
    static constexpr int n = 9, m = 21, c = 39, zero = 40, radius = 41, conductance = 43, max_par = 44;
    static constexpr int n_points = 4, first_entropy = 6, n_entropies = 3;
    const V* p;
    explicit HeatedSectionEnergy(const V* par) : p(par) {}
    V stiffness(int k, int l) const { return p[k < l ? packed(6, k, l) : packed(6, l, k)]; }
    /// Heights of point a along d1 or d2, i = 0 or 1.
    static VISVIVA_INLINE V height(const V* par, int a, int i) {
        return (a >> i) % 2 ? par[radius + i] : -par[radius + i];
    }
    /// Derivatives of z of all points by strains and entropies.
    struct Slopes {
        V of[n_points][n];
    };
    Slopes slopes() const {
        Slopes found;
        for (int a = 0; a < n_points; ++a) {
            const V by[3] = {1.0 / p[c], 1.0 / (p[c] * height(p, a, 0)), 1.0 / (p[c] * height(p, a, 1))};
            for (int i = 0; i < 3; ++i) found.of[a][6 + i] = by[i];
            for (int k = 0; k < 6; ++k) {
                found.of[a][k] = V{};
                for (int i = 0; i < 3; ++i) found.of[a][k] -= by[i] * p[m + 6 * i + k];
            }
        }
        return found;
    }
    static V along(const V* slope, const V* e) {
        V z{};
        for (int k = 0; k < n; ++k) z += slope[k] * e[k];
        return z;
    }
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        const Slopes by = slopes();
        const V share = p[c] * p[zero] / n_points;
        to.W = V{};
        for (int k = 0; k < n; ++k) to.s[k] = V{};
        to.s[6] = p[zero];  // with a mean rise of nothing; what that is to the strains goes with m_0
        if constexpr (second)
            for (int k = 0; k < n * (n + 1) / 2; ++k) to.d[k] = V{};
        for (int k = 0; k < 6; ++k) {
            V Ce{};
            for (int l = 0; l < 6; ++l) Ce += stiffness(k, l) * e[l];
            to.W += (0.5 * Ce + p[zero] * p[m + k]) * e[k];
            to.s[k] = Ce;
            if constexpr (second)
                for (int l = k; l < 6; ++l) to.d[packed(n, k, l)] = p[packed(6, k, l)];
        }
        for (int a = 0; a < n_points; ++a) {
            const V* slope = by.of[a];
            const V rise = expm1(along(slope, e));
            to.W += share * rise;
            for (int k = 0; k < n; ++k) {
                to.s[k] += share * rise * slope[k];
                if constexpr (second)
                    for (int l = k; l < n; ++l)
                        to.d[packed(n, k, l)] += share * (rise + 1.0) * slope[k] * slope[l];
            }
        }
    }
    /// All but exponentials of the scalars z is quadratic: with the difference quotients of these and the
    /// mean of the rest no strain is weighed against another, nor extension against curvature.
    template <bool tangent>
    void discrete_gradient(const V* e0, const V* e1, V* s, V* T) const {
        const Slopes by = slopes();
        const V share = p[c] * p[zero] / n_points;
        V change[n];
        for (int k = 0; k < n; ++k) change[k] = e1[k] - e0[k], s[k] = V{};
        s[6] = p[zero];
        if constexpr (tangent)
            for (int k = 0; k < n * n; ++k) T[k] = V{};
        for (int k = 0; k < 6; ++k) {
            for (int l = 0; l < 6; ++l) {
                s[k] += 0.5 * stiffness(k, l) * (e0[l] + e1[l]);
                if constexpr (tangent) T[n * k + l] = 0.5 * stiffness(k, l);
            }
        }
        for (int a = 0; a < n_points; ++a) {
            const V* slope = by.of[a];
            const V y = along(slope, change), before = expm1(along(slope, e0));
            const VI near = vabs(y) < 1e-2;
            const V safe = select(near, broadcast(1.0), y);
            constexpr double series[6] = {1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040};
            V more{}, bend{};  // expm1(y) / y - 1 and its slope
            for (int k = 5; k >= 0; --k) more = more * y + series[k], bend = bend * y + (k + 1) * series[k];
            more = select(near, more * y, expm1(safe) / safe - 1.0);
            bend = select(near, bend, (expm1(safe) - more) / safe);
            const V rise = share * (before + more + before * more);
            for (int k = 0; k < n; ++k) {
                s[k] += rise * slope[k];
                if constexpr (tangent) {
                    const V one = share * (before + 1.0) * bend * slope[k];
                    for (int l = 0; l < n; ++l) T[n * k + l] += one * slope[l];
                }
            }
        }
    }
};

/// Heat flows along and across at every point by its temperature there, and entropy arises.
struct HeatedSectionPairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        using P = HeatedSectionEnergy;
        using T = typename State::T;
        const V share = z.par[P::conductance] / P::n_points;
        const T zero = 0.0 * z.e(12);
        for (int k = 0; k < 6; ++k) f[k] = z.s(k);
        for (int i = 0; i < 3; ++i) {
            f[6 + i] = i == 0 ? z.warming(6, z.e(12)) : z.rate(6 + i), f[9 + i] = f[15 + i] = zero;
            f[12 + i] = z.e(12 + i) - z.s(6 + i);
        }
        for (int a = 0; a < P::n_points; ++a) {
            const V x[3] = {broadcast(1.0), P::height(z.par, a, 0), P::height(z.par, a, 1)};
            const T along = z.e(15) + x[1] * z.e(16) + x[2] * z.e(17);
            const T inverse = (zero + broadcast(1.0)) / (z.e(12) + x[1] * z.e(13) + x[2] * z.e(14));
            const T square = along * along + z.e(13) * z.e(13) + z.e(14) * z.e(14);
            const T made = share * (square * inverse * inverse);
            for (int i = 0; i < 3; ++i) {
                f[6 + i] = f[6 + i] - x[i] * made;
                f[9 + i] = f[9 + i] + (share * x[i]) * (along * inverse);
                if (i > 0) f[6 + i] = f[6 + i] + share * (z.e(12 + i) * inverse);
            }
        }
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

/// A layer of a shell with entropy and temperature, see EntropyMap.
struct HeatedLayerMap : Layout<HeatedLayerMap> {
    static constexpr int n_groups = 4, n_components = 6, n_local = 33, n_strains = 23;
    static constexpr Group groups[] = {{3, 8, 2}, {1, 1, 0}, {1, 4, 1}, {1, 4, 0, true}};
    static constexpr bool couples(int g, int h) { return g > 1 || h < 3; }
    static constexpr int tested(int g) { return g == 3 ? 1 : groups[g].columns; }
    static constexpr int tried(int g) { return g == 2 ? 1 : groups[g].columns; }
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        LayerMap::strains(y, e);
        for (int k = 0; k < 8; ++k) e[15 + k] = y[25 + k];
    }
};

/// e(C, s). Parameters: C - I and s by the strains of the map [7][16], those of ThermoelasticEnergy.
struct HeatedLayerEnergy : ThermoelasticEnergy {
    static constexpr int n_turned = 16, first = 7 * n_turned, max_par = first + thermal::n_par;
    explicit HeatedLayerEnergy(const V* par) : ThermoelasticEnergy(par + first) {}
    static const V* turn(const V* par) { return par; }
};

/// HeatPairing with a conductivity of the reference.
struct HeatedLayerPairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        const typename State::T slope[3] = {z.e(20), z.e(21), z.e(22)}, *in_reference = nullptr;
        for (int k = 0; k < 15; ++k) f[k] = z.s(k);
        HeatPairing::balance(z.e(19), slope, z.warming(15, z.e(19)), z.s(15),
                             z.par + HeatedLayerEnergy::first, in_reference, f + 15);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

}  // namespace visviva::VISVIVA_ISA
