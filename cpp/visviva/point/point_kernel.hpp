// Residual, tangent, ledger and strains of batches of elements of one physics.
#pragma once
#include "visviva/point/point_dispatch.hpp"
#include "visviva/point/point_element.hpp"

namespace visviva::VISVIVA_ISA {

/// Room for the vector of W elements, their moduli at points, and rows of a node there.
struct PointScratch {
    V *r, *moduli, *rows;
    PointScratch(int n, int n_moduli, int n_rows)
        : r(new V[n + n_moduli + n_rows]), moduli(r + n), rows(moduli + n_moduli) {}
    ~PointScratch() { delete[] r; }
    PointScratch(const PointScratch&) = delete;
    PointScratch& operator=(const PointScratch&) = delete;
};

template <class Physics>
struct PointKernel {
    using Element = PointElement<Physics>;
    using Map = typename Physics::Map;

    template <class F>
    static void each(const PointView& v, const Step& step, const Vectors& x, int begin, int end, F&& work) {
        for (int block = begin; block < end; ++block)
            for (int lane = 0; lane < P8; lane += W) {
                const Element e(v, step, x, block, lane);
                work(e);
            }
    }

    // Calls f(slot, first unknown within the element, components) for all slots.
    template <class F>
    static void for_slots(const Element& e, F&& f) {
        int s = 0;
        for (int g = 0; g < Map::n_groups; ++g)
            for (int a = 0; a < e.v.group[g].n_nodes; ++a, ++s)
                f(s, e.first[g] + a * Map::groups[g].components, Map::groups[g].components);
    }

    static void scatter_forces(const Element& e, const V* f, double* r) {
        for_slots(e, [&](int s, int first, int components) {
            const int* at = e.v.index + (static_cast<std::int64_t>(e.block) * e.v.n_slots + s) * P8 + e.lane;
            for (int c = 0; c < components; ++c)
                for (int l = 0; l < e.active(); ++l) r[at[l] + c] += f[first + c][l];
        });
    }

    /// Adds a block of rows `a` and columns `b`, slots of the element, to the matrix.
    template <int rows, int columns>
    static VISVIVA_INLINE void scatter_block(const Element& e, int a, int b, const V* block, double* values) {
        const PointView& v = e.v;
        const std::int64_t at = (static_cast<std::int64_t>(e.block) * v.n_slots + a) * P8 + e.lane;
        const std::int64_t pair = (at - e.lane) * v.n_slots + b * P8 + e.lane;
        for (int l = 0; l < e.active(); ++l) {
            if (v.row[at + l] < 0 || v.offset[pair + l] == 0xffff) continue;
            double* to = values + v.row[at + l] + v.offset[pair + l];
            for (int i = 0; i < rows; ++i)
                for (int j = 0; j < columns; ++j) to[i * v.length[at + l] + j] += block[i * columns + j][l];
        }
    }

    static void residual(const PointView& v, const Step& step, const Vectors& x, int begin, int end,
                         double* r) {
        PointScratch scratch(v.n_unknowns, 0, 0);
        each(v, step, x, begin, end, [&](const Element& e) {
            e.template assemble<false>(scratch.r, nullptr);
            scatter_forces(e, scratch.r, r);
        });
    }

    static void tangent(const PointView& v, const Step& step, const Vectors& x, int begin, int end, double* r,
                        double* values) {
        constexpr int n_y = Element::n_y;
        PointScratch scratch(v.n_unknowns, v.n_points * n_y * n_y, v.n_points * n_y * Map::n_components);
        each(v, step, x, begin, end, [&](const Element& e) {
            e.template assemble<true>(scratch.r, scratch.moduli);
            if (r) scatter_forces(e, scratch.r, r);
            e.for_blocks(scratch.moduli, scratch.rows, [&](auto g, int a, auto h, int b, const V* block) {
                scatter_block<Map::groups[g].components, Map::groups[h].components>(
                    e, v.group[g].first_slot + a, v.group[h].first_slot + b, block, values);
            });
        });
    }

    static void ledger(const PointView& v, const Step& step, const Vectors& x, const double* v1, int begin,
                       int end, double* out) {
        const std::int64_t stride = static_cast<std::int64_t>(v.n_blocks) * P8;
        each(v, step, x, begin, end, [&](const Element& e) {
            V row[point_ledger_rows] = {};
            e.point_ledger(row);
            for (int g = 0; g < Map::n_groups; ++g)
                if (v.group[g].mass) e.inertia_ledger(g, v1, row);
            for (int k = 0; k < point_ledger_rows; ++k)
                vstore(out + k * stride + e.block * P8 + e.lane, row[k]);
        });
    }

    // Strains of the energy at the start, theta and end for energies outside the core:
    // [strain][block][point][8].
    static void strains(const PointView& v, const Step& step, const Vectors& x, double* e0, double* et,
                        double* e1) {
        const std::int64_t stride = static_cast<std::int64_t>(v.n_blocks) * v.n_points * P8;
        each(v, step, x, 0, v.n_blocks, [&](const Element& e) {
            for (int q = 0; q < v.n_points; ++q) {
                typename Element::Point p;
                e.template strains<false>(q, p);
                for (int k = 0; k < Element::n_s; ++k) {
                    vstore(e0 + k * stride + e.point(q), p.z0[k]),
                        vstore(et + k * stride + e.point(q), p.zt[k]);
                    vstore(e1 + k * stride + e.point(q), p.z1[k]);
                }
            }
        });
    }

    static constexpr PointShape shape() {
        PointShape s{};
        s.n_groups = Map::n_groups, s.n_par = Physics::Energy::max_par, s.n_strains = Map::n_strains;
        s.n_energy = Element::n_s, s.n_history = Element::n_h;
        if constexpr (requires { Physics::Energy::n_entropies; })
            s.first_entropy = Physics::Energy::first_entropy, s.n_entropies = Physics::Energy::n_entropies;
        for (int g = 0; g < Map::n_groups; ++g) s.group[g] = Map::groups[g];
        return s;
    }
    static constexpr PointKernels table = {shape(), residual, tangent, ledger, strains};
};

}  // namespace visviva::VISVIVA_ISA
