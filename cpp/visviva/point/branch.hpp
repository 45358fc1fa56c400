// Maxwell branches of finite strains: what a spring behind a dashpot adds to a solid.
#pragma once
#include "visviva/material/response.hpp"
#include "visviva/point/internal.hpp"

namespace visviva::VISVIVA_ISA {

/// Places of the parameters: material of the spring, its share, the dashpot's fluidity; those of the
/// material.
namespace branch {
constexpr int kind = 0, share = 1, fluidity = 2, material = 3, n_par = 3 + material_max_parameters;
}

/// Factor of a symmetric tensor, I + l = chol(I + a) below the diagonal, free of cancellation where a is
/// small.
template <class T>
struct LowerFactor {
    T x, y, z, p, q, r;  // 11, 22, 33, 21, 32, 31; diagonals less one

    static VISVIVA_INLINE T root_less_one(const T& u) { return u / (root(u + 1.0) + 1.0); }
    explicit VISVIVA_INLINE LowerFactor(const T* a) {
        x = root_less_one(a[0]);
        const T inverse = chain_inverse(x + 1.0);
        p = a[3] * inverse, r = a[5] * inverse;
        y = root_less_one(a[1] - p * p);
        q = (a[4] - p * r) * chain_inverse(y + 1.0);
        z = root_less_one(a[2] - r * r - q * q);
    }
    static VISVIVA_INLINE T chain_inverse(const T& u) {
        const V i = 1.0 / u.v;
        return chain(u, i, -i * i, 2.0 * i * i * i);
    }
};

/// (I + l)^T (I + c) (I + l) less I, made isochoric: the elastic strain of a branch whose viscous one has
/// Cv^-1 = (I + l) (I + l)^T up to its volume.
template <class T>
VISVIVA_INLINE void elastic_strain(const T* c, const T* a, T* e) {
    const LowerFactor<T> l(a);
    // columns of l, and of u = (I + c) l
    const T u00 = l.x + c[0] * l.x + c[3] * l.p + c[5] * l.r,
            u10 = l.p + c[3] * l.x + c[1] * l.p + c[4] * l.r,
            u20 = l.r + c[5] * l.x + c[4] * l.p + c[2] * l.r, u11 = l.y + c[1] * l.y + c[4] * l.q,
            u21 = l.q + c[4] * l.y + c[2] * l.q, u01 = c[3] * l.y + c[5] * l.q, u22 = l.z + c[2] * l.z,
            u12 = c[4] * l.z, u02 = c[5] * l.z;
    // c + u + u^T - l^T c ... : e = c + l^T (I + c) + (I + c) l + l^T (I + c) l = c + u + u^T + l^T u
    e[0] = c[0] + 2.0 * u00 + l.x * u00 + l.p * u10 + l.r * u20;
    e[1] = c[1] + 2.0 * u11 + l.y * u11 + l.q * u21;
    e[2] = c[2] + 2.0 * u22 + l.z * u22;
    e[3] = c[3] + u01 + u10 + l.x * u01 + l.p * u11 + l.r * u21;
    e[4] = c[4] + u12 + u21 + l.y * u12 + l.q * u22;
    e[5] = c[5] + u02 + u20 + l.x * u02 + l.p * u12 + l.r * u22;
    const T factor = powm1(determinant_less_one(e), broadcast(-1.0 / 3));
    for (int k = 0; k < 6; ++k) e[k] = e[k] + factor * (k < 3 ? e[k] + 1.0 : e[k]);
}

/// share W(Ce) of an isotropic material, Ce the isochoric elastic strain. A, the inverse of the viscous
/// Cauchy-Green tensor, counts up to its size, so that det Fv is 1. A' = fluidity A Y A with Y = -dW/dA
/// relaxes the deviator of Kirchhoff's stress, and Y : A' >= 0.
struct BranchEnergy : ViscousEnergy {
    static constexpr int max_par = branch::n_par;
    const V* p;
    explicit BranchEnergy(const V* par, V by_temperature = V{}) : p(par) { warms = by_temperature; }

    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        using J = Jet<n, second>;
        J x[n], strain[6];
        for (int k = 0; k < n; ++k) x[k] = J::variable(e[k], k);
        elastic_strain(x, x + 6, strain);
        V c[6];
        for (int k = 0; k < 6; ++k) c[k] = strain[k].v;
        Response w;
        respond<second>(static_cast<MaterialKind>(p[branch::kind][0]), c, p + branch::material, w);
        const V share = p[branch::share];
        to.W = share * w.W;
        for (int a = 0; a < n; ++a) {
            V sum{};
            for (int k = 0; k < 6; ++k) sum += tensor_weight(k) * w.s[k] * strain[k].g[a];
            to.s[a] = share * sum / weight(a);
        }
        if constexpr (second) add_second(share, w, strain, to);
    }
    /// The rate of A; the six derivatives by components count an entry off the diagonal twice.
    template <class T>
    void flow(const T* force, const T* internal, T* rate) const {
        T A[6], Y[6], AY[3][3];
        for (int k = 0; k < 6; ++k) {
            A[k] = k < 3 ? internal[k] + 1.0 : internal[k];
            Y[k] = (p[branch::fluidity] / tensor_weight(k)) * force[k];
        }
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                AY[i][j] = A[voigt[i][0]] * Y[voigt[0][j]] + A[voigt[i][1]] * Y[voigt[1][j]] +
                           A[voigt[i][2]] * Y[voigt[2][j]];
        for (int k = 0; k < 6; ++k) {
            const int i = voigt_a[k], j = voigt_b[k];
            rate[k] = AY[i][0] * A[voigt[0][j]] + AY[i][1] * A[voigt[1][j]] + AY[i][2] * A[voigt[2][j]];
        }
    }

  private:
    template <class J>
    void add_second(V share, const Response& w, const J* strain, Potential<n>& to) const {
        V by[6][n];  // ds_k by the variables
        for (int k = 0; k < 6; ++k)
            for (int b = 0; b < n; ++b) {
                by[k][b] = V{};
                for (int l = 0; l < 6; ++l)
                    by[k][b] += (tensor_weight(k) * tensor_weight(l)) * w.second(k, l) * strain[l].g[b];
            }
        for (int a = 0; a < n; ++a)
            for (int b = a; b < n; ++b) {
                V sum{};
                for (int k = 0; k < 6; ++k)
                    sum +=
                        by[k][b] * strain[k].g[a] + tensor_weight(k) * w.s[k] * strain[k].h[packed(n, a, b)];
                to.d[packed(n, a, b)] = share * sum / (weight(a) * weight(b));
            }
    }
};

}  // namespace visviva::VISVIVA_ISA
