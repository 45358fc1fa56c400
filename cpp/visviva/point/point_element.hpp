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

    // Aligned, as functions of templates take vectors for aligned to their size.
    struct alignas(W * sizeof(double)) Point {
        V y0[n_y], y1[n_y], yt[n_y], rate[n_y];
        V z0[n_z], z1[n_z], zt[n_z];  // strains of the energy, internal ones last
        V e0[n_e], e1[n_e], et[n_e], B1[Rows::n_entries], Bt[Rows::n_entries];  // of the map
        V s[n_f], T[n_f * n_f], par[Energy::max_par > 0 ? Energy::max_par : 1];
        V lost{};                    // by internal ones
        V excess{}, excess_by[n_f];  // see find_excess; its derivatives by the strains at the end
        bool keeps_heat = false;     // whether there is one
    };

    template <bool tangent>
    void strains(int q, Point& p) const {
        local(q, u0, p.y0), local(q, u1, p.y1);
        if constexpr (!Pairing::is_gradient) local(q, rate, p.rate);
        for (int j = 0; j < n_y; ++j) {
            p.y0[j] -= Map::origin(j), p.y1[j] -= Map::origin(j);
            const double theta = share(Map::group_of(j));
            p.yt[j] = theta == 1.0 ? p.y1[j] : p.y0[j] + theta * (p.y1[j] - p.y0[j]);
        }
        Rows::evaluate(p.y0, p.e0), Rows::evaluate(p.y1, p.e1), Rows::evaluate(p.yt, p.et);
        Rows::rows(p.yt, p.Bt);
        if constexpr (tangent) Rows::rows(p.y1, p.B1);
        for (int k = 0; v.reference && k < n_e; ++k) {
            const V r = vload(at_point(v.reference, q, n_e) + k * P8);
            p.e0[k] -= r, p.e1[k] -= r, p.et[k] -= r;
        }
        const double* par = v.is_even ? v.par + lane : at_point(v.par, q, v.n_par);
        for (int k = 0; k < v.n_par; ++k) p.par[k] = vload(par + k * P8);
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
        V s[n_s], T[n_s * n_s], by[n_s * n_m], excess_by[n_s];
        for (int k = 0; k < n_s; ++k) s[k] = p.s[k];
        for (int k = 0; tangent && k < n_s * n_s; ++k) T[k] = p.T[k];
        for (int k = 0; tangent && p.keeps_heat && k < n_s; ++k) excess_by[k] = p.excess_by[k];
        for (int m = 0; m < n_m; ++m) {
            p.s[m] = V{};
            for (int k = 0; k < n_s; ++k) p.s[m] += A[k * n_m + m] * s[k];
            if (!tangent || !p.keeps_heat) continue;
            p.excess_by[m] = V{};
            for (int k = 0; k < n_s; ++k) p.excess_by[m] += A[k * n_m + m] * excess_by[k];
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
            if constexpr (requires(V* a) { energy.template follow<tangent>(step, V{}, a, a, a, a, a); }) {
                energy.template follow<tangent>(step, p.rate[0], p.z0, p.z1, p.zt, p.s, p.T);
            } else if constexpr (requires(V* a) { energy.template remember<tangent>(step, a, a, a, a, a); }) {
                energy.template remember<tangent>(step, p.z0, p.z1, p.zt, p.s, p.T);
            } else {
                const VI found = evolve<tangent>(energy, step, active(), p.z0, p.z1, p.zt, p.s, p.T, p.lost);
                for (int l = 0; l < W; ++l)
                    if (!found[l]) v.lost_way[block * P8 + lane + l] = 1;
            }
            for (int k = 0; k < n_h; ++k)
                vstore(v.history1 + (at_point(v.history0, q, n_h) - v.history0) + k * P8, p.z1[n_s + k]);
        } else {
            conjugate_stress<tangent>(energy, step, p.z0, p.z1, p.zt, p.s, p.T);
            if constexpr (requires { Energy::n_entropies; })
                if (step.goes_to_ends()) find_excess<tangent>(energy, p);
        }
    }

    /// What the energy gains along the entropies is less than their gains times the temperatures at the end,
    /// as it is convex: backward Euler would lose the difference.
    template <bool tangent>
    static void find_excess(const Energy& energy, Point& p) {
        V from[n_z];
        for (int k = 0; k < n_z; ++k) from[k] = is_entropy(k) ? p.z0[k] : p.z1[k];
        Potential<n_z> start, end;
        energy.template evaluate<false>(from, start);
        V gain;
        if constexpr (requires { energy.increase(from, p.z1); })
            gain = energy.increase(from, p.z1);
        else
            energy.template evaluate<false>(p.z1, end), gain = end.W - start.W;
        conjugate<false>(energy, start.s, nullptr);
        take_excess<tangent>(gain, start.s, p);
    }
    static constexpr bool is_entropy(int k) {
        return k >= Energy::first_entropy && k < Energy::first_entropy + Energy::n_entropies;
    }
    /// The same where the gain is known, and the stresses from where it is taken.
    template <bool tangent>
    static void take_excess(V gain, const V* stress_before, Point& p) {
        constexpr int first = Energy::first_entropy, last = first + Energy::n_entropies;
        p.excess = gain, p.keeps_heat = true;
        for (int k = first; k < last; ++k) p.excess -= p.s[k] * (p.z1[k] - p.z0[k]);
        for (int l = 0; tangent && l < n_z; ++l) {
            p.excess_by[l] = is_entropy(l) ? V{} : p.s[l] - stress_before[l];
            for (int k = first; k < last; ++k) p.excess_by[l] -= p.T[k * n_z + l] * (p.z1[k] - p.z0[k]);
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
        if constexpr (requires { Energy::n_entropies; }) {
            if (!v.unheated_W) return;
            V before[n_z];
            for (int k = 0; k < n_s; ++k) before[k] = vload(v.unheated_s + k * stride + at);
            take_excess<tangent>(vload(v.called_W + at) - vload(v.unheated_W + at), before, p);
        }
    }

    // ds/dy1 [n_m][n_y]
    void stress_rows(const Point& p, V* rows) const {
        for (int k = 0; k < n_m * n_y; ++k) rows[k] = V{};
        const bool ends = step.stress == Stress::discrete_gradient;
        each<Rows::n_entries>([&](auto i) {
            const auto [m, j] = Rows::sparse.entry[i];
            if (m >= n_m) return;
            const V b = ends ? p.B1[i] : share(Map::group_of(j)) * p.Bt[i];
            for (int k = 0; k < n_m; ++k) rows[k * n_y + j] += p.T[n_f * k + m] * b;
        });
    }

    /// Forces f on the strains of the map: values, and derivatives by y1 where T is a jet.
    template <bool slopes>
    void pair(const Point& p, const V* rows, typename Number<n_y, slopes>::type* f) const {
        const PointState<PointElement, slopes> state(*this, p, rows);
        if constexpr (Pairing::is_gradient) {
            for (int k = 0; k < n_m; ++k) f[k] = state.s(k);
            for (int k = n_m; k < n_e; ++k) f[k] = Number<n_y, slopes>::of(V{}, nullptr);
        } else {
            Pairing::forces(state, f);
        }
    }

    /// Forces on the local unknowns, f . de/dy at theta; and their derivatives by y1 [n_y][n_y].
    template <bool tangent>
    void local_forces(const Point& p, V* F, V* K) const {
        for (int j = 0; j < n_y; ++j) F[j] = V{};
        if constexpr (!tangent) {
            V f[n_e];
            pair<false>(p, p.s, f);
            each<Rows::n_entries>([&](auto i) {
                const auto [k, j] = Rows::sparse.entry[i];
                F[j] += f[k] * p.Bt[i];
            });
        } else {
            V rows[n_m * n_y];
            Jet<n_y, false> f[n_e];
            stress_rows(p, rows), pair<true>(p, rows, f);
            for (int k = 0; k < n_y * n_y; ++k) K[k] = V{};
            each<Rows::n_entries>([&](auto i) {
                const auto [k, j] = Rows::sparse.entry[i];
                F[j] += f[k].v * p.Bt[i];
                for (int l = 0; l < n_y; ++l) K[j * n_y + l] += p.Bt[i] * f[k].g[l];
            });
            each<Rows::n_square>([&](auto i) {
                const auto& q = Rows::sparse.square[i];
                K[q.j * n_y + q.l] += (q.factor * share(Map::group_of(q.l))) * f[q.k].v;
            });
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
                    for (int k = 0; k < Map::tested(g); ++k)
                        sum += vload(weights(g, q, a) + k * P8) * f[c * n_k + k];
                    r[first[g] + a * n_c + c] = sum;
                }
        });
    }

    /// Rows of a node's unknowns by local unknowns [point][component][n_y], from those of local unknowns
    /// `moduli` [point][n_y][n_y].
    template <int g>
    void node_rows(int a, const V* moduli, V* rows) const {
        constexpr int n_c = Map::groups[g].components, n_k = Map::groups[g].columns;
        for (int q = 0; q < v.n_points; ++q)
            for_groups([&](auto other) {
                constexpr int h = other, begin = start(h), n = Map::groups[h].columns;
                if constexpr (Map::couples(g, h))
                    for (int c = 0; c < n_c; ++c)
                        for (int l = begin; l < start(h + 1); ++l) {
                            if ((l - begin) % n >= Map::tried(h)) continue;
                            const V* K = moduli + (q * n_y + start(g) + c * n_k) * n_y + l;
                            V sum{};
                            for (int k = 0; k < Map::tested(g); ++k)
                                sum += vload(weights(g, q, a) + k * P8) * K[k * n_y];
                            rows[(q * n_c + c) * n_y + l] = sum;
                        }
            });
    }
    /// The block of two nodes, [components of g][components of h], from rows of the first one.
    template <int g, int h>
    VISVIVA_INLINE void block_of(int b, const V* rows, V* block) const {
        constexpr int n_c = Map::groups[g].components, n_d = Map::groups[h].components,
                      n_k = Map::groups[h].columns;
        V sum[n_c * n_d] = {};
        for (int q = 0; q < v.n_points; ++q) {
            const double* w = weights(h, q, b);
            const V* row = rows + q * n_c * n_y + start(h);
            each<Map::tried(h)>([&](auto k) {
                const V weight = vload(w + k * P8);
                each<n_c * n_d>([&](auto i) { sum[i] += row[i / n_d * n_y + i % n_d * n_k + k] * weight; });
            });
        }
        for (int i = 0; i < n_c * n_d; ++i) block[i] = sum[i];
    }

    /// The element's residual r, and its moduli at the points by local unknowns [point][n_y][n_y].
    template <bool tangent>
    void assemble(V* r, V* moduli) const {
        for (int k = 0; k < v.n_unknowns; ++k) r[k] = V{};
        V F[n_y];
        for (int q = 0; q < v.n_points; ++q) {
            Point p;
            strains<tangent>(q, p);
            stress<tangent>(q, p);
            local_forces<tangent>(p, F, moduli);
            add_forces(q, F, r);
            if constexpr (tangent) {
                const V w = volume(q);
                for (int k = 0; k < n_y * n_y; ++k) moduli[k] *= w;
                moduli += n_y * n_y;
            }
        }
        for (int g = 0; g < Map::n_groups; ++g) {
            const int n_c = Map::groups[g].components;
            for (int a = 0; v.group[g].mass && a < v.group[g].n_nodes; ++a)
                for (int b = 0; b < v.group[g].n_nodes; ++b)
                    for (int c = 0; c < n_c; ++c)
                        r[first[g] + a * n_c + c] += mass(g, a, b) * second_rate[first[g] + b * n_c + c];
        }
    }

    /// Calls f(g, a, h, b, block) for the blocks of pairs of nodes a of g and b of h, from moduli at the
    /// points; `rows` has room for those of a node.
    template <class F>
    void for_blocks(const V* moduli, V* rows, F&& f) const {
        for_groups([&](auto group) {
            constexpr int g = group, n_c = Map::groups[g].components;
            for (int a = 0; a < v.group[g].n_nodes; ++a) {
                node_rows<g>(a, moduli, rows);
                for_groups([&](auto other) {
                    constexpr int h = other;
                    if constexpr (Map::couples(g, h))
                        for (int b = 0; b < v.group[h].n_nodes; ++b) {
                            V block[n_c * Map::groups[h].components];
                            block_of<g, h>(b, rows, block);
                            if (g == h && v.group[g].mass)
                                for (int c = 0; c < n_c; ++c)
                                    block[c * n_c + c] += step.motion[1][0] * mass(g, a, b);
                            f(group, a, other, b, block);
                        }
                });
            }
        });
    }

    /// Energy and dissipated work of the step at the points, see point_ledger_rows.
    void point_ledger(V* row) const {
        for (int q = 0; q < v.n_points; ++q) {
            Point p;
            strains<false>(q, p);
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
            row[9] += w * p.lost;
            if constexpr (!Pairing::is_gradient)
                row[2] += w * Pairing::dissipated(PointState<PointElement, false>(*this, p, p.s));
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
