// Solid elements, W at a time: strains, stresses and forces.
#pragma once
#include "visviva/base/aligned.hpp"
#include "visviva/material/discrete_gradient.hpp"
#include "visviva/material/wrapped.hpp"
#include "visviva/solid/solid_geometry.hpp"

namespace visviva::VISVIVA_ISA {

/// Input and output of a point's stress.
struct SolidPoint {
    alignas(64) V F1[9], Ft[9], rate[9];  // deformation gradient at the end and at theta, its rate; row-major
    V c0[6], c1[6], ct[6];                // C - I
    V S[6], T[36], viscous[6];            // second Piola-Kirchhoff stress, 2 dS/dC, viscous part of S
    V det;                                // of F1
};

VISVIVA_INLINE V determinant(const V* F) {
    return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
           F[2] * (F[3] * F[7] - F[4] * F[6]);
}

template <int D, int N>
struct SolidElement : SolidGeometry<D, N> {
    using Geometry = SolidGeometry<D, N>;
    using Geometry::v, Geometry::block, Geometry::lane, Geometry::nodes, Geometry::stride,
        Geometry::gradients, Geometry::volume, Geometry::mass;
    const Step& step;
    const Vectors& x;
    const bool ends;  // the state at the end of the step alone decides: there is no x0
    static constexpr int max_nodes = N > 0 ? N : solid_max_nodes;
    alignas(64) V x0[max_nodes * D], x1[max_nodes * D];

    VISVIVA_INLINE SolidElement(const SolidView& view, const Step& s, const Vectors& vectors, int b, int l)
        : Geometry(view, b, l),
          step(s),
          x(vectors),
          ends(s.theta == 1.0 && s.stress == Stress::at_theta && !view.damped &&
               view.kind != MaterialKind::user) {
        for (int a = 0; a < nodes(); ++a)
            for (int c = 0; c < D; ++c) x1[a * D + c] = at(x.x1, a, c);
        for (int a = 0; !ends && a < nodes(); ++a)
            for (int c = 0; c < D; ++c) x0[a * D + c] = at(x.x0, a, c);
    }
    // Number of the W lanes that hold elements; none or less in groups that fill the last block.
    VISVIVA_INLINE int active() const { return v.n - block * L8 - lane < W ? v.n - block * L8 - lane : W; }
    VISVIVA_INLINE const int* index(int a) const { return v.index + (block * nodes() + a) * L8 + lane; }
    VISVIVA_INLINE const int* pressure_index(int k) const {
        return v.pressure_index + (block * v.n_pressures + k) * L8 + lane;
    }
    VISVIVA_INLINE V at(const double* u, int a, int c) const { return gather(u + c, index(a)); }
    VISVIVA_INLINE V hoop(int q, int a) const {
        return vload(v.H + ((static_cast<std::int64_t>(block) * v.n_points + q) * nodes() + a) * L8 + lane);
    }
    VISVIVA_INLINE V parameter(int k) const { return vload(v.par + (block * v.n_par + k) * L8 + lane); }
    VISVIVA_INLINE V viscosity(int k) const { return vload(v.damping + (block * 3 + k) * L8 + lane); }

    // Share of the inertia and of its damping in the tangent's diagonal
    VISVIVA_INLINE V mass_factor(int a, int b) const {
        if (!v.has_mass) return V{};
        const V m = mass(a, b), inertial = step.motion[1][0] * m;
        return v.damped ? inertial + step.motion[0][0] * viscosity(0) * m : inertial;
    }

    // sum_a u_a x G_a, with the stretch across the plane in two dimensions
    VISVIVA_INLINE void gradient(const V* u, int q, double across, V* F) const {
        V sum[9] = {};
        const double* G = gradients(q);
        for (int a = 0; a < nodes(); ++a) {
            VISVIVA_FLATTEN
            for (int l = 0; l < D; ++l) {
                const V g = vload(G + (a * D + l) * stride);
                VISVIVA_FLATTEN
                for (int i = 0; i < D; ++i) sum[3 * i + l] += u[a * D + i] * g;
            }
        }
        for (int k = 0; k < 9; ++k) F[k] = sum[k];
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

    VISVIVA_INLINE V thermal(int q) const { return vload(v.thermal + point(q)); }
    VISVIVA_INLINE V stretch(int q) const {
        return v.thermal && !v.small ? 1.0 + thermal(q) : broadcast(1.0);
    }

    // Energies at a point: of what heat has stretched there, and of the material of the element.
    template <class Energy>
    VISVIVA_INLINE Stretched<Energy> heated(int q, const Energy& energy) const {
        return {energy, v.thermal ? reinterpret_cast<const V*>(v.thermal + point(q)) : nullptr, v.small};
    }
    VISVIVA_INLINE Stretched<MaterialEnergy> material(int q, const V* par) const {
        return heated(q, MaterialEnergy{{}, v.kind, par});
    }
    VISVIVA_INLINE auto energy_at(int q, const V* par) const {
        if constexpr (D == 2)
            return PlaneStress<Stretched<MaterialEnergy>>{material(q, par), v.plane_stress};
        else
            return material(q, par);
    }

    VISVIVA_INLINE void strains(int q, SolidPoint& p) const {
        V F0[9];
        gradient(x1, q, 1.0, p.F1);
        strain(p.F1, p.c1);
        p.det = v.small ? broadcast(1.0) : determinant(p.F1);
        if (!ends) {
            gradient(x0, q, 1.0, F0);
            strain(F0, p.c0);
        }
        for (int k = 0; k < 9; ++k) p.Ft[k] = ends ? p.F1[k] : F0[k] + step.theta * (p.F1[k] - F0[k]);
        if (ends)
            for (int k = 0; k < 6; ++k) p.ct[k] = p.c1[k];
        else if (step.stress == Stress::at_theta)
            strain(p.Ft, p.ct);
        if (v.damped) {
            V u[max_nodes * D];
            for (int a = 0; a < nodes(); ++a)
                for (int c = 0; c < D; ++c) u[a * D + c] = at(x.rate, a, c);
            gradient(u, q, 0.0, p.rate);
        }
        if (v.small)
            for (int k = 0; k < 9; ++k) p.F1[k] = p.Ft[k] = broadcast(k % 4 == 0 ? 1.0 : 0.0);
    }

    // Stress at a point, S = 2 dW/dC of n strains, and T = 2 dS/dC1
    template <bool tangent, class Energy>
    VISVIVA_INLINE static void stress_by(const Energy& energy, const Step& step, const V* c0, const V* c1,
                                         const V* ct, V* S, V* T) {
        constexpr int n = Energy::n;
        stress_of<tangent>(energy, step, c0, c1, ct, S, T);
        for (int k = 0; k < n; ++k) S[k] *= 2.0;
        const double factor = step.stress == Stress::at_theta ? 4 * step.theta : 4;
        for (int k = 0; tangent && k < n * n; ++k) T[k] *= factor;
    }

    template <bool tangent>
    VISVIVA_INLINE void stress(int q, SolidPoint& p) const {
        V par[material_max_parameters];
        for (int k = 0; k < v.n_par; ++k) par[k] = parameter(k);
        if (v.kind == MaterialKind::user)
            user<tangent, 6>(q, p.S, p.T);
        else if (v.thermal || v.plane_stress)
            wrapped_stress<tangent>(energy_at(q, par), p);
        else
            stress_by<tangent>(MaterialEnergy{{}, v.kind, par}, step, p.c0, p.c1, p.ct, p.S, p.T);
        if (v.damped) viscous_stress(p);
    }
    template <bool tangent, class Energy>
    VISVIVA_INLINE void wrapped_stress(const Energy& energy, SolidPoint& p) const {
        SolidPoint own;  // what a call sees leaves the registers
        for (int k = 0; k < 6; ++k) own.c0[k] = p.c0[k], own.c1[k] = p.c1[k], own.ct[k] = p.ct[k];
        stress_apart<tangent>(energy, Step(step), own);
        for (int k = 0; k < 6; ++k) p.S[k] = own.S[k];
        for (int k = 0; tangent && k < 36; ++k) p.T[k] = own.T[k];
    }
    // Not inlined: most materials are alone.
    template <bool tangent, class Energy>
    __attribute__((noinline)) static void stress_apart(const Energy& energy, const Step& step,
                                                       SolidPoint& p) {
        stress_by<tangent>(energy, step, p.c0, p.c1, p.ct, p.S, p.T);
    }

    // Derivatives by the components count an off-diagonal pair once, those by the tensor each of both; they
    // are by strains beyond that of heat.
    template <bool tangent, int n>
    VISVIVA_INLINE void user(int q, V* S, V* T) const {
        const std::int64_t at = point(q), stride = static_cast<std::int64_t>(v.n_blocks) * v.n_points * L8;
        const double factor = step.stress == Stress::at_theta ? 4 * step.theta : 4;
        const V stretched = stretch(q), inverse = 1.0 / stretched;
        for (int k = 0; k < n; ++k)
            S[k] = (2.0 / tensor_weight(k)) * stretched * vload(v.user_S + k * stride + at);
        for (int k = 0; tangent && k < n * n; ++k) {
            const double share = factor / (tensor_weight(k / n) * tensor_weight(k % n));
            T[k] = share * inverse * vload(v.user_D + k * stride + at);
        }
    }

    VISVIVA_INLINE std::int64_t point(int q) const {
        return (static_cast<std::int64_t>(block) * v.n_points + q) * L8 + lane;
    }

    VISVIVA_INLINE V user_energy(int q) const {
        const V stretched = stretch(q);
        return stretched * stretched * stretched * vload(v.user_W + point(q));
    }

    VISVIVA_INLINE V energy(int q, const V* c1, const V* par) const {
        if (v.kind == MaterialKind::user) return user_energy(q);
        Response r;
        energy_at(q, par).template evaluate<false>(c1, r);
        return r.W;
    }

    // F33 of plane stress
    VISVIVA_INLINE V across(int q, const V* c1, const V* par) const {
        const V c33 = PlaneStress<Stretched<MaterialEnergy>>{material(q, par), true}.across(c1);
        return v.small ? 1.0 + 0.5 * c33 : vsqrt(1.0 + c33);
    }

    // S of Kelvin and Voigt: Hooke's of the rate of C, 2 sym(F^T dF/dt)
    VISVIVA_INLINE void viscous_stress(SolidPoint& p) const {
        V rate[6];
        for (int k = 0; k < 6; ++k) {
            rate[k] = V{};
            for (int m = 0; m < 3; ++m)
                rate[k] += p.Ft[3 * m + voigt_a[k]] * p.rate[3 * m + voigt_b[k]] +
                           p.Ft[3 * m + voigt_b[k]] * p.rate[3 * m + voigt_a[k]];
        }
        const V constants[2] = {viscosity(1), viscosity(2)};
        Response r;
        hooke<false>(rate, constants, r);
        for (int k = 0; k < 6; ++k) p.viscous[k] = 2.0 * r.s[k], p.S[k] += p.viscous[k];
    }

    // X of the derivative of the rate of Green's strain by the motion at the end, sym(X^T dF)
    VISVIVA_INLINE void rate_gradient(const SolidPoint& p, V* X) const {
        for (int k = 0; k < 9; ++k)
            X[k] = step.motion[0][0] * p.Ft[k] + (v.small ? V{} : step.theta * p.rate[k]);
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

    // Adds the forces of a point.
    VISVIVA_INLINE void add_forces(int q, const SolidPoint& p, V* r, V& smallest) const {
        V P[9];
        smallest = select(p.det < smallest, p.det, smallest);
        piola(p.Ft, p.S, volume(q), P);
        const double* G = gradients(q);
        for (int a = 0; a < nodes(); ++a) {
            VISVIVA_FLATTEN
            for (int i = 0; i < D; ++i) {
                V sum = r[a * D + i];
                VISVIVA_FLATTEN
                for (int l = 0; l < D; ++l) sum += P[3 * i + l] * vload(G + (a * D + l) * stride);
                r[a * D + i] = sum;
            }
            if (D == 2 && v.H) r[a * D] += P[8] * hoop(q, a);
        }
    }

    VISVIVA_INLINE void forces(V* r) const {
        V smallest = broadcast(1e300);
        for (int a = 0; a < nodes() * D; ++a) r[a] = V{};
        for (int q = 0; q < v.n_points; ++q) {
            SolidPoint p;
            strains(q, p);
            stress<false>(q, p);
            add_forces(q, p, r, smallest);
        }
        finish(r, smallest);
    }

    // correction of the points' forces
    VISVIVA_INLINE void finish(V* r, V smallest) const {
        vstore(v.smallest + block * L8 + lane, smallest);
        if (v.has_mass) inertia(r);
    }

    VISVIVA_INLINE void inertia(V* r) const {
        V u[max_nodes * D];
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
};

/// The blocks of the matrix of W elements: on the stack but for those of splines of high degree, in room that
/// each thread keeps.
template <int D, int N>
struct SolidBlocks {
    alignas(64) V K[N * N * D * D];
    explicit SolidBlocks(int) {}
};
template <int D>
struct SolidBlocks<D, 0> {
    static constexpr int most = solid_common_nodes * solid_common_nodes * D * D;
    alignas(64) V own[most];
    V* const K;
    explicit SolidBlocks(int n) : K(n <= most ? own : room(static_cast<std::size_t>(n) * W)) {}
    static V* room(std::size_t n) {
        thread_local Aligned<double> kept;
        if (kept.size() < n) kept.resize(n);
        return reinterpret_cast<V*>(kept.data());
    }
};

}  // namespace visviva::VISVIVA_ISA
