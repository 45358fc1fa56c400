// Energies of any number of strains: discrete gradients and their tangents, as for a single C.
#pragma once
#include "visviva/material/response.hpp"
#include "visviva/term/step.hpp"

namespace visviva::VISVIVA_ISA {

// Symmetric tensors one after the other: an entry off the diagonal stands for two.
VISVIVA_INLINE double multiplicity(int k) { return k % 6 < 3 ? 1.0 : 2.0; }

template <int n>
VISVIVA_INLINE V contract_all(const V* a, const V* b) {
    V sum{};
    for (int k = 0; k < n; ++k) sum += multiplicity(k) * a[k] * b[k];
    return sum;
}

/// Energy of n / 6 tensors c = C - I, its gradient s and second gradient d: ds_k = sum_l multiplicity(l) d_kl
/// dc_l.
template <int n>
struct Potential {
    V W, s[n], d[n * n];
};

VISVIVA_INLINE void as_potential(const Response& r, bool second, Potential<6>& p) {
    p.W = r.W;
    for (int k = 0; k < 6; ++k) p.s[k] = r.s[k];
    for (int k = 0; second && k < 6; ++k)
        for (int l = k; l < 6; ++l) p.d[6 * k + l] = p.d[6 * l + k] = r.d[packed(6, k, l)];
}

/// The discrete gradient's correction f of the gradient m in the middle, S = 2 (m + f d), and its derivative;
/// see SolidElement::discrete_gradient.
template <bool tangent, class Energy, int n = Energy::n>
VISVIVA_INLINE V correction(const Energy& energy, const V* c0, const V* c1, const V* cm, const V* d,
                            const Potential<n>& m, V* df) {
    Potential<n> p0, p1;
    V first[n], second[n];
    energy.template evaluate<false>(c0, p0), energy.template evaluate<false>(c1, p1);
    for (int k = 0; k < n; ++k) {
        first[k] = p1.s[k] - p0.s[k];
        second[k] = first[k] - 2.0 * (m.s[k] - p0.s[k]);
    }
    const VI smooth = contract_all<n>(second, second) <= 1e-8 * contract_all<n>(first, first);
    const V size = contract_all<n>(d, d);
    const V b = select(smooth, contract_all<n>(second, d) / 6.0, p1.W - p0.W - contract_all<n>(m.s, d));
    const VI idle = (size <= 1e-22) | (b * b <= 1e-30 * contract_all<n>(m.s, m.s) * contract_all<n>(cm, cm));
    const V inverse = select(idle, V{}, 1.0 / select(idle, broadcast(1.0), size)), f = b * inverse;
    for (int k = 0; tangent && k < n; ++k) {
        V half{};
        for (int l = 0; l < n; ++l) half += (0.5 * multiplicity(l)) * m.d[n * k + l] * d[l];
        df[k] = inverse * (p1.s[k] - m.s[k] - half - 2.0 * f * d[k]);
    }
    return f;
}

/// S = 2 dW/dC at theta or as discrete gradient between c0 and c1, and T = 2 dS/dC1.
template <bool tangent, class Energy, int n = Energy::n>
VISVIVA_INLINE void stress_of(const Energy& energy, const Step& step, bool quadratic, const V* c0,
                              const V* ct, const V* c1, V* S, V* T) {
    Potential<n> m;
    if (step.stress == Stress::at_theta) {
        energy.template evaluate<tangent>(ct, m);
        for (int k = 0; k < n; ++k) S[k] = 2.0 * m.s[k];
        for (int k = 0; tangent && k < n * n; ++k) T[k] = 4.0 * step.theta * m.d[k];
        return;
    }
    V cm[n], d[n], f{}, df[n] = {};
    for (int k = 0; k < n; ++k) cm[k] = 0.5 * (c0[k] + c1[k]), d[k] = c1[k] - c0[k];
    energy.template evaluate<tangent>(cm, m);
    if (!quadratic) f = correction<tangent>(energy, c0, c1, cm, d, m, df);
    for (int k = 0; k < n; ++k) S[k] = 2.0 * (m.s[k] + f * d[k]);
    for (int k = 0; tangent && k < n; ++k)
        for (int l = 0; l < n; ++l) {
            T[n * k + l] = 2.0 * m.d[n * k + l] + 4.0 * d[k] * df[l];
            if (k == l) T[n * k + l] += (4.0 / multiplicity(k)) * f;
        }
}

}  // namespace visviva::VISVIVA_ISA
