// Residual, tangent and energy of elements with assumed strains, W elements at a time.
#pragma once
#include "visviva/base/simd.hpp"
#include "visviva/point/assumed.hpp"

namespace visviva::VISVIVA_ISA {

constexpr int A8 = 8;  // lanes of a block

/// Room for what W elements need.
struct AssumedScratch {
    V *u0, *u1, *ut, *z, *e, *s, *r, *B, *G, *K, *H, *all;
    AssumedScratch(const AssumedView& v, bool tangent) {
        const std::int64_t n_u = 3 * v.n_slots, rows = v.n_strains * n_u, square = tangent ? n_u * n_u : 0;
        const std::int64_t size[] = {n_u,         n_u, n_u,  3 * v.n_samples,          v.n_strains,
                                     v.n_strains, n_u, rows, 2 * (tangent ? rows : 0), square};
        std::int64_t total = static_cast<std::int64_t>(v.n_slots) * v.n_slots;
        for (std::int64_t k : size) total += k;
        V** parts[] = {&u0, &u1, &ut, &z, &e, &s, &r, &B, &G, &K};
        V* at = all = new V[total];
        for (int k = 0; k < 10; ++k) *parts[k] = at, at += size[k];
        H = at;
    }
    ~AssumedScratch() { delete[] all; }
    AssumedScratch(const AssumedScratch&) = delete;
    AssumedScratch& operator=(const AssumedScratch&) = delete;
};

struct AssumedElement {
    const AssumedView& v;
    const AssumedScratch& m;
    const int block, lane;

    VISVIVA_INLINE int n_u() const { return 3 * v.n_slots; }
    VISVIVA_INLINE int active() const { return v.n - block * A8 - lane < W ? v.n - block * A8 - lane : W; }
    VISVIVA_INLINE const int* slot(int a) const {
        return v.index + (static_cast<std::int64_t>(block) * v.n_slots + a) * A8 + lane;
    }
    VISVIVA_INLINE V modulus(int k, int l) const {
        const int n = v.n_strains, a = k < l ? k : l, b = k < l ? l : k;
        const int at = a * n - a * (a - 1) / 2 + b - a;
        return vload(v.stiffness + (static_cast<std::int64_t>(block) * (n * (n + 1) / 2) + at) * A8 + lane);
    }
    VISVIVA_INLINE V reference(int k) const {
        return vload(v.reference + (static_cast<std::int64_t>(block) * v.n_strains + k) * A8 + lane);
    }
    void take(const double* x, V* u) const {
        for (int a = 0; a < v.n_slots; ++a)
            for (int c = 0; c < 3; ++c) u[3 * a + c] = gather(x + c, slot(a));
    }

    /// Interpolated vectors z [sample][3].
    void sample(const V* u) const {
        for (int p = 0; p < v.n_samples; ++p) {
            V x{}, y{}, z{};
            for (int a = v.seen[p].begin; a < v.seen[p].end; ++a) {
                const double w = v.weights[p * v.n_slots + a];
                x += w * u[3 * a], y += w * u[3 * a + 1], z += w * u[3 * a + 2];
            }
            m.z[3 * p] = x, m.z[3 * p + 1] = y, m.z[3 * p + 2] = z;
        }
    }
    /// Adds a share of the strains of the sampled vectors.
    void add_strains(double share, V* e) const {
        for (int p = 0; p < v.n_products; ++p) {
            const AssumedProduct& q = v.product[p];
            const V *a = m.z + 3 * q.left, *b = m.z + 3 * q.right;
            e[q.strain] += (share * q.factor) * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
        }
    }
    /// Rows B [strain][unknown] at the sampled vectors.
    void rows(V* B) const {
        clear(B, v.n_strains * n_u());
        for (int p = 0; p < v.n_products; ++p) {
            const AssumedProduct& q = v.product[p];
            add_row(q.factor, q.left, m.z + 3 * q.right, B + q.strain * n_u());
            add_row(q.factor, q.right, m.z + 3 * q.left, B + q.strain * n_u());
        }
    }
    VISVIVA_INLINE void add_row(double factor, int p, const V* other, V* row) const {
        for (int a = v.seen[p].begin; a < v.seen[p].end; ++a) {
            const double w = factor * v.weights[p * v.n_slots + a];
            for (int c = 0; c < 3; ++c) row[3 * a + c] += w * other[c];
        }
    }
    void stress(const V* e) const {
        for (int k = 0; k < v.n_strains; ++k) {
            V sum{};
            for (int l = 0; l < v.n_strains; ++l)
                if (v.couples[k * v.n_strains + l]) sum += modulus(k, l) * e[l];
            m.s[k] = sum;
        }
    }

    /// Stresses, rows where forces act, and what they exert. The energy and the strains are quadratic, so
    /// that the mean of the strains at both ends makes a discrete gradient.
    void forces(const Step& step, const Vectors& x, bool means) const {
        take(x.x0, m.u0), take(x.x1, m.u1);
        for (int i = 0; i < n_u(); ++i) m.ut[i] = m.u0[i] + step.theta * (m.u1[i] - m.u0[i]);
        for (int k = 0; k < v.n_strains; ++k) m.e[k] = -reference(k);
        if (means) {
            sample(m.u0), add_strains(0.5, m.e);
            sample(m.u1), add_strains(0.5, m.e);
        }
        sample(m.ut);
        if (!means) add_strains(1.0, m.e);
        rows(m.B), stress(m.e);
        clear(m.r, n_u());
        for (int k = 0; k < v.n_strains; ++k)
            for (int i = 3 * v.touched[k].begin; i < 3 * v.touched[k].end; ++i)
                m.r[i] += m.s[k] * m.B[k * n_u() + i];
    }

    void moduli(const Step& step, bool means) const {
        const int n = n_u(), n_e = v.n_strains;
        V *B1 = m.B, *G = m.G;
        if (means) B1 = m.G + n_e * n, sample(m.u1), rows(B1);
        const double share = means ? 0.5 : step.theta;
        clear(G, n_e * n), clear(m.K, n * n);
        for (int k = 0; k < n_e; ++k)
            for (int l = 0; l < n_e; ++l) {
                if (!v.couples[k * n_e + l]) continue;
                const V d = share * modulus(k, l);
                for (int i = 3 * v.touched[l].begin; i < 3 * v.touched[l].end; ++i)
                    G[k * n + i] += d * B1[l * n + i];
            }
        for (int a = 0; a < v.n_slots; ++a)
            for (int k = 0; k < n_e; ++k) {
                if (a < v.touched[k].begin || a >= v.touched[k].end) continue;
                const V* b = m.B + k * n + 3 * a;
                const V b0 = b[0], b1 = b[1], b2 = b[2];
                V* to = m.K + 3 * a * n;
                for (int j = 0; j < n; ++j) {
                    const V g = G[k * n + j];
                    to[j] += b0 * g, to[n + j] += b1 * g, to[2 * n + j] += b2 * g;
                }
            }
        add_geometric(step.theta);
    }
    void add_geometric(double theta) const {
        const int n_s = v.n_slots, n = n_u();
        clear(m.H, n_s * n_s);
        for (int p = 0; p < v.n_products; ++p) {
            const AssumedProduct& q = v.product[p];
            const V f = (theta * q.factor) * m.s[q.strain];
            const AssumedRange &left = v.seen[q.left], &right = v.seen[q.right];
            for (int a = left.begin; a < left.end; ++a) {
                const V fa = f * v.weights[q.left * n_s + a];
                for (int b = right.begin; b < right.end; ++b) {
                    const V g = fa * v.weights[q.right * n_s + b];
                    m.H[a * n_s + b] += g, m.H[b * n_s + a] += g;
                }
            }
        }
        for (int a = 0; a < n_s; ++a)
            for (int b = 0; b < n_s; ++b)
                for (int c = 0; c < 3; ++c) m.K[(3 * a + c) * n + 3 * b + c] += m.H[a * n_s + b];
    }

    void scatter_forces(double* r) const {
        for (int a = 0; a < v.n_slots; ++a)
            for (int c = 0; c < 3; ++c)
                for (int l = 0; l < active(); ++l) r[slot(a)[l] + c] += m.r[3 * a + c][l];
    }
    void scatter_moduli(double* values) const {
        const int n = n_u();
        for (int a = 0; a < v.n_slots; ++a) {
            const std::int64_t at = (static_cast<std::int64_t>(block) * v.n_slots + a) * A8;
            for (int b = 0; b < v.n_slots; ++b)
                for (int l = lane; l < lane + active(); ++l) {
                    const std::uint16_t offset = v.offset[at * v.n_slots + b * A8 + l];
                    if (v.row[at + l] < 0 || offset == 0xffff) continue;
                    double* to = values + v.row[at + l] + offset;
                    for (int i = 0; i < 3; ++i)
                        for (int j = 0; j < 3; ++j)
                            to[i * v.length[at + l] + j] += m.K[(3 * a + i) * n + 3 * b + j][l - lane];
                }
        }
    }
};

inline void assumed_residual(const AssumedView& v, const Step& step, const Vectors& x, int begin, int end,
                             double* r) {
    const AssumedScratch scratch(v, false);
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < A8; lane += W) {
            const AssumedElement e{v, scratch, block, lane};
            e.forces(step, x, step.stress == Stress::discrete_gradient);
            e.scatter_forces(r);
        }
}

inline void assumed_tangent(const AssumedView& v, const Step& step, const Vectors& x, int begin, int end,
                            double* r, double* values) {
    const AssumedScratch scratch(v, true);
    const bool means = step.stress == Stress::discrete_gradient;
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < A8; lane += W) {
            const AssumedElement e{v, scratch, block, lane};
            e.forces(step, x, means);
            if (r) e.scatter_forces(r);
            e.moduli(step, means);
            e.scatter_moduli(values);
        }
}

inline void assumed_energy(const AssumedView& v, const double* x, int begin, int end, double* out) {
    const AssumedScratch scratch(v, false);
    for (int block = begin; block < end; ++block)
        for (int lane = 0; lane < A8; lane += W) {
            const AssumedElement e{v, scratch, block, lane};
            for (int k = 0; k < v.n_strains; ++k) scratch.e[k] = -e.reference(k);
            e.take(x, scratch.u1), e.sample(scratch.u1), e.add_strains(1.0, scratch.e), e.stress(scratch.e);
            V energy{};
            for (int k = 0; k < v.n_strains; ++k) energy += 0.5 * scratch.e[k] * scratch.s[k];
            vstore(out + block * A8 + lane, energy);
        }
}

}  // namespace visviva::VISVIVA_ISA
