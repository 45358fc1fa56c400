// Solids: the strain C - I of the deformation gradient, alone or with strains of other fields behind it.
#pragma once
#include <array>

#include "visviva/point/point.hpp"

namespace visviva::VISVIVA_ISA {

/// Local unknowns and groups of a map by its table `groups`. Maps may say what of it stays zero: derivatives
/// of what tests a group by another one, and columns of a group that nothing tests, or that nothing depends
/// on, which are then the last ones.
template <class Map>
struct Layout {
    static constexpr bool couples(int, int) { return true; }
    static constexpr int tested(int g) { return Map::groups[g].columns; }
    static constexpr int tried(int g) { return Map::groups[g].columns; }
    static constexpr int group_of(int j) {
        int g = 0;
        for (; j >= Map::groups[g].components * Map::groups[g].columns; ++g)
            j -= Map::groups[g].components * Map::groups[g].columns;
        return g;
    }
};

/// e = C - I from y = F - I, row-major.
template <class T>
constexpr void right_cauchy_green(const T* y, T* e) {
    constexpr int a[6] = {0, 1, 2, 0, 1, 2}, b[6] = {0, 1, 2, 1, 2, 0};
    for (int k = 0; k < 6; ++k) {
        e[k] = y[3 * a[k] + b[k]] + y[3 * b[k] + a[k]];
        for (int m = 0; m < 3; ++m) e[k] = e[k] + y[3 * m + a[k]] * y[3 * m + b[k]];
    }
}

constexpr double identity_entry(int j) { return j < 9 && j % 4 == 0 ? 1.0 : 0.0; }

struct SolidMap : Layout<SolidMap> {
    static constexpr int n_groups = 1, n_components = 3, n_local = 9, n_strains = 6;
    static constexpr Group groups[] = {{3, 3, 2}};
    static constexpr double origin(int j) { return identity_entry(j); }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        right_cauchy_green(y, e);
    }
};

/// C of y = F - I in a plane, where nothing strains across.
struct PlaneMap : Layout<PlaneMap> {
    static constexpr int n_groups = 1, n_components = 2, n_local = 4, n_strains = 6;
    static constexpr Group groups[] = {{2, 2, 2}};
    static constexpr double origin(int j) { return j % 3 == 0 ? 1.0 : 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        e[0] = 2.0 * y[0] + y[0] * y[0] + y[2] * y[2];
        e[1] = 2.0 * y[3] + y[3] * y[3] + y[1] * y[1];
        e[3] = y[1] + y[2] + y[0] * y[1] + y[2] * y[3];
        e[2] = e[4] = e[5] = 0.0 * y[0];
    }
};

/// C of (F - I, r / R - 1) in the coordinates (radius, axis); what the axial one has in the third column
/// counts for nothing.
struct RevolutionMap : Layout<RevolutionMap> {
    static constexpr int n_groups = 1, n_components = 2, n_local = 6, n_strains = 6;
    static constexpr Group groups[] = {{2, 3, 2}};
    static constexpr double origin(int j) { return j < 5 && j % 2 == 0 ? 1.0 : 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        e[0] = 2.0 * y[0] + y[0] * y[0] + y[3] * y[3];
        e[1] = 2.0 * y[4] + y[4] * y[4] + y[1] * y[1];
        e[2] = 2.0 * y[2] + y[2] * y[2];
        e[3] = y[1] + y[3] + y[0] * y[1] + y[3] * y[4];
        e[4] = e[5] = 0.0 * y[0];
    }
};

/// (C, d, grad d)
struct SolidScalarMap : Layout<SolidScalarMap> {
    static constexpr int n_groups = 2, n_components = 4, n_local = 13, n_strains = 10;
    static constexpr Group groups[] = {{3, 3, 2}, {1, 4, 0}};
    static constexpr double origin(int j) { return identity_entry(j); }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        right_cauchy_green(y, e);
        for (int k = 0; k < 4; ++k) e[6 + k] = y[9 + k];
    }
};

/// (s, grad s, theta, grad theta) behind the strains of a map of positions and what else: the entropy is
/// transported, the temperature acts as a multiplier does. Nothing depends on the gradient of the entropy,
/// nor is that of the temperature tested. Gradients have three components in a plane, too.
template <class Base>
struct EntropyMap : Layout<EntropyMap<Base>> {
    static constexpr int before = Base::n_groups, first = Base::n_local, behind = Base::n_strains;
    static constexpr int columns = Base::groups[0].components + 1;
    static constexpr int n_groups = before + 2, n_components = Base::n_components + 2,
                         n_local = first + 2 * columns, n_strains = behind + 8;
    static constexpr auto groups = [] {
        std::array<Group, n_groups> found{};
        for (int g = 0; g < before; ++g) found[g] = Base::groups[g];
        found[before] = {1, columns, 1}, found[before + 1] = {1, columns, 0, true};
        return found;
    }();
    static constexpr bool couples(int g, int h) { return g >= before || h <= before; }
    static constexpr int tested(int g) { return g == before + 1 ? 1 : groups[g].columns; }
    static constexpr int tried(int g) { return g == before ? 1 : groups[g].columns; }
    static constexpr double origin(int j) { return j < first ? Base::origin(j) : 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        Base::strains(y, e);
        for (int k = 0; k < 4; ++k) {
            e[behind + k] = k < columns ? y[first + k] : 0.0 * y[0];
            e[behind + 4 + k] = k < columns ? y[first + columns + k] : 0.0 * y[0];
        }
    }
};

/// (C, c, grad c, mu, grad mu): what is stored, and its potential, which acts as a multiplier does.
struct SolidMixtureMap : Layout<SolidMixtureMap> {
    static constexpr int n_groups = 3, n_components = 5, n_local = 17, n_strains = 14;
    static constexpr Group groups[] = {{3, 3, 2}, {1, 4, 1}, {1, 4, 0, true}};
    static constexpr double origin(int j) { return identity_entry(j); }
    static constexpr bool couples(int g, int h) { return g > 0 || h < 2; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        right_cauchy_green(y, e);
        for (int k = 0; k < 8; ++k) e[6 + k] = y[9 + k];
    }
};

/// (theta, grad theta), transported
struct ScalarMap : Layout<ScalarMap> {
    static constexpr int n_groups = 1, n_components = 1, n_local = 4, n_strains = 4;
    static constexpr Group groups[] = {{1, 4, 1}};
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        for (int k = 0; k < 4; ++k) e[k] = y[k];
    }
};

/// Values as they are, of several groups.
template <class Map, int n>
struct PlainMap : Layout<Map> {
    static constexpr int n_local = n, n_strains = n;
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        for (int k = 0; k < n; ++k) e[k] = y[k];
    }
};

/// (c, grad c, load): one load for all elements
struct LoadedScalarMap : PlainMap<LoadedScalarMap, 5> {
    static constexpr int n_groups = 2, n_components = 2;
    static constexpr Group groups[] = {{1, 4, 1}, {1, 1, 0, true}};
};

/// (c, grad c, laplace c)
struct SmoothScalarMap : PlainMap<SmoothScalarMap, 5> {
    static constexpr int n_groups = 1, n_components = 1;
    static constexpr Group groups[] = {{1, 5, 1}};
};

/// (c, mu) and c of a wall
struct WallMap : PlainMap<WallMap, 2> {
    static constexpr int n_groups = 2, n_components = 2;
    static constexpr Group groups[] = {{1, 1, 1}, {1, 1, 0, true}};
};
struct OrderWallMap : PlainMap<OrderWallMap, 1> {
    static constexpr int n_groups = 1, n_components = 1;
    static constexpr Group groups[] = {{1, 1, 1}};
};

/// (C, c, grad c, mu, grad mu) in a plane, where nothing strains across
struct PlaneMixtureMap : Layout<PlaneMixtureMap> {
    static constexpr int n_groups = 3, n_components = 4, n_local = 12, n_strains = 14;
    static constexpr Group groups[] = {{2, 2, 2}, {1, 4, 1}, {1, 4, 0, true}};
    static constexpr double origin(int j) { return j < 4 ? PlaneMap::origin(j) : 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        PlaneMap::strains(y, e);
        for (int k = 0; k < 8; ++k) e[6 + k] = y[4 + k];
    }
};

/// (c, grad c, mu, grad mu)
struct ConcentrationMap : Layout<ConcentrationMap> {
    static constexpr int n_groups = 2, n_components = 2, n_local = 8, n_strains = 8;
    static constexpr Group groups[] = {{1, 4, 1}, {1, 4, 0, true}};
    static constexpr double origin(int) { return 0.0; }
    template <class T>
    static constexpr void strains(const T* y, T* e) {
        for (int k = 0; k < 8; ++k) e[k] = y[k];
    }
};

}  // namespace visviva::VISVIVA_ISA
