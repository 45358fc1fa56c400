// Energies over strains of several fields, each written once over any number type.
#pragma once
#include "visviva/point/capacity.hpp"
#include "visviva/point/internal.hpp"
#include "visviva/point/pairings.hpp"

namespace visviva::VISVIVA_ISA {

/// Weights of a tensor and of scalars behind it.
constexpr double behind_tensor(int k) { return k < 6 ? tensor_weight(k) : 1.0; }

/// mu / 2 (tr c - 2 ln J) + lambda / 2 ln^2 J, and ln J
template <class T>
VISVIVA_INLINE T neo_hookean(const T* c, V lambda, V mu, T& log_j) {
    log_j = 0.5 * log1p(determinant_less_one(c));
    return (0.5 * mu) * (c[0] + c[1] + c[2] - 2.0 * log_j) + (0.5 * lambda) * (log_j * log_j);
}

/// Heat content of what does not move, see Capacity; this one where the capacity is constant. Parameters: c,
/// theta0, what else is said of the capacity, and of the pairing six conductivities 11, 22, 33, 12, 23, 31 at
/// theta0 and their relative slope.
struct CapacityEnergy : PlainEnergy {
    static constexpr int n = 1, conductivity = 2 + Capacity::n_par, slope = conductivity + 6,
                         max_par = slope + 1;
    const V* p;
    explicit CapacityEnergy(const V* par) : p(par) {}
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        to.W = p[0] * (e[0] - p[1]), to.s[0] = p[0];
        if (second) to.d[0] = V{};
    }
};

/// Heat content u of a capacity that depends on the temperature. A capacity at one moment of a step sees
/// nothing of latent heat that the step jumps over; so the rate of u follows from its increment and from its
/// own history by the table that the scheme has for fields of order 1. Internal variables: a and w of that.
struct HeatContentEnergy : PlainEnergy {
    static constexpr int n_internal = 2, n = 1 + n_internal, max_par = CapacityEnergy::max_par;
    const V* p;
    Capacity capacity;
    explicit HeatContentEnergy(const V* par) : p(par), capacity(p[0], p[1], p + 2) {}
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        to.W = capacity.content(e[0] - p[1]);
    }
    /// The mean capacity s of the step and its derivative T; what histories share in the rates of theta and
    /// of u, behind `et`.
    template <bool tangent>
    void follow(const Step& step, V rate, const V* e0, V* e1, V* et, V* s, V* T) const {
        const auto& t = step.transport;
        V bend;
        if (step.h < 0) {  // the ledger's way back: to the start of a step, with the rate of theta there
            s[0] = capacity.mean(e1[0] - p[1], e1[0] - p[1], bend), et[1] = et[2] = V{};
            if constexpr (tangent) T[0] = bend;
            for (int k = 1; k <= 2; ++k) e1[k] = e0[k];
            return;
        }
        s[0] = capacity.mean(e0[0] - p[1], e1[0] - p[1], bend);
        const double share = step.stress == Stress::discrete_gradient ? 1.0 : step.theta;
        if constexpr (tangent) T[0] = share > 0 ? bend / share : V{};
        const V change = e1[0] - e0[0], a = e0[1], w = e0[2];
        const bool history = t[0][2] != 0 || t[0][3] != 0;
        et[1] = history ? rate - t[0][0] * change : V{}, et[2] = t[0][2] * a + t[0][3] * w;
        for (int k = 0; k < 2; ++k)
            e1[1 + k] = t[3 + k][0] * (s[0] * change) + t[3 + k][2] * a + t[3 + k][3] * w;
    }
};

/// u' = div(k grad theta), and the ways that heat takes.
struct ConductionPairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        const V* k = z.par + CapacityEnergy::conductivity;
        const auto factor = z.par[CapacityEnergy::slope] * (z.e(0) + (-z.par[1])) + broadcast(1.0);
        f[0] = z.s(0) * z.rate(0);
        for (int a = 0; a < 3; ++a) {
            auto flux = k[at[a][0]] * z.e(1);
            for (int b = 1; b < 3; ++b) flux = flux + k[at[a][b]] * z.e(1 + b);
            f[1 + a] = factor * flux;
        }
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State&) {
        return V{};
    }
};

/// The same with the rate of HeatContentEnergy.
struct HeatContentPairing : ConductionPairing {
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        ConductionPairing::forces(z, f);
        const V *of_theta = z.p.zt + 1, *of_u = z.p.zt + 2;
        f[0] = f[0] + (-*of_theta) * z.s(0) + *of_u;
    }
};

/// W(C) + mu_v / 2 (A : C - 3 - ln det A - ln det C), A the inverse of the viscous Cauchy-Green tensor; both
/// less I. Parameters: lambda, mu, mu_v, viscosity eta. A' = A Y A / eta with Y = -dW/dA, so that Y : A' >=
/// 0.
struct ViscoelasticEnergy : ViscousEnergy {
    static constexpr int max_par = 4;
    const V* p;
    explicit ViscoelasticEnergy(const V* par) : p(par) {}
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        differentiate<second>(
            *this, e,
            [this](const auto* c) {
                auto log_j = c[0];
                const auto w = neo_hookean(c, p[0], p[1], log_j), *a = c + 6;
                auto inner = c[0] * a[0];
                for (int k = 0; k < 6; ++k) {
                    if (k < 3) inner = inner + c[k] + a[k];
                    if (k > 0) inner = inner + tensor_weight(k) * (c[k] * a[k]);
                }
                return w + (0.5 * p[2]) * (inner - log1p(determinant_less_one(a)) - 2.0 * log_j);
            },
            to);
    }
    /// The rate of A; the six derivatives by components count an entry off the diagonal twice.
    template <class T>
    void flow(const T* force, const T* internal, T* rate) const {
        constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        constexpr int a[6] = {0, 1, 2, 0, 1, 2}, b[6] = {0, 1, 2, 1, 2, 0};
        T A[6], Y[6];
        for (int k = 0; k < 6; ++k) {
            A[k] = k < 3 ? internal[k] + 1.0 : internal[k];
            Y[k] = (1.0 / tensor_weight(k)) * force[k];
        }
        for (int k = 0; k < 6; ++k) {
            rate[k] = 0.0 * A[0];
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    rate[k] = rate[k] + (1.0 / p[3]) * (A[at[a[k]][i]] * Y[at[i][j]] * A[at[j][b[k]]]);
        }
    }
};

/// ((1 - d)^2 + rest) W(C) + toughness / (2 length) (d^2 + length^2 |grad d|^2) (AT2). Parameters: lambda,
/// mu, toughness, length, rest, penalty per volume of healing.
struct DamageEnergy : PlainEnergy {
    static constexpr int n = 10, max_par = 6, n_blocks = 2;
    static constexpr int block(int k) { return k < 6 ? 0 : 1; }
    static constexpr double weight(int k) { return behind_tensor(k); }
    const V* p;
    explicit DamageEnergy(const V* par) : p(par) {}
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        differentiate<second>(
            *this, e,
            [this](const auto* x) {
                auto log_j = x[6];
                const auto w = neo_hookean(x, p[0], p[1], log_j), sound = x[6] - 1.0;
                const auto square = x[7] * x[7] + x[8] * x[8] + x[9] * x[9];
                return (sound * sound + p[4]) * w +
                       (0.5 * p[2] / p[3]) * (x[6] * x[6] + (p[3] * p[3]) * square);
            },
            to);
    }
};

/// What heals in a step meets a penalty (Gerasimov & De Lorenzis 2019). Growth is no healing on the way back.
struct IrreversiblePairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        for (int k = 0; k < 10; ++k) f[k] = z.s(k);
        if (!z.backwards) f[6] = f[6] - z.par[5] * positive(-z.change(6));
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State& z) {
        const V healed = z.backwards ? V{} : positive(-z.change(6));
        return z.par[5] * healed * healed;
    }
};

/// barrier c^2 (1 - c)^2 + kappa / 2 |grad c|^2. Parameters: barrier, kappa, mobility.
struct SeparationEnergy : PlainEnergy {
    static constexpr int n = 4, max_par = 3, n_blocks = 2;
    static constexpr int block(int k) { return k == 0 ? 0 : 1; }
    const V* p;
    explicit SeparationEnergy(const V* par) : p(par) {}
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        differentiate<second>(
            *this, e,
            [this](const auto* x) {
                const auto product = x[0] * (x[0] - 1.0);
                return p[0] * (product * product) + (0.5 * p[1]) * (x[1] * x[1] + x[2] * x[2] + x[3] * x[3]);
            },
            to);
    }
};

/// Cahn & Hilliard: the balance c' = div(M grad mu) tests the concentration, that the potential is D_c W
/// tests the potential, whose shape functions are the same.
struct DiffusionPairing {
    static constexpr bool is_gradient = false;
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        f[0] = z.rate(0);
        f[4] = z.e(4) - z.s(0);
        for (int k = 1; k < 4; ++k) f[k] = z.par[2] * z.e(4 + k), f[4 + k] = -z.s(k);
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State& z) {
        V square{};
        for (int k = 5; k < 8; ++k) square += z.e(k) * z.e(k);
        return z.h * z.par[2] * square;
    }
};

/// 1/2 e . C e, C symmetric, its upper triangle by rows: of a section. Further parameters are of its pairing.
template <int size, int further = 0>
struct SectionEnergy : PlainEnergy {
    static constexpr int n = size, max_par = size * (size + 1) / 2 + further;
    const V* p;
    explicit SectionEnergy(const V* par) : p(par) {}
    bool is_quadratic() const { return true; }
    template <bool second>
    void evaluate(const V* e, Potential<n>& to) const {
        to.W = V{};
        for (int a = 0; a < n; ++a) {
            to.s[a] = V{};
            for (int b = 0; b < n; ++b) {
                const V c = p[a < b ? packed(n, a, b) : packed(n, b, a)];
                to.s[a] += c * e[b];
                if (second && a <= b) to.d[packed(n, a, b)] = c;
            }
            to.W += 0.5 * to.s[a] * e[a];
        }
    }
};

/// Kelvin & Voigt: f = s + D de/dt, D symmetric, its upper triangle by rows behind the stiffness. Booked with
/// the mean rate of the step, so that nothing is gained; with energy and momentum these are the work's own.
template <int size>
struct ViscousPairing {
    static constexpr bool is_gradient = false;
    static constexpr int first = size * (size + 1) / 2;
    static V viscosity(const V* par, int a, int b) {
        return par[first + (a < b ? packed(size, a, b) : packed(size, b, a))];
    }
    template <class State>
    static VISVIVA_INLINE void forces(const State& z, typename State::T* f) {
        for (int a = 0; a < size; ++a) {
            f[a] = z.s(a);
            for (int b = 0; b < size; ++b) f[a] = f[a] + viscosity(z.par, a, b) * z.rate(b);
        }
    }
    template <class State>
    static VISVIVA_INLINE V dissipated(const State& z) {
        V sum{};
        if (!z.moves || z.h == 0) return sum;
        for (int a = 0; a < size; ++a)
            for (int b = 0; b < size; ++b) sum += z.change(a) * viscosity(z.par, a, b) * z.change(b);
        return sum / z.h;
    }
};

}  // namespace visviva::VISVIVA_ISA
