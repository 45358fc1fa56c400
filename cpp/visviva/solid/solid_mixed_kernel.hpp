// Residual, tangent, energy and fields of batches of F-bar and mixed elements.
#pragma once
#include "visviva/solid/solid_dispatch.hpp"
#include "visviva/solid/solid_fbar.hpp"
#include "visviva/solid/solid_pressure.hpp"
#include "visviva/solid/solid_scatter.hpp"

namespace visviva::VISVIVA_ISA {

/// Calls f(element, block, lane, active lanes) for every W elements of some blocks.
template <class Map, class F>
VISVIVA_INLINE void for_mixed(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                              F f) {
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < L8; lane += W) {
            const SolidElement<Map::dim, 0> e(v, step, x, block, lane);
            SolidOfMap<Map> element(e);
            f(element, block, lane, e.active());
        }
}

template <class Map>
struct Mixed {
    static constexpr int D = Map::dim;
    static void residual(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                         double* r) {
        for_mixed<Map>(v, step, x, begin, end, [&](auto& element, int, int, int n) {
            V f[mixed_max_unknowns];
            element.forces(f);
            solid_scatter_forces(element.e, f, n, r);
            for (int k = 0; k < v.n_pressures; ++k)
                for (int l = 0; l < n; ++l) r[element.e.pressure_index(k)[l]] += f[element.n_motion + k][l];
        });
    }

    static void tangent(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                        double* values) {
        for_mixed<Map>(v, step, x, begin, end, [&](auto& element, int block, int lane, int n) {
            V K[mixed_max_unknowns * mixed_max_unknowns];
            element.tangent(K);
            const int n_nodes = element.e.nodes(), n_all = n_nodes + v.n_pressures;
            for (int a = 0, row = 0; a < n_all; row += a++ < n_nodes ? D : 1)
                for (int b = 0, column = 0; b < n_all; column += b++ < n_nodes ? D : 1) {
                    const std::int64_t at = (static_cast<std::int64_t>(block) * n_all + a) * L8 + lane,
                                       pair = (at - lane) * n_all + b * L8 + lane;
                    for (int l = 0; l < n; ++l) {
                        if (v.row[at + l] < 0 || v.offset[pair + l] == 0xffff) continue;
                        double* to = values + v.row[at + l] + v.offset[pair + l];
                        for (int i = 0; i < (a < n_nodes ? D : 1); ++i)
                            for (int j = 0; j < (b < n_nodes ? D : 1); ++j)
                                to[i * v.length[at + l] + j] +=
                                    K[(row + i) * element.n_unknowns + column + j][l];
                    }
                }
        });
    }

    static void energy(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                       double* out) {
        for_mixed<Map>(v, step, x, begin, end, [&](auto& element, int block, int lane, int) {
            vstore(out + (block - begin) * L8 + lane, element.energy());
        });
    }

    static void fields(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                       double* out) {
        for_mixed<Map>(v, step, x, begin, end, [&](auto& element, int block, int lane, int n) {
            for (int q = 0; q < v.n_points; ++q) {
                V row[solid_field_rows];
                element.field(q, row);
                put_rows(row, solid_field_rows, (block - begin) * L8 + lane, v.n_points * solid_field_rows,
                         q * solid_field_rows, n, out);
            }
        });
    }

    static void forces(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                       double* out) {
        for_mixed<Map>(v, step, x, begin, end, [&](auto& element, int block, int lane, int n) {
            V f[mixed_max_unknowns];
            element.forces(f);
            put_rows(f, element.n_motion, (block - begin) * L8 + lane, element.n_motion, 0, n, out);
        });
    }

    static constexpr MixedKernels table = {residual, tangent, energy, fields, forces};
};

}  // namespace visviva::VISVIVA_ISA
