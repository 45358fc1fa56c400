// A layer of a shell whose directors stretch: strains of its four nodes, and the energy of a material in
// space.
#pragma once
#include "visviva/material/mixed_energy.hpp"
#include "visviva/point/director_maps.hpp"
#include "visviva/point/energies.hpp"

namespace visviva::VISVIVA_ISA {

/// Kinematics of the layer through a height z above a shell of four nodes: squared distances of
/// the places x = phi + z d of its nodes (edges, then diagonals), their edges times the mean director of both
/// ends (tying points A and C along 1, B and D along 2 of Dvorkin & Bathe 1984), squared lengths of the
/// directors (tying points of Betsch & Stein 1995), and the enhanced strain across. All else is linear in
/// these. Columns of four positions and four directors: the four x, the four d.
struct LayerMap : Layout<LayerMap> {
    static constexpr int n_groups = 2, n_components = 4, n_local = 25, n_strains = 15;
    static constexpr Group groups[] = {{3, 8, 2}, {1, 1, 0}};
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        constexpr int from[4] = {0, 1, 3, 0}, to[4] = {1, 2, 2, 3};
        for (int k = 0; k < 4; ++k) {
            e[k] = dot(y + k, 8, y + k, 8), e[6 + k] = T{}, e[10 + k] = dot(y + 4 + k, 8, y + 4 + k, 8);
            for (int c = 0; c < 3; ++c)
                e[6 + k] = e[6 + k] + 0.5 * y[8 * c + k] * (y[8 * c + 4 + from[k]] + y[8 * c + 4 + to[k]]);
        }
        e[4] = e[5] = T{};
        for (int c = 0; c < 3; ++c) {
            const T *edge = y + 8 * c, first = edge[0] + edge[1], second = edge[3] - edge[0];
            e[4] = e[4] + first * first, e[5] = e[5] + second * second;
        }
        e[14] = y[24];
    }
};

/// And a pressure of the layer.
struct PressedLayerMap : Layout<PressedLayerMap> {
    static constexpr int n_groups = 3, n_components = 5, n_local = 26, n_strains = 16;
    static constexpr Group groups[] = {{3, 8, 2}, {1, 1, 0}, {1, 1, 0}};
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        LayerMap::strains(y, e);
        e[15] = y[25];
    }
};

/// W(C) of any material. Parameters: its number, C - I by the strains of the map [6][15], its own.
struct LayerEnergy : TensorEnergy {
    static constexpr int n = 6, n_turned = 15, first = 1 + 6 * n_turned;
    static constexpr int max_par = first + material_max_parameters;
    const V* p;
    explicit LayerEnergy(const V* par) : p(par) {}
    static const V* turn(const V* par) { return par + 1; }
    MaterialEnergy material() const {
        return {{}, static_cast<MaterialKind>(static_cast<int>(p[0][0])), p + first};
    }
    bool is_quadratic() const { return material().is_quadratic(); }
    template <bool second>
    void evaluate(const V* c, Response& r) const {
        material().evaluate<second>(c, r);
    }
};

/// W(C) without its volumetric part, plus p g(J) - compliance p^2 / 2: stationary in p where W is.
/// Parameters: number of the material, C - I and p by the strains of the map [7][16], measure of the volume,
/// its exponent, compliance, those of the material.
struct PressedLayerEnergy : PlainEnergy {
    static constexpr int n = 7, n_blocks = 2, n_turned = 16, volume = 1 + 7 * n_turned, first = volume + 3;
    static constexpr int max_par = first + material_max_parameters;
    static constexpr int block(int k) { return k / 6; }
    static constexpr double weight(int k) { return behind_tensor(k); }
    const V* p;
    explicit PressedLayerEnergy(const V* par) : p(par) {}
    static const V* turn(const V* par) { return par + 1; }
    template <bool second>
    void evaluate(const V* c, Potential<n>& to) const {
        Response rest, g;
        respond<second>(static_cast<MaterialKind>(static_cast<int>(p[0][0])), c, p + first, rest);
        const auto measure = static_cast<VolumeMeasure>(static_cast<int>(p[volume][0]));
        VolumeEnergy{{}, measure, p[volume + 1]}.evaluate<second>(c, g);
        const V pressure = c[6], compliance = p[volume + 2];
        to.W = rest.W + pressure * (g.W - 0.5 * compliance * pressure);
        to.s[6] = g.W - compliance * pressure;
        for (int k = 0; k < 6; ++k) {
            to.s[k] = rest.s[k] + pressure * g.s[k];
            for (int l = k; second && l < 6; ++l)
                to.d[packed(7, k, l)] = rest.second(k, l) + pressure * g.second(k, l);
            if (second) to.d[packed(7, k, 6)] = g.s[k];
        }
        if (second) to.d[packed(7, 6, 6)] = -compliance;
    }
};

}  // namespace visviva::VISVIVA_ISA
