// Elements of any physics that is written at a point, W at a time: strain map x energy x pairing x step.
#pragma once
#include <type_traits>
#include <utility>

#include "visviva/material/discrete_gradient.hpp"
#include "visviva/point/internal.hpp"
#include "visviva/point/pairings.hpp"
#include "visviva/point/point.hpp"
#include "visviva/point/quadratic.hpp"

namespace visviva::VISVIVA_ISA {

constexpr int P8 = point_lanes;

template <class M, class E, class P>
struct Physics {
    using Map = M;
    using Energy = E;
    using Pairing = P;
};

template <class Physics>
struct PointElement {
    using Map = typename Physics::Map;
    using Energy = typename Physics::Energy;
    using Pairing = typename Physics::Pairing;
    using Rows = Strains<Map>;
    static constexpr int n_y = Map::n_local, n_e = Map::n_strains, n_z = Energy::n, n_h = Energy::n_internal,
                         n_s = n_z - n_h;  // local unknowns; strains of the map, of the energy; internal
    // Strains of the map that the energy's are linear in, turn(par) [n_s][n_m], or that are its own; stresses
    // by them.
    static constexpr bool turned = Energy::n_turned > 0;
    static constexpr int n_m = turned ? Energy::n_turned : n_s, n_f = turned ? n_m : n_z;
    static_assert(n_m <= n_e);
    static_assert(!turned || n_h == 0);
    static constexpr int max_unknowns = Map::n_components * point_max_nodes;

    const PointView& v;
    const Step& step;
    const int block, lane;              // lane: first of the W lanes
    int first[Map::n_groups + 1] = {};  // unknowns of groups within the element
    V u0[max_unknowns], u1[max_unknowns], rate[max_unknowns], second_rate[max_unknowns];

    PointElement(const PointView& view, const Step& s, const Vectors& x, int b, int l)
        : v(view), step(s), block(b), lane(l) {
        for (int g = 0; g < Map::n_groups; ++g) {
            const int components = Map::groups[g].components;
            first[g + 1] = first[g] + v.group[g].n_nodes * components;
            for (int a = 0; a < v.group[g].n_nodes; ++a)
                for (int c = 0; c < components; ++c) {
                    const int i = first[g] + a * components + c, *at = slot(g, a);
                    u0[i] = gather(x.x0 + c, at), u1[i] = gather(x.x1 + c, at);
                    if (x.rate) rate[i] = gather(x.rate + c, at);
                    if (v.group[g].mass) second_rate[i] = gather(x.second_rate + c, at);
                }
        }
    }
    VISVIVA_INLINE int active() const { return v.n - block * P8 - lane < W ? v.n - block * P8 - lane : W; }
    VISVIVA_INLINE const int* slot(int g, int a) const {
        return v.index + (static_cast<std::int64_t>(block) * v.n_slots + v.group[g].first_slot + a) * P8 +
               lane;
    }
    VISVIVA_INLINE std::int64_t point(int q) const {
        return (static_cast<std::int64_t>(block) * v.n_points + q) * P8 + lane;
    }
    VISVIVA_INLINE V volume(int q) const { return vload(v.w + point(q)); }
    VISVIVA_INLINE const double* at_point(const double* data, int q, int size) const {
        return data + (static_cast<std::int64_t>(block) * v.n_points + q) * size * P8 + lane;
    }
    VISVIVA_INLINE const double* weights(int g, int q, int a) const {
        const int columns = Map::groups[g].columns;
        return at_point(v.group[g].weights, q, v.group[g].n_nodes * columns) + a * columns * P8;
    }
    VISVIVA_INLINE V mass(int g, int a, int b) const {
        const int n = v.group[g].n_nodes, k = a < b ? packed(n, a, b) : packed(n, b, a);
        return vload(v.group[g].mass + (static_cast<std::int64_t>(block) * (n * (n + 1) / 2) + k) * P8 +
                     lane);
    }

    /// Derivatives of a local unknown's value where it acts, and of its rate, by its value at the end of the
    /// step.
    VISVIVA_INLINE double share(int g) const { return Map::groups[g].is_end ? 1.0 : step.theta; }
    VISVIVA_INLINE double rate_factor(int g) const {
        const int order = Map::groups[g].order;
        return order == 2 ? step.motion[0][0] : order == 1 ? step.transport[0][0] : 0.0;
    }

    /// Calls f for every group, its number known to the compiler: short loops over components and columns
    /// stay in registers.
    template <class F>
    static VISVIVA_INLINE void for_groups(F&& f) {
        [&]<int... g>(std::integer_sequence<int, g...>) {
            (f(std::integral_constant<int, g>{}), ...);
        }(std::make_integer_sequence<int, Map::n_groups>{});
    }
    /// First local unknown of a group.
    static constexpr int start(int g) {
        int j = 0;
        for (int k = 0; k < g; ++k) j += Map::groups[k].components * Map::groups[k].columns;
        return j;
    }

    /// Local unknowns of element vectors, less their values in the reference.
    VISVIVA_INLINE void local(int q, const V* u, V* y) const {
        for_groups([&](auto group) {
            constexpr int g = group, n_c = Map::groups[g].components, n_k = Map::groups[g].columns;
            V sum[n_c * n_k] = {};
            for (int a = 0; a < v.group[g].n_nodes; ++a) {
                const double* w = weights(g, q, a);
                for (int k = 0; k < n_k; ++k) {
                    const V weight = vload(w + k * P8);
                    for (int c = 0; c < n_c; ++c) sum[c * n_k + k] += u[first[g] + a * n_c + c] * weight;
                }
            }
            for (int i = 0; i < n_c * n_k; ++i) y[start(g) + i] = sum[i];
        });
    }

    struct Point {
        V y0[n_y], y1[n_y], yt[n_y], rate[n_y];
        V z0[n_z], z1[n_z], zt[n_z];  // strains of the energy, internal ones last
        V e0[n_e], e1[n_e], et[n_e], B1[n_e * n_y], Bt[n_e * n_y];  // of the map
        V s[n_f], T[n_f * n_f], par[Energy::max_par > 0 ? Energy::max_par : 1];
    };

    void strains(int q, Point& p) const {
        local(q, u0, p.y0), local(q, u1, p.y1), local(q, rate, p.rate);
        for (int j = 0; j < n_y; ++j) {
            p.y0[j] -= Map::origin(j), p.y1[j] -= Map::origin(j);
            const double theta = share(Map::group_of(j));
            p.yt[j] = theta == 1.0 ? p.y1[j] : p.y0[j] + theta * (p.y1[j] - p.y0[j]);
        }
        Rows::evaluate(p.y0, p.e0), Rows::evaluate(p.y1, p.e1, p.B1), Rows::evaluate(p.yt, p.et, p.Bt);
        for (int k = 0; v.reference && k < n_e; ++k) {
            const V r = vload(at_point(v.reference, q, n_e) + k * P8);
            p.e0[k] -= r, p.e1[k] -= r, p.et[k] -= r;
        }
        for (int k = 0; k < v.n_par; ++k) p.par[k] = vload(at_point(v.par, q, v.n_par) + k * P8);
        if constexpr (turned)
            turn(p.par, p.e0, p.z0), turn(p.par, p.e1, p.z1), turn(p.par, p.et, p.zt);
        else
            for (int k = 0; k < n_s; ++k) p.z0[k] = p.e0[k], p.z1[k] = p.e1[k], p.zt[k] = p.et[k];
        for (int k = 0; !v.called_s && k < n_h; ++k)
            p.z0[n_s + k] = vload(at_point(v.history0, q, n_h) + k * P8);
    }

    static void turn(const V* par, const V* e, V* z) {
        const V* A = Energy::turn(par);
        for (int k = 0; k < n_s; ++k) {
            z[k] = V{};
            for (int m = 0; m < n_m; ++m) z[k] += A[k * n_m + m] * e[m];
        }
    }
    template <bool tangent>
    static void turn_back(Point& p) {
        const V* A = Energy::turn(p.par);
        V s[n_s], T[n_s * n_s], by[n_s * n_m];
        for (int k = 0; k < n_s; ++k) s[k] = p.s[k];
        for (int k = 0; tangent && k < n_s * n_s; ++k) T[k] = p.T[k];
        for (int m = 0; m < n_m; ++m) {
            p.s[m] = V{};
            for (int k = 0; k < n_s; ++k) p.s[m] += A[k * n_m + m] * s[k];
        }
        for (int k = 0; tangent && k < n_s; ++k)
            for (int m = 0; m < n_m; ++m) {
                by[k * n_m + m] = V{};
                for (int l = 0; l < n_s; ++l) by[k * n_m + m] += T[k * n_s + l] * A[l * n_m + m];
            }
        for (int j = 0; tangent && j < n_m; ++j)
            for (int m = 0; m < n_m; ++m) {
                V sum{};
                for (int k = 0; k < n_s; ++k) sum += A[k * n_m + j] * by[k * n_m + m];
                p.T[j * n_f + m] = sum;
            }
    }

    /// Stresses and their moduli: by the strains at the end for discrete gradients, else by those at theta.
    template <bool tangent>
    void stress(int q, Point& p) const {
        own_stress<tangent>(q, p);
        if constexpr (turned) turn_back<tangent>(p);
    }
    template <bool tangent>
    void own_stress(int q, Point& p) const {
        if (v.called_s) return called<tangent>(q, p);
        const Energy energy(p.par);
        if constexpr (requires { energy.is_defined(p.z1); }) {
            const VI defined = energy.is_defined(p.z1);
            for (int l = 0; l < active(); ++l)
                if (!defined[l]) v.lost_way[block * P8 + lane + l] = 1;
        }
        if constexpr (requires(V* a) { energy.template discrete_gradient<tangent>(a, a, a, a); }) {
            if (step.stress == Stress::discrete_gradient)
                return energy.template discrete_gradient<tangent>(p.z0, p.z1, p.s, p.T);
        }
        if constexpr (n_h > 0) {
            const VI found = evolve<tangent>(energy, step, active(), p.z0, p.z1, p.zt, p.s, p.T);
            for (int l = 0; l < W; ++l)
                if (!found[l]) v.lost_way[block * P8 + lane + l] = 1;
            for (int k = 0; k < n_h; ++k)
                vstore(v.history1 + (at_point(v.history0, q, n_h) - v.history0) + k * P8, p.z1[n_s + k]);
        } else {
            conjugate_stress<tangent>(energy, step, p.z0, p.z1, p.zt, p.s, p.T);
        }
    }

    template <bool tangent>
    void called(int q, Point& p) const {
        const std::int64_t at = point(q), stride = static_cast<std::int64_t>(v.n_blocks) * v.n_points * P8;
        for (int k = 0; k < n_s; ++k) {
            p.s[k] = vload(v.called_s + k * stride + at);
            for (int l = 0; tangent && l < n_s; ++l)
                p.T[n_z * k + l] = vload(v.called_T + (n_s * k + l) * stride + at);
        }
    }

    // ds/dy1 [n_m][n_y]
    void stress_rows(const Point& p, V* rows) const {
        for (int k = 0; k < n_m * n_y; ++k) rows[k] = V{};
        const bool ends = step.stress == Stress::discrete_gradient;
        for (const auto& [m, j] : Rows::sparse.entry) {
            if (m >= n_m) continue;
            const V b = ends ? p.B1[m * n_y + j] : share(Map::group_of(j)) * p.Bt[m * n_y + j];
            for (int k = 0; k < n_m; ++k) rows[k * n_y + j] += p.T[n_f * k + m] * b;
        }
    }

    /// Forces f on the strains of the map: values, and derivatives by y1 where T is a jet.
    template <bool slopes>
    void pair(const Point& p, const V* rows, typename Number<n_y, slopes>::type* f) const {
        using Value = Number<n_y, slopes>;
        if constexpr (Pairing::is_gradient) {
            for (int k = 0; k < n_m; ++k) f[k] = Value::of(p.s[k], rows + k * n_y);
            for (int k = n_m; k < n_e; ++k) f[k] = Value::of(V{}, nullptr);
        } else {
            const auto state = state_of<slopes>(p, rows);
            Pairing::forces(state, f);
        }
    }

    template <bool slopes>
    PointState<Number<n_y, slopes>, n_e, n_m> state_of(const Point& p, const V* rows) const {
        using Value = Number<n_y, slopes>;
        PointState<Value, n_e, n_m> state;
        state.par = p.par, state.h = step.h, state.moves = !step.is_static();
        state.backwards = v.backwards;
        V at[n_y], change[n_y];
        for (int k = 0; k < n_m; ++k) state.s[k] = Value::of(p.s[k], rows + k * n_y);
        for (int k = 0; k < n_e; ++k) {
            V speed{};
            for (int j = 0; j < n_y; ++j) {
                const V b = p.Bt[k * n_y + j];
                at[j] = share(Map::group_of(j)) * b, change[j] = rate_factor(Map::group_of(j)) * b;
                speed += b * p.rate[j];
            }
            for (const auto& [m, j, l, factor] : Rows::sparse.square)
                if (m == k) change[l] += (factor * share(Map::group_of(l))) * p.rate[j];
            state.e[k] = Value::of(p.et[k], at);
            state.rate[k] = Value::of(speed, change);
            state.change[k] = Value::of(p.e1[k] - p.e0[k], p.B1 + k * n_y);
        }
        return state;
    }

    /// Forces on the local unknowns, f . de/dy at theta; and their derivatives by y1 [n_y][n_y].
    template <bool tangent>
    void local_forces(const Point& p, V* F, V* K) const {
        for (int j = 0; j < n_y; ++j) F[j] = V{};
        if constexpr (!tangent) {
            V f[n_e];
            pair<false>(p, p.s, f);
            for (const auto& [k, j] : Rows::sparse.entry) F[j] += f[k] * p.Bt[k * n_y + j];
        } else {
            V rows[n_m * n_y];
            Jet<n_y, false> f[n_e];
            stress_rows(p, rows), pair<true>(p, rows, f);
            for (int k = 0; k < n_y * n_y; ++k) K[k] = V{};
            for (const auto& [k, j] : Rows::sparse.entry) {
                const V b = p.Bt[k * n_y + j];
                F[j] += f[k].v * b;
                for (int l = 0; l < n_y; ++l) K[j * n_y + l] += b * f[k].g[l];
            }
            for (const auto& [k, j, l, factor] : Rows::sparse.square)
                K[j * n_y + l] += (factor * share(Map::group_of(l))) * f[k].v;
        }
    }

    void add_forces(int q, const V* F, V* r) const {
        const V w = volume(q);
        for_groups([&](auto group) {
            constexpr int g = group, n_c = Map::groups[g].components, n_k = Map::groups[g].columns;
            V f[n_c * n_k];
            for (int i = 0; i < n_c * n_k; ++i) f[i] = w * F[start(g) + i];
            for (int a = 0; a < v.group[g].n_nodes; ++a)
                for (int c = 0; c < n_c; ++c) {
                    V sum = r[first[g] + a * n_c + c];
                    for (int k = 0; k < n_k; ++k) sum += vload(weights(g, q, a) + k * P8) * f[c * n_k + k];
                    r[first[g] + a * n_c + c] = sum;
                }
        });
    }

    void add_moduli(int q, const V* K, V* to) const {
        const V w = volume(q);
        for_groups([&](auto group) {
            constexpr int g = group, n_c = Map::groups[g].components, n_k = Map::groups[g].columns;
            for (int a = 0; a < v.group[g].n_nodes; ++a) {
                V row[n_c * n_y] = {};
                for (int k = 0; k < n_k; ++k) {
                    const V weight = w * vload(weights(g, q, a) + k * P8);
                    for (int c = 0; c < n_c; ++c)
                        for (int l = 0; l < n_y; ++l)
                            row[c * n_y + l] += weight * K[(start(g) + c * n_k + k) * n_y + l];
                }
                add_rows<n_c>(q, row, to + (first[g] + a * n_c) * v.n_unknowns);
            }
        });
    }
    // The rows of n nodal unknowns by local unknowns [n][n_y], by those of the element.
    template <int n>
    VISVIVA_INLINE void add_rows(int q, const V* row, V* to) const {
        for_groups([&](auto group) {
            constexpr int g = group, n_c = Map::groups[g].components, n_k = Map::groups[g].columns;
            for (int b = 0; b < v.group[g].n_nodes; ++b) {
                V weight[n_k];
                for (int k = 0; k < n_k; ++k) weight[k] = vload(weights(g, q, b) + k * P8);
                for (int i = 0; i < n; ++i)
                    for (int c = 0; c < n_c; ++c) {
                        V& entry = to[i * v.n_unknowns + first[g] + b * n_c + c];
                        V sum = entry;
                        for (int k = 0; k < n_k; ++k)
                            sum += row[i * n_y + start(g) + c * n_k + k] * weight[k];
                        entry = sum;
                    }
            }
        });
    }

    /// Adds to the element's residual r, and to its tangent K unless that is null.
    template <bool tangent>
    void assemble(V* r, V* K) const {
        for (int k = 0; k < v.n_unknowns; ++k) r[k] = V{};
        for (int k = 0; tangent && k < v.n_unknowns * v.n_unknowns; ++k) K[k] = V{};
        V F[n_y], moduli[tangent ? n_y * n_y : 1];
        for (int q = 0; q < v.n_points; ++q) {
            Point p;
            strains(q, p);
            stress<tangent>(q, p);
            local_forces<tangent>(p, F, moduli);
            add_forces(q, F, r);
            if constexpr (tangent) add_moduli(q, moduli, K);
        }
        for (int g = 0; g < Map::n_groups; ++g)
            if (v.group[g].mass) inertia<tangent>(g, r, K);
    }

    template <bool tangent>
    void inertia(int g, V* r, V* K) const {
        const int n_c = Map::groups[g].components;
        for (int a = 0; a < v.group[g].n_nodes; ++a)
            for (int b = 0; b < v.group[g].n_nodes; ++b)
                for (int c = 0; c < n_c; ++c) {
                    const int i = first[g] + a * n_c + c, j = first[g] + b * n_c + c;
                    r[i] += mass(g, a, b) * second_rate[j];
                    if constexpr (tangent) K[i * v.n_unknowns + j] += step.motion[1][0] * mass(g, a, b);
                }
    }

    /// Energy and dissipated work of the step at the points, see point_ledger_rows.
    void point_ledger(V* row) const {
        for (int q = 0; q < v.n_points; ++q) {
            Point p;
            strains(q, p);
            stress<false>(q, p);
            const V w = volume(q);
            if (v.called_W) {
                row[0] += w * vload(v.called_W + point(q));
                if (v.called_lost) row[9] += w * vload(v.called_lost + point(q));
            } else {
                Potential<n_z> end;
                Energy(p.par).template evaluate<false>(p.z1, end);
                row[0] += w * end.W;
            }
            for (int k = n_s; !v.called_W && k < n_z; ++k) row[9] -= w * p.s[k] * (p.z1[k] - p.z0[k]);
            if constexpr (!Pairing::is_gradient) row[2] += w * Pairing::dissipated(state_of<false>(p, p.s));
        }
    }

    /// Kinetic energy and momenta of a group at rates v1.
    void inertia_ledger(int g, const double* v1, V* row) const {
        const int n_c = Map::groups[g].components;
        for (int a = 0; a < v.group[g].n_nodes; ++a) {
            V p[3] = {}, place[3] = {};
            for (int b = 0; b < v.group[g].n_nodes; ++b)
                for (int c = 0; c < n_c; ++c) p[c] += mass(g, a, b) * gather(v1 + c, slot(g, b));
            for (int c = 0; c < n_c; ++c) {
                place[c] = u1[first[g] + a * n_c + c];
                row[1] += 0.5 * gather(v1 + c, slot(g, a)) * p[c];
                if (v.group[g].is_position) row[3 + c] += p[c];
            }
            row[6] += place[1] * p[2] - place[2] * p[1];
            row[7] += place[2] * p[0] - place[0] * p[2];
            row[8] += place[0] * p[1] - place[1] * p[0];
        }
    }
};

}  // namespace visviva::VISVIVA_ISA
