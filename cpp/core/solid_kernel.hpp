// Residual, tangent and ledger of solid elements, W elements at a time.
#pragma once
#include "response.hpp"
#include "solid.hpp"

namespace visviva::VISVIVA_ISA {

constexpr int L8 = solid_lanes;

/// What a point's stress needs and gives.
struct SolidPoint {
    V F1[9], Ft[9], rate[9];    // deformation gradient at the end and at theta, its rate; row-major
    V c0[6], c1[6], ct[6];      // C - I
    V S[6], T[36], viscous[6];  // second Piola-Kirchhoff stress, 2 dS/dC, viscous part of S
    V det;                      // of F1
};

VISVIVA_INLINE V determinant(const V* F) {
    return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
           F[2] * (F[3] * F[7] - F[4] * F[6]);
}

template <int D, int N>
struct SolidElement {
    const SolidView& v;
    const Step& step;
    const Vectors& x;
    const int block, lane;  // lane: first of the W lanes
    const int n_nodes;
    V x0[solid_max_nodes * D], x1[solid_max_nodes * D];

    VISVIVA_INLINE SolidElement(const SolidView& view, const Step& s, const Vectors& vectors, int b, int l)
        : v(view), step(s), x(vectors), block(b), lane(l), n_nodes(N > 0 ? N : view.n_nodes) {
        for (int a = 0; a < nodes(); ++a)
            for (int c = 0; c < D; ++c) x0[a * D + c] = at(x.x0, a, c), x1[a * D + c] = at(x.x1, a, c);
    }
    VISVIVA_INLINE int nodes() const { return N > 0 ? N : n_nodes; }
    VISVIVA_INLINE const int* index(int a) const { return v.index + (block * nodes() + a) * L8 + lane; }
    VISVIVA_INLINE V at(const double* u, int a, int c) const { return gather(u + c, index(a)); }
    VISVIVA_INLINE const double* gradients(int q) const {
        return v.G + ((static_cast<std::int64_t>(block) * v.n_points + q) * nodes()) * D * L8 + lane;
    }
    VISVIVA_INLINE V volume(int q) const { return vload(v.w + point(q)); }
    VISVIVA_INLINE V hoop(int q, int a) const {
        return vload(v.H + ((static_cast<std::int64_t>(block) * v.n_points + q) * nodes() + a) * L8 + lane);
    }
    VISVIVA_INLINE V parameter(int k) const { return vload(v.par + (block * v.n_par + k) * L8 + lane); }
    VISVIVA_INLINE V mass(int a, int b) const {
        const int pairs = nodes() * (nodes() + 1) / 2,
                  k = a < b ? packed(nodes(), a, b) : packed(nodes(), b, a);
        return vload(v.mass + (static_cast<std::int64_t>(block) * pairs + k) * L8 + lane);
    }
    VISVIVA_INLINE V viscosity(int k) const { return vload(v.damping + (block * 3 + k) * L8 + lane); }

    // sum_a u_a x G_a, with the stretch across the plane in two dimensions
    VISVIVA_INLINE void gradient(const V* u, int q, double across, V* F) const {
        for (int k = 0; k < 9; ++k) F[k] = V{};
        const double* G = gradients(q);
        for (int a = 0; a < nodes(); ++a)
            for (int l = 0; l < D; ++l) {
                const V g = vload(G + (a * D + l) * L8);
                for (int i = 0; i < D; ++i) F[3 * i + l] += u[a * D + i] * g;
            }
        if constexpr (D == 2) {
            F[8] = broadcast(v.H ? 0.0 : across);
            for (int a = 0; v.H && a < nodes(); ++a) F[8] += hoop(q, a) * u[a * D];
        }
    }

    // C - I, or twice the small strain
    VISVIVA_INLINE void strain(const V* F, V* c) const {
        V f[9];
        for (int k = 0; k < 9; ++k) f[k] = F[k] - (k % 4 == 0 ? 1.0 : 0.0);
        for (int k = 0; k < 6; ++k) {
            const int i = voigt_a[k], j = voigt_b[k];
            c[k] = f[3 * i + j] + f[3 * j + i];
            if (v.small) continue;
            for (int m = 0; m < 3; ++m) c[k] += f[3 * m + i] * f[3 * m + j];
        }
    }

    VISVIVA_INLINE void strains(int q, SolidPoint& p) const {
        V F0[9];
        gradient(x1, q, 1.0, p.F1);
        strain(p.F1, p.c1);
        p.det = v.small ? broadcast(1.0) : determinant(p.F1);
        const bool ends = step.theta == 1.0 && step.stress == Stress::at_theta;
        if (!ends) {
            gradient(x0, q, 1.0, F0);
            strain(F0, p.c0);
        }
        for (int k = 0; k < 9; ++k) p.Ft[k] = ends ? p.F1[k] : F0[k] + step.theta * (p.F1[k] - F0[k]);
        if (step.stress == Stress::at_theta) strain(p.Ft, p.ct);
        if (v.damped) {
            V u[solid_max_nodes * D];
            for (int a = 0; a < nodes(); ++a)
                for (int c = 0; c < D; ++c) u[a * D + c] = at(x.rate, a, c);
            gradient(u, q, 0.0, p.rate);
        }
        if (v.small)
            for (int k = 0; k < 9; ++k) p.F1[k] = p.Ft[k] = broadcast(k % 4 == 0 ? 1.0 : 0.0);
    }

    template <bool tangent>
    VISVIVA_INLINE void at_theta(const V* par, SolidPoint& p) const {
        Response r;
        respond<tangent>(v.kind, p.ct, par, r);
        for (int k = 0; k < 6; ++k) p.S[k] = 2.0 * r.s[k];
        if constexpr (tangent)
            for (int k = 0; k < 6; ++k)
                for (int l = k; l < 6; ++l)
                    p.T[6 * k + l] = p.T[6 * l + k] = 4 * step.theta * r.d[packed(6, k, l)];
    }

    // S = W'(Cm) + f dC with f dC.dC = W1 - W0 - W'(Cm).dC; where that difference would drown in rounding it
    // is Simpson's rule in the gradients, and nothing where it is below the rounding of the energy.
    template <bool tangent>
    VISVIVA_INLINE void discrete_gradient(const V* par, SolidPoint& p) const {
        V cm[6], d[6], second[6], first[6];
        for (int k = 0; k < 6; ++k) cm[k] = 0.5 * (p.c0[k] + p.c1[k]), d[k] = p.c1[k] - p.c0[k];
        Response m;
        respond<tangent>(v.kind, cm, par, m);
        V f{}, inverse{}, df[6] = {};
        if (v.kind != MaterialKind::hooke) {
            Response r0, r1;
            respond<false>(v.kind, p.c0, par, r0), respond<false>(v.kind, p.c1, par, r1);
            for (int k = 0; k < 6; ++k) {
                first[k] = r1.s[k] - r0.s[k];
                second[k] = first[k] - 2.0 * (m.s[k] - r0.s[k]);
            }
            const VI smooth = contract(second, second) <= 1e-8 * contract(first, first);
            const V size = contract(d, d);
            const V b = select(smooth, contract(second, d) / 6.0, r1.W - r0.W - contract(m.s, d));
            const VI idle = (size <= 1e-30) | (b * b <= 1e-30 * contract(m.s, m.s) * contract(cm, cm));
            inverse = select(idle, V{}, 1.0 / select(idle, broadcast(1.0), size));
            f = b * inverse;
            if constexpr (tangent)
                for (int k = 0; k < 6; ++k) {
                    V half{};
                    for (int l = 0; l < 6; ++l)
                        half += (l < 3 ? 0.5 : 1.0) * m.d[k < l ? packed(6, k, l) : packed(6, l, k)] * d[l];
                    df[k] = inverse * (r1.s[k] - m.s[k] - half - 2.0 * f * d[k]);
                }
        }
        for (int k = 0; k < 6; ++k) p.S[k] = 2.0 * (m.s[k] + f * d[k]);
        if constexpr (tangent)
            for (int k = 0; k < 6; ++k)
                for (int l = 0; l < 6; ++l) {
                    const V outer = v.symmetric ? 0.5 * (d[k] * df[l] + d[l] * df[k]) : d[k] * df[l];
                    const V D2 = m.d[k < l ? packed(6, k, l) : packed(6, l, k)];
                    p.T[6 * k + l] = 2.0 * D2 + 4.0 * outer;
                    if (k == l) p.T[6 * k + l] += (k < 3 ? 4.0 : 2.0) * f;
                }
    }

    template <bool tangent>
    VISVIVA_INLINE void stress(int q, SolidPoint& p) const {
        if (v.kind == MaterialKind::user) {
            user<tangent>(q, p);
        } else {
            V par[material_max_parameters];
            for (int k = 0; k < v.n_par; ++k) par[k] = parameter(k);
            step.stress == Stress::discrete_gradient ? discrete_gradient<tangent>(par, p)
                                                     : at_theta<tangent>(par, p);
        }
        if (v.damped) viscous_stress(p);
    }

    // Derivatives by the six components count an off-diagonal pair once, those by the tensor each of both.
    template <bool tangent>
    VISVIVA_INLINE void user(int q, SolidPoint& p) const {
        const std::int64_t at = point(q), stride = static_cast<std::int64_t>(v.n_blocks) * v.n_points * L8;
        const double factor = step.stress == Stress::at_theta ? 4 * step.theta : 4;
        for (int k = 0; k < 6; ++k) p.S[k] = (k < 3 ? 2.0 : 1.0) * vload(v.user_S + k * stride + at);
        for (int k = 0; tangent && k < 36; ++k) {
            const double share = (k / 6 < 3 ? 1.0 : 0.5) * (k % 6 < 3 ? 1.0 : 0.5);
            p.T[k] = factor * share * vload(v.user_D + k * stride + at);
        }
    }

    VISVIVA_INLINE std::int64_t point(int q) const {
        return (static_cast<std::int64_t>(block) * v.n_points + q) * L8 + lane;
    }

    VISVIVA_INLINE V energy(int q, const V* c1, const V* par) const {
        if (v.kind == MaterialKind::user) return vload(v.user_W + point(q));
        Response r;
        respond<false>(v.kind, c1, par, r);
        return r.W;
    }

    // S of Kelvin and Voigt: isotropic in the rate of Green's strain, dE/dt = sym(F^T dF/dt)
    VISVIVA_INLINE void viscous_stress(SolidPoint& p) const {
        V e[6];
        for (int k = 0; k < 6; ++k) {
            e[k] = V{};
            for (int m = 0; m < 3; ++m)
                e[k] += 0.5 * (p.Ft[3 * m + voigt_a[k]] * p.rate[3 * m + voigt_b[k]] +
                               p.Ft[3 * m + voigt_b[k]] * p.rate[3 * m + voigt_a[k]]);
        }
        const V trace = viscosity(1) * (e[0] + e[1] + e[2]);
        for (int k = 0; k < 6; ++k) {
            p.viscous[k] = 2.0 * viscosity(2) * e[k] + (k < 3 ? trace : V{});
            p.S[k] += p.viscous[k];
        }
    }

    // P = F S, times the volume
    VISVIVA_INLINE void piola(const V* F, const V* S, V factor, V* P) const {
        for (int i = 0; i < 3; ++i)
            for (int l = 0; l < 3; ++l) {
                V sum{};
                for (int k = 0; k < 3; ++k) sum += F[3 * i + k] * S[voigt[k][l]];
                P[3 * i + l] = factor * sum;
            }
    }

    VISVIVA_INLINE void forces(V* r) const {
        V smallest = broadcast(1e300);
        for (int a = 0; a < nodes() * D; ++a) r[a] = V{};
        for (int q = 0; q < v.n_points; ++q) {
            SolidPoint p;
            V P[9];
            strains(q, p);
            stress<false>(q, p);
            smallest = select(p.det < smallest, p.det, smallest);
            piola(p.Ft, p.S, volume(q), P);
            const double* G = gradients(q);
            for (int a = 0; a < nodes(); ++a) {
                for (int l = 0; l < D; ++l) {
                    const V g = vload(G + (a * D + l) * L8);
                    for (int i = 0; i < D; ++i) r[a * D + i] += P[3 * i + l] * g;
                }
                if (D == 2 && v.H) r[a * D] += P[8] * hoop(q, a);
            }
        }
        vstore(v.smallest + block * L8 + lane, smallest);
        if (v.mass) inertia(r);
    }

    VISVIVA_INLINE void inertia(V* r) const {
        V u[solid_max_nodes * D];
        for (int a = 0; a < nodes(); ++a)
            for (int c = 0; c < D; ++c) {
                u[a * D + c] = at(x.second_rate, a, c);
                if (v.damped) u[a * D + c] += viscosity(0) * at(x.rate, a, c);
            }
        for (int a = 0; a < nodes(); ++a)
            for (int b = 0; b < nodes(); ++b) {
                const V m = mass(a, b);
                for (int c = 0; c < D; ++c) r[a * D + c] += m * u[b * D + c];
            }
    }

    // A = dP/dF at a point as [iL][jN], times the volume
    VISVIVA_INLINE void moduli(const SolidPoint& p, V factor, V* A) const {
        const V* F1 = step.stress == Stress::at_theta || v.symmetric ? p.Ft : p.F1;
        V Q[54];
        for (int i = 0; i < 3; ++i)
            for (int l = 0; l < 3; ++l)
                for (int m = 0; m < 6; ++m) {
                    V sum{};
                    for (int k = 0; k < 3; ++k) sum += p.Ft[3 * i + k] * p.T[6 * voigt[k][l] + m];
                    Q[(3 * i + l) * 6 + m] = factor * sum;
                }
        for (int row = 0; row < 9; ++row)
            for (int j = 0; j < 3; ++j)
                for (int n = 0; n < 3; ++n) {
                    V sum{};
                    for (int m = 0; m < 3; ++m) sum += Q[row * 6 + voigt[m][n]] * F1[3 * j + m];
                    A[row * 9 + 3 * j + n] = sum;
                }
        if (v.damped) add_viscous_moduli(p, factor, A);
        if (v.small) return;
        for (int l = 0; l < 3; ++l)
            for (int n = 0; n < 3; ++n) {
                const V s = factor * step.theta * p.S[voigt[l][n]];
                for (int i = 0; i < 3; ++i) A[(3 * i + l) * 9 + 3 * i + n] += s;
            }
    }

    VISVIVA_INLINE void add_viscous_moduli(const SolidPoint& p, V factor, V* A) const {
        const V lambda = factor * viscosity(1), mu = factor * viscosity(2);
        V X[9];  // derivative of the strain rate: sym(X^T dF)
        for (int k = 0; k < 9; ++k)
            X[k] = step.motion[0][0] * p.Ft[k] + (v.small || v.symmetric ? V{} : step.theta * p.rate[k]);
        for (int i = 0; i < 3; ++i)
            for (int l = 0; l < 3; ++l)
                for (int j = 0; j < 3; ++j)
                    for (int n = 0; n < 3; ++n) {
                        V sum = lambda * p.Ft[3 * i + l] * X[3 * j + n] + mu * p.Ft[3 * i + n] * X[3 * j + l];
                        for (int k = 0; l == n && k < 3; ++k) sum += mu * p.Ft[3 * i + k] * X[3 * j + k];
                        A[(3 * i + l) * 9 + 3 * j + n] += sum;
                    }
    }

    // T[q][j * D + n][i] = sum_l G_al A[il][jn] for one node a
    VISVIVA_INLINE void left(const V* A, int q, int a, V* T) const {
        const double* G = gradients(q);
        V g[D];
        for (int l = 0; l < D; ++l) g[l] = vload(G + (a * D + l) * L8);
        for (int j = 0; j < D; ++j)
            for (int n = 0; n < D; ++n)
                for (int i = 0; i < D; ++i) {
                    V sum{};
                    for (int l = 0; l < D; ++l) sum += g[l] * A[(3 * i + l) * 9 + 3 * j + n];
                    T[(j * D + n) * D + i] = sum;
                }
    }

    // Row a of the element's tangent: K[b][i][j] for b from `first` on
    VISVIVA_INLINE void row(const V* A, int a, int first, V* K) const {
        V T[solid_max_points * D * D * D];
        for (int q = 0; q < v.n_points; ++q) left(A + 81 * q, q, a, T + q * D * D * D);
        for (int b = first; b < nodes(); ++b) {
            V sum[D * D];
            for (V& s : sum) s = V{};
            for (int q = 0; q < v.n_points; ++q) {
                const double* G = gradients(q);
                const V* t = T + q * D * D * D;
                for (int j = 0; j < D; ++j)
                    for (int n = 0; n < D; ++n) {
                        const V g = vload(G + (b * D + n) * L8);
                        for (int i = 0; i < D; ++i) sum[i * D + j] += g * t[(j * D + n) * D + i];
                    }
            }
            if (D == 2 && v.H) add_hoop(A, a, b, sum);
            if (v.mass) {
                V m = step.motion[1][0] * mass(a, b);
                if (v.damped) m += step.motion[0][0] * viscosity(0) * mass(a, b);
                for (int i = 0; i < D; ++i) sum[i * D + i] += m;
            }
            for (int k = 0; k < D * D; ++k) K[b * D * D + k] = sum[k];
        }
    }

    VISVIVA_INLINE void add_hoop(const V* A, int a, int b, V* K) const {
        for (int q = 0; q < v.n_points; ++q) {
            const V* M = A + 81 * q;
            const double* G = gradients(q);
            const V ha = hoop(q, a), hb = hoop(q, b);
            K[0] += ha * hb * M[80];
            for (int j = 0; j < D; ++j)
                for (int n = 0; n < D; ++n) {
                    K[j] += ha * vload(G + (b * D + n) * L8) * M[8 * 9 + 3 * j + n];
                    K[j * D] += vload(G + (a * D + n) * L8) * hb * M[(3 * j + n) * 9 + 8];
                }
        }
    }

    VISVIVA_INLINE void all_moduli(V* A) const {
        for (int q = 0; q < v.n_points; ++q) {
            SolidPoint p;
            strains(q, p);
            stress<true>(q, p);
            moduli(p, volume(q), A + 81 * q);
        }
    }
};

VISVIVA_INLINE int solid_active(const SolidView& v, int block, int lane) {
    const int left = v.n - block * L8 - lane;
    return left < W ? left : W;
}

template <int D, int N>
VISVIVA_INLINE void solid_scatter_forces(const SolidElement<D, N>& e, const V* r, int n, double* to) {
    for (int a = 0; a < e.nodes(); ++a) {
        const int* index = e.index(a);
        for (int c = 0; c < D; ++c)
            for (int l = 0; l < n; ++l) to[index[l] + c] += r[a * D + c][l];
    }
}

// Adds the blocks (a, b) and, if the tangent is symmetric, (b, a) of W elements to the matrix.
template <int D, int N>
VISVIVA_INLINE void solid_scatter_block(const SolidElement<D, N>& e, int a, int b, const V* K, int n,
                                        bool transpose, double* values) {
    const SolidView& v = e.v;
    const std::int64_t at = (static_cast<std::int64_t>(e.block) * e.nodes() + a) * L8 + e.lane;
    const std::uint16_t* offset =
        v.offset + ((static_cast<std::int64_t>(e.block) * e.nodes() + a) * e.nodes() + b) * L8 + e.lane;
    for (int l = 0; l < n; ++l) {
        if (v.row[at + l] < 0 || offset[l] == 0xffff) continue;
        double* to = values + v.row[at + l] + offset[l];
        const std::int64_t length = v.length[at + l];
        for (int i = 0; i < D; ++i)
            for (int j = 0; j < D; ++j) to[i * length + j] += transpose ? K[j * D + i][l] : K[i * D + j][l];
    }
}

template <int D, int N>
void solid_residual_of(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                       double* r) {
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < L8; lane += W) {
            const int n = solid_active(v, block, lane);
            if (n <= 0) break;
            const SolidElement<D, N> e(v, step, x, block, lane);
            V f[solid_max_nodes * D];
            e.forces(f);
            solid_scatter_forces(e, f, n, r);
        }
}

template <int D, int N>
void solid_tangent_of(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                      double* values) {
    const bool symmetric = v.symmetric || (step.stress == Stress::at_theta && !v.damped);
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < L8; lane += W) {
            const int n = solid_active(v, block, lane);
            if (n <= 0) break;
            const SolidElement<D, N> e(v, step, x, block, lane);
            V A[81 * solid_max_points], K[solid_max_nodes * D * D];
            e.all_moduli(A);
            for (int a = 0; a < e.nodes(); ++a) {
                e.row(A, a, symmetric ? a : 0, K);
                for (int b = symmetric ? a : 0; b < e.nodes(); ++b) {
                    solid_scatter_block(e, a, b, K + b * D * D, n, false, values);
                    if (symmetric && b != a) solid_scatter_block(e, b, a, K + b * D * D, n, true, values);
                }
            }
        }
}

// Rows of `out` [solid_ledger_rows][stride]; see solid.hpp.
template <int D, int N>
void solid_ledger_of(const SolidView& v, const Step& step, const Vectors& x, const double* v1, int begin,
                     int end, double* out) {
    const std::int64_t stride = static_cast<std::int64_t>(v.n_blocks) * L8;
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < L8; lane += W) {
            const SolidElement<D, N> e(v, step, x, block, lane);
            V row[solid_ledger_rows];
            for (V& a : row) a = V{};
            V par[material_max_parameters];
            for (int k = 0; k < v.n_par; ++k) par[k] = e.parameter(k);
            for (int q = 0; q < v.n_points; ++q) {
                SolidPoint p;
                e.strains(q, p);
                row[0] += e.volume(q) * e.energy(q, p.c1, par);
                if (!v.damped) continue;
                V F[9], F0[9], P[9];
                e.viscous_stress(p);
                e.gradient(e.x1, q, 1.0, F);
                e.gradient(e.x0, q, 1.0, F0);
                e.piola(p.Ft, p.viscous, e.volume(q), P);
                for (int k = 0; k < 9; ++k) row[2] -= P[k] * (F[k] - F0[k]);
            }
            for (int a = 0; v.mass && a < e.nodes(); ++a) {
                V p[3] = {}, damping[3] = {}, place[3] = {};
                for (int c = 0; c < D; ++c) place[c] = e.x1[a * D + c];
                for (int b = 0; b < e.nodes(); ++b)
                    for (int c = 0; c < D; ++c) {
                        p[c] += e.mass(a, b) * e.at(v1, b, c);
                        if (v.damped) damping[c] += e.viscosity(0) * e.mass(a, b) * e.at(x.rate, b, c);
                    }
                for (int c = 0; c < D; ++c) {
                    row[1] += 0.5 * e.at(v1, a, c) * p[c];
                    row[2] -= damping[c] * (e.x1[a * D + c] - e.x0[a * D + c]);
                    row[3 + c] += p[c];
                }
                row[6] += place[1] * p[2] - place[2] * p[1];
                row[7] += place[2] * p[0] - place[0] * p[2];
                row[8] += place[0] * p[1] - place[1] * p[0];
            }
            for (int k = 0; k < solid_ledger_rows; ++k) vstore(out + k * stride + block * L8 + lane, row[k]);
        }
}

// C at the start, theta and end of all points for laws outside the core: arrays [6][block][point][8].
template <int D, int N>
void solid_strains_of(const SolidView& v, const Step& step, const Vectors& x, double* c0, double* ct,
                      double* c1) {
    const std::int64_t stride = static_cast<std::int64_t>(v.n_blocks) * v.n_points * L8;
    for (int block = 0; block < v.n_blocks; ++block)
        for (int lane = 0; lane < L8; lane += W) {
            const SolidElement<D, N> e(v, step, x, block, lane);
            for (int q = 0; q < v.n_points; ++q) {
                V F0[9], F1[9], Ft[9], c[6];
                const std::int64_t at = (static_cast<std::int64_t>(block) * v.n_points + q) * L8 + lane;
                auto put = [&](const V* F, double* to) {
                    e.strain(F, c);
                    for (int k = 0; k < 6; ++k) vstore(to + k * stride + at, k < 3 ? 1.0 + c[k] : c[k]);
                };
                e.gradient(e.x0, q, 1.0, F0), e.gradient(e.x1, q, 1.0, F1);
                for (int k = 0; k < 9; ++k) Ft[k] = F0[k] + step.theta * (F1[k] - F0[k]);
                put(F0, c0), put(Ft, ct), put(F1, c1);
            }
        }
}

// Deformation gradient (9), second Piola-Kirchhoff stress (6) and energy at the points of elements, from the
// end of the step: out [element - 8 begin][point][16].
template <int D, int N>
void solid_fields_of(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                     double* out) {
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < L8; lane += W) {
            const int n = solid_active(v, block, lane);
            if (n <= 0) break;
            const SolidElement<D, N> e(v, step, x, block, lane);
            V par[material_max_parameters];
            for (int k = 0; k < v.n_par; ++k) par[k] = e.parameter(k);
            for (int q = 0; q < v.n_points; ++q) {
                SolidPoint p;
                V row[solid_field_rows];
                e.strains(q, p);
                e.template stress<false>(q, p);
                e.gradient(e.x1, q, 1.0, row);
                for (int k = 0; k < 6; ++k) row[9 + k] = p.S[k];
                row[15] = e.energy(q, p.c1, par);
                for (int l = 0; l < n; ++l)
                    for (int k = 0; k < solid_field_rows; ++k)
                        out[(((block - begin) * L8 + lane + l) * static_cast<std::int64_t>(v.n_points) + q) *
                                solid_field_rows +
                            k] = row[k][l];
            }
        }
}

// Forces of the elements on their nodes: out [element - 8 begin][node][dim].
template <int D, int N>
void solid_forces_of(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                     double* out) {
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < L8; lane += W) {
            const int n = solid_active(v, block, lane);
            if (n <= 0) break;
            const SolidElement<D, N> e(v, step, x, block, lane);
            V f[solid_max_nodes * D];
            e.forces(f);
            const int size = e.nodes() * D;
            for (int l = 0; l < n; ++l)
                for (int k = 0; k < size; ++k)
                    out[((block - begin) * L8 + lane + l) * static_cast<std::int64_t>(size) + k] = f[k][l];
        }
}

#define VISVIVA_SOLID(function, ...)                            \
    if (v.dim == 3) {                                           \
        if (v.n_nodes == 8) return function<3, 8>(__VA_ARGS__); \
        if (v.n_nodes == 4) return function<3, 4>(__VA_ARGS__); \
        return function<3, 0>(__VA_ARGS__);                     \
    }                                                           \
    return function<2, 0>(__VA_ARGS__);

void solid_residual(const SolidView& v, const Step& step, const Vectors& x, int begin, int end, double* r) {
    VISVIVA_SOLID(solid_residual_of, v, step, x, begin, end, r)
}
void solid_tangent(const SolidView& v, const Step& step, const Vectors& x, int begin, int end,
                   double* values) {
    VISVIVA_SOLID(solid_tangent_of, v, step, x, begin, end, values)
}
void solid_ledger(const SolidView& v, const Step& step, const Vectors& x, const double* v1, int begin,
                  int end, double* out) {
    VISVIVA_SOLID(solid_ledger_of, v, step, x, v1, begin, end, out)
}
void solid_strains(const SolidView& v, const Step& step, const Vectors& x, double* c0, double* ct,
                   double* c1) {
    VISVIVA_SOLID(solid_strains_of, v, step, x, c0, ct, c1)
}
void solid_fields(const SolidView& v, const Step& step, const Vectors& x, int begin, int end, double* out) {
    VISVIVA_SOLID(solid_fields_of, v, step, x, begin, end, out)
}
void solid_forces(const SolidView& v, const Step& step, const Vectors& x, int begin, int end, double* out) {
    VISVIVA_SOLID(solid_forces_of, v, step, x, begin, end, out)
}
#undef VISVIVA_SOLID

// Energy, its gradient and second gradient by C of one material: c = C - I (n, 6), out (n, 28).
void material_response(MaterialKind kind, const double* par, int n_par, int n, const double* c, double* out) {
    V p[material_max_parameters], strain[6];
    for (int k = 0; k < n_par; ++k) p[k] = broadcast(par[k]);
    for (int i = 0; i < n; i += W) {
        Response r;
        for (int k = 0; k < 6; ++k)
            for (int l = 0; l < W; ++l) strain[k][l] = c[(i + l < n ? i + l : n - 1) * 6 + k];
        respond<true>(kind, strain, p, r);
        for (int l = 0; l < W && i + l < n; ++l) {
            double* to = out + (i + l) * 28;
            to[0] = r.W[l];
            for (int k = 0; k < 6; ++k) to[1 + k] = r.s[k][l];
            for (int k = 0; k < 21; ++k) to[7 + k] = r.d[k][l];
        }
    }
}

}  // namespace visviva::VISVIVA_ISA
