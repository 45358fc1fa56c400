// Gradients of shape functions, weights and masses of W solid elements at a time: read from where they are
// kept, or, of bricks, worked out from where their nodes are, which are a tenth of the numbers.
#pragma once
#include "visviva/base/aligned.hpp"
#include "visviva/base/simd.hpp"
#include "visviva/solid/solid.hpp"

namespace visviva::VISVIVA_ISA {

constexpr int L8 = solid_lanes;

/// The inverse of F (3 x 3, by rows); returns its determinant.
VISVIVA_INLINE V invert(const V* F, V* to) {
    V cofactor[9];
    VISVIVA_FLATTEN
    for (int i = 0; i < 3; ++i) VISVIVA_FLATTEN
    for (int j = 0; j < 3; ++j) {
        const int k = (i + 1) % 3, l = (i + 2) % 3, m = (j + 1) % 3, n = (j + 2) % 3;
        cofactor[3 * i + j] = F[3 * k + m] * F[3 * l + n] - F[3 * k + n] * F[3 * l + m];
    }
    const V det = F[0] * cofactor[0] + F[1] * cofactor[1] + F[2] * cofactor[2], scale = 1.0 / det;
    VISVIVA_FLATTEN
    for (int i = 0; i < 3; ++i) VISVIVA_FLATTEN
    for (int j = 0; j < 3; ++j) to[3 * j + i] = scale * cofactor[3 * i + j];
    return det;
}

template <int D, int N>
struct SolidGeometry {
    static constexpr int stride = L8;  // between what `gradients` points to, of W elements each
    const SolidView& v;
    const int block, lane;  // lane: first of the W lanes
    const int n_nodes;

    VISVIVA_INLINE SolidGeometry(const SolidView& view, int b, int l)
        : v(view), block(b), lane(l), n_nodes(N > 0 ? N : view.n_nodes) {}
    VISVIVA_INLINE int nodes() const { return N > 0 ? N : n_nodes; }
    VISVIVA_INLINE const double* gradients(int q) const {
        return v.G + ((static_cast<std::int64_t>(block) * v.n_points + q) * nodes()) * D * L8 + lane;
    }
    VISVIVA_INLINE V volume(int q) const {
        return vload(v.w + (static_cast<std::int64_t>(block) * v.n_points + q) * L8 + lane);
    }
    VISVIVA_INLINE V kept_mass(int pair) const {
        const int pairs = nodes() * (nodes() + 1) / 2;
        return vload(v.mass + (static_cast<std::int64_t>(block) * pairs + pair) * L8 + lane);
    }
    VISVIVA_INLINE V mass(int a, int b) const {
        return kept_mass(a < b ? packed(nodes(), a, b) : packed(nodes(), b, a));
    }
};

/// Bricks; their points are those of two by two by two.
template <>
struct SolidGeometry<3, 8> {
    static constexpr int stride = W, n_nodes = 8, n_points = brick_points, n_pairs = 36;
    const SolidView& v;
    const int block, lane;
    alignas(64) V G[n_points * n_nodes * 3], w[n_points];

    VISVIVA_INLINE SolidGeometry(const SolidView& view, int b, int l) : v(view), block(b), lane(l) {
        for (int q = 0; q < n_points; ++q) work_out(q);
    }
    VISVIVA_INLINE static constexpr int nodes() { return n_nodes; }
    VISVIVA_INLINE const double* gradients(int q) const {
        return reinterpret_cast<const double*>(G + q * n_nodes * 3);
    }
    VISVIVA_INLINE V volume(int q) const { return w[q]; }
    VISVIVA_INLINE V mass(int a, int b) const {
        const int pair = a < b ? packed(n_nodes, a, b) : packed(n_nodes, b, a);
        if (v.mass) return vload(v.mass + (static_cast<std::int64_t>(block) * n_pairs + pair) * L8 + lane);
        V sum{};
        VISVIVA_FLATTEN
        for (int q = 0; q < n_points; ++q) sum += w[q] * v.brick->mass[q * n_pairs + pair];
        return sum;
    }

  private:
    // G_a = J^-T dN_a, weight |J|
    VISVIVA_INLINE void work_out(int q) {
        const double *X = v.X + static_cast<std::int64_t>(block) * n_nodes * 3 * L8 + lane,
                     *dN = v.brick->slopes + q * n_nodes * 3;
        V J[9] = {}, inverse[9];
        VISVIVA_FLATTEN
        for (int a = 0; a < n_nodes; ++a) VISVIVA_FLATTEN
        for (int i = 0; i < 3; ++i) {
            const V place = vload(X + (3 * a + i) * L8);
            VISVIVA_FLATTEN
            for (int k = 0; k < 3; ++k) J[3 * i + k] += place * dN[3 * a + k];
        }
        w[q] = invert(J, inverse) * v.brick->weight[q];
        for (int a = 0; a < n_nodes; ++a) VISVIVA_FLATTEN
        for (int i = 0; i < 3; ++i)
            G[(q * n_nodes + a) * 3 + i] =
                inverse[i] * dN[3 * a] + inverse[3 + i] * dN[3 * a + 1] + inverse[6 + i] * dN[3 * a + 2];
    }
};

}  // namespace visviva::VISVIVA_ISA
