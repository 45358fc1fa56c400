// The energies of the formulations against volumetric locking, as functions of strains.
#pragma once
#include "visviva/material/wrapped.hpp"

namespace visviva::VISVIVA_ISA {

/// The potential of W(Cbar(e)) from that of an energy of tensors and Cbar - I as jets of the strains of its
/// owner.
template <bool second, class Owner, class Energy, class Strain, int n = Owner::n>
void evaluate_at(const Owner&, const Energy& energy, const V* e, Strain&& strain, Potential<n>& p) {
    using J = Jet<n, second>;
    J variables[n], bar[6];
    V values[6];
    for (int k = 0; k < n; ++k) variables[k] = J::variable(e[k], k);
    strain(variables, bar);
    for (int k = 0; k < 6; ++k) values[k] = bar[k].v;
    Response r;
    energy.template evaluate<second>(values, r);
    p.W = r.W;
    for (int a = 0; a < n; ++a) {
        V sum{}, row[6];
        for (int k = 0; k < 6; ++k) sum += tensor_weight(k) * r.s[k] * bar[k].g[a];
        p.s[a] = sum / Owner::weight(a);
        if constexpr (second) {
            for (int l = 0; l < 6; ++l) {
                row[l] = V{};
                for (int k = 0; k < 6; ++k)
                    row[l] += (tensor_weight(k) * tensor_weight(l)) * r.second(k, l) * bar[k].g[a];
            }
            for (int b = a; b < n; ++b) {
                V h{};
                for (int l = 0; l < 6; ++l)
                    h += row[l] * bar[l].g[b] + tensor_weight(l) * r.s[l] * bar[l].h[packed(n, a, b)];
                p.d[packed(n, a, b)] = h / (Owner::weight(a) * Owner::weight(b));
            }
        }
    }
}

/// F-bar of an energy: W(Cbar) of C and C0 at the element's centre, Cbar = (det C0 / det C)^(1/3) C; in plane
/// strain the part in the plane is scaled alone, by the square root of its determinants. The twelve strains
/// are quadratic in the positions, so that the discrete gradient conserves; de Souza Neto et al. (1996) put
/// the stress of Fbar into the residual of F instead, which has no energy.
template <class Energy>
struct FbarEnergy : TensorEnergy {
    static constexpr int n = 12;
    Energy energy;
    bool small;
    int directions;  // that share the change of volume

    bool is_quadratic() const { return energy.is_quadratic() && small; }
    VISVIVA_INLINE double scaled(int k) const { return directions == 3 || k == 0 || k == 1 || k == 3; }

    // Cbar - I of (C - I, C0 - I); for small strains the trace is exchanged
    template <class T>
    VISVIVA_INLINE void strain(const T* c, T* bar) const {
        const double share = 1.0 / directions;
        T t = small ? share * (c[6] + c[7] - c[0] - c[1])
                    : expm1(share * (log1p(determinant_less_one(c + 6, directions == 2)) -
                                     log1p(determinant_less_one(c, directions == 2))));
        if (small && directions == 3) t = t + share * (c[8] - c[2]);
        for (int k = 0; k < 6; ++k) {
            bar[k] = c[k];
            if (!small && scaled(k) > 0) bar[k] = bar[k] + t * c[k];
            if (k < directions) bar[k] = bar[k] + t;
        }
    }

    template <bool second>
    void evaluate(const V* c, Potential<12>& p) const {
        evaluate_at<second>(*this, energy, c, [this](const auto* e, auto* bar) { strain(e, bar); }, p);
    }
};

/// Measure of the change of volume that a pressure acts on: g with U = g^2 / 2 of the volumetric energy U,
/// numbered like those (see volumetric()); tr E is for linear materials, U = ((J^-b - 1) / b + ln J) / b for
/// Blatz and Ko's.
enum class VolumeMeasure : int { logarithm = 0, difference = 1, simo = 2, trace = 3, blatz_ko = 4 };

/// g = sign(j) sqrt((J^2 - 1 - 2 ln J) / 2), J = 1 + j; by its series where that loses digits.
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> simo_measure(const Jet<n, second>& j) {
    constexpr double a[11] = {1.0,
                              -1.0 / 6,
                              1.0 / 9,
                              -11.0 / 135,
                              103.0 / 1620,
                              -3523.0 / 68040,
                              7397.0 / 170100,
                              -4768.0 / 127575,
                              400471.0 / 12247200,
                              -351818839.0 / 12124728000,
                              663198749.0 / 25461928800};
    V f{}, f1{}, f2{};
    for (int k = 10; k >= 0; --k) {
        f = f * j.v + a[k], f1 = f1 * j.v + (k + 1) * a[k];
        if (k > 0) f2 = f2 * j.v + (k + 1) * k * a[k];
    }
    const VI near = vabs(j.v) < 0.03;
    const V J = 1.0 + j.v, root = vsqrt(0.5 * j.v * j.v + (j.v - vlog1p(j.v)));
    const V g = select(near, broadcast(1.0), select(j.v < 0.0, -root, root));
    const V g1 = 0.5 * (J - 1.0 / J) / g, g2 = (0.5 * (1.0 + 1.0 / (J * J)) - g1 * g1) / g;
    return chain(j, select(near, f * j.v, g), select(near, f1, g1), select(near, f2, g2));
}

/// g = sign(y) sqrt(2 (e^-y - 1 + y)) / b, y = b ln(1 + j); by its series where that loses digits.
template <int n, bool second>
VISVIVA_INLINE Jet<n, second> blatz_ko_measure(const Jet<n, second>& j, V b) {
    constexpr double a[11] = {1.0,
                              -1.0 / 6,
                              1.0 / 36,
                              -1.0 / 270,
                              1.0 / 2592,
                              -17.0 / 544320,
                              11.0 / 5443200,
                              -1.0 / 8164800,
                              1.0 / 111974400,
                              -487.0 / 775982592000,
                              457.0 / 32591268864000};
    const Jet<n, second> y = b * log1p(j);
    V f{}, f1{}, f2{};
    for (int k = 10; k >= 0; --k) {
        f = f * y.v + a[k], f1 = f1 * y.v + (k + 1) * a[k];
        if (k > 0) f2 = f2 * y.v + (k + 1) * k * a[k];
    }
    const VI near = vabs(y.v) < 0.4;
    const V falling = expm1(-y.v), root = vsqrt(2.0 * (falling + y.v));
    const V g = select(near, broadcast(1.0), select(y.v < 0.0, -root, root));
    const V g1 = -falling / g, g2 = (1.0 + falling - g1 * g1) / g;
    return (1.0 / b) * chain(y, select(near, f * y.v, g), select(near, f1, g1), select(near, f2, g2));
}

struct VolumeEnergy : TensorEnergy {
    static constexpr int n = 6;
    VolumeMeasure measure;
    V exponent;  // of Blatz and Ko

    bool is_quadratic() const { return measure == VolumeMeasure::trace; }
    template <bool second>
    VISVIVA_INLINE void evaluate(const V* c, Response& r) const {
        if (measure == VolumeMeasure::trace) {
            r.W = 0.5 * (c[0] + c[1] + c[2]);
            for (int k = 0; k < 6; ++k) r.s[k] = broadcast(k < 3 ? 0.5 : 0.0);
            clear(r.d, 21);
        } else if (measure == VolumeMeasure::logarithm) {
            from_invariants<3, second>(c, c, [](const auto* i) { return log1p(i[2]); }, r);
        } else if (measure == VolumeMeasure::simo) {
            from_invariants<3, second>(c, c, [](const auto* i) { return simo_measure(i[2]); }, r);
        } else if (measure == VolumeMeasure::blatz_ko) {
            from_invariants<3, second>(
                c, c, [this](const auto* i) { return blatz_ko_measure(i[2], exponent); }, r);
        } else {
            from_invariants<3, second>(c, c, [](const auto* i) { return i[2]; }, r);
        }
    }
};

/// Mixed: W(C) without its volumetric part, plus p g(J).
template <class Energy>
struct PressureEnergy : Energy {
    VolumeEnergy volume;
    V pressure;

    template <bool second>
    void evaluate(const V* c, Response& r) const {
        Response g;
        Energy::template evaluate<second>(c, r);
        volume.evaluate<second>(c, g);
        r.W += pressure * g.W;
        for (int k = 0; k < 6; ++k) r.s[k] += pressure * g.s[k];
        for (int k = 0; second && k < 21; ++k) r.d[k] += pressure * g.d[k];
    }
};

}  // namespace visviva::VISVIVA_ISA
