// Laws: from generalised strains to stresses S and their derivatives. Energies are written once over a number
// type; stresses and tangents follow by forward differentiation, discrete gradients like those of materials.
#pragma once
#include "visviva/material/discrete_gradient.hpp"
#include "visviva/strain/strain.hpp"

namespace visviva::VISVIVA_ISA {

struct LinearEnergy {
    template <class T>
    static VISVIVA_INLINE T energy(T e, V k, V) {
        return k * e;
    }
};
struct QuadraticEnergy {
    template <class T>
    static VISVIVA_INLINE T energy(T e, V k, V e_free) {
        const T d = e - e_free;
        return (0.5 * k) * (d * d);
    }
};
struct LengthEnergy {
    template <class T>
    static VISVIVA_INLINE T energy(T e, V k, V length) {
        const T d = root(e) - length;
        return (0.5 * k) * (d * d);
    }
};

// Everything a law reads and writes for one group of W elements.
struct LawData {
    const Step* step;
    const StrainView* view;
    const Signals* signals;
    int base;                      // first element of the group
    const V *e0, *e1, *et, *edot;  // strains at 0, 1, theta and their rate
    const V* lam;                  // multipliers
    V *S, *D, *R, *Phi, *J, *Jt;   // D = dS/de, R = dS/d(edot), J = dPhi/de1, Jt = dS/dlam
    V par(int k) const { return vload(view->par + k * view->stride + base); }
};

VISVIVA_INLINE V signal(const LawData& a, const double* s, int m, double missing) {
    V r;
    const int* number = a.view->signal + m * a.view->stride + a.base;
    for (int l = 0; l < W; ++l) r[l] = number[l] < 0 ? missing : s[number[l]];
    return r;
}

/// An energy of one strain with the two parameters of a law.
template <class Energy>
struct LawEnergy : PlainEnergy {
    static constexpr int n = 1;
    V p0, p1;
    template <bool second>
    VISVIVA_INLINE void evaluate(const V* e, Potential<1>& p) const {
        differentiate<second>(*this, e, [this](const auto* x) { return Energy::energy(x[0], p0, p1); }, p);
    }
};

template <class Energy>
VISVIVA_INLINE void potential_law(const LawData& a) {
    const LawEnergy<Energy> energy{{}, a.par(0), a.par(1)};
    stress_of<true>(energy, *a.step, a.e0, a.e1, a.et, a.S, a.D);
}

// Phi = -e0 sin e2 + e1 cos e2, with the exact discrete derivative of its products.
VISVIVA_INLINE void angle_law(const LawData& a) {
    const V l = a.lam[0];
    V s1 = vsin(a.e1[2]), c1 = vcos(a.e1[2]);
    a.Phi[0] = c1 * a.e1[1] - s1 * a.e1[0];
    a.J[0] = -s1;
    a.J[1] = c1;
    a.J[2] = -c1 * a.e1[0] - s1 * a.e1[1];
    if (a.step->stress == Stress::at_theta) {
        V s = vsin(a.et[2]), c = vcos(a.et[2]), g = -c * a.et[0] - s * a.et[1];
        a.Jt[0] = -s;
        a.Jt[1] = c;
        a.Jt[2] = g;
        a.D[0] = a.D[1] = a.D[3] = a.D[4] = broadcast(0.0);
        a.D[2] = a.D[6] = -l * c;
        a.D[5] = a.D[7] = -l * s;
        a.D[8] = l * (s * a.et[0] - c * a.et[1]);
    } else {
        V s0 = vsin(a.e0[2]), c0 = vcos(a.e0[2]);
        V tm = 0.5 * (a.e0[2] + a.e1[2]), u = 0.5 * (a.e1[2] - a.e0[2]);
        V sm = vsin(tm), cm = vcos(tm), Am = 0.5 * (a.e0[0] + a.e1[0]), Bm = 0.5 * (a.e0[1] + a.e1[1]);
        VI tiny = vabs(u) < 1e-4;
        V us = select(tiny, broadcast(1.0), u);
        V sinc = select(tiny, 1.0 - u * u / 6.0, vsin(us) / us);
        V dsinc = select(tiny, -u / 3.0, (us * vcos(us) - vsin(us)) / (us * us));
        V g = -Am * cm - Bm * sm;
        a.Jt[0] = -0.5 * (s0 + s1);
        a.Jt[1] = 0.5 * (c0 + c1);
        a.Jt[2] = sinc * g;
        a.D[0] = a.D[1] = a.D[3] = a.D[4] = broadcast(0.0);
        a.D[2] = -0.5 * l * c1;
        a.D[5] = -0.5 * l * s1;
        a.D[6] = -0.5 * l * sinc * cm;
        a.D[7] = -0.5 * l * sinc * sm;
        a.D[8] = 0.5 * l * (dsinc * g + sinc * (Am * sm - Bm * cm));
    }
    for (int i = 0; i < 3; ++i) a.S[i] = a.Jt[i] * l;
}

VISVIVA_INLINE void follower_law(const LawData& a) {
    const V s = signal(a, a.signals->ate, 0, 1.0);
    for (int k = 0; k < 36; ++k) a.D[k] = broadcast(0.0);
    for (int c = 0; c < 3; ++c) {
        a.S[c] = -s * a.et[3 + c];
        a.S[3 + c] = broadcast(0.0);
        a.D[6 * c + 3 + c] = -s;
    }
}

VISVIVA_INLINE void cross(const V* a, const V* b, V* c) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

// The torque m on one director d, of any length, as a force f = m x d / d.d: d x f = m less its part along d.
VISVIVA_INLINE void couple_law(const LawData& a) {
    const V s = signal(a, a.signals->ate, 0, 1.0), *d = a.et, *m = a.et + 3;
    const V inverse = 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), by = s * inverse;
    V f[3], unit[3], column[3];
    cross(m, d, f);
    for (int c = 0; c < 3; ++c) {
        a.S[c] = -by * f[c];
        a.S[3 + c] = broadcast(0.0);
    }
    for (int k = 18; k < 36; ++k) a.D[k] = broadcast(0.0);
    for (int k = 0; k < 3; ++k) {
        for (int c = 0; c < 3; ++c) unit[c] = broadcast(c == k ? 1.0 : 0.0);
        cross(m, unit, column);
        for (int c = 0; c < 3; ++c) a.D[6 * c + k] = -by * column[c] - 2.0 * inverse * a.S[c] * d[k];
        cross(unit, d, column);
        for (int c = 0; c < 3; ++c) a.D[6 * c + 3 + k] = -by * column[c];
    }
}

// Inverse of the symmetric A = tr(D) I - D, D = sum d_i d_i^T, the moment of the forces t x d_i per t.
VISVIVA_INLINE void inverse_arm(const V* d, V inverse[3][3]) {
    V A[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            A[i][j] = broadcast(0.0);
            for (int k = 0; k < 3; ++k) A[i][j] -= d[3 * k + i] * d[3 * k + j];
        }
    const V trace = -(A[0][0] + A[1][1] + A[2][2]);
    for (int i = 0; i < 3; ++i) A[i][i] += trace;
    V minor[3][3];
    for (int i = 0; i < 3; ++i) cross(A[(i + 1) % 3], A[(i + 2) % 3], minor[i]);
    const V det = A[0][0] * minor[0][0] + A[0][1] * minor[0][1] + A[0][2] * minor[0][2];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) inverse[i][j] = minor[i][j] / det;
}

VISVIVA_INLINE void times(const V A[3][3], const V* b, V* c) {
    for (int i = 0; i < 3; ++i) c[i] = A[i][0] * b[0] + A[i][1] * b[1] + A[i][2] * b[2];
}

// The torque m as forces f_i = t x d_i on the directors with A t = m: sum d_i x f_i = m also where the
// directors of the evaluation point are not orthonormal. Column `column` of D gets the derivatives by dt and,
// for director j, t x u.
VISVIVA_INLINE void torque_column(const LawData& a, const V* dt, const V* t, int column, int j) {
    V f[3], unit[3] = {broadcast(0.0), broadcast(0.0), broadcast(0.0)};
    for (int i = 0; i < 3; ++i) {
        cross(dt, a.et + 3 * i, f);
        for (int c = 0; c < 3; ++c) a.D[(3 * i + c) * 12 + column] = -f[c];
    }
    if (j < 0) return;
    unit[column % 3] = broadcast(1.0);
    cross(t, unit, f);
    for (int c = 0; c < 3; ++c) a.D[(3 * j + c) * 12 + column] -= f[c];
}

VISVIVA_INLINE void torque_law(const LawData& a) {
    const V s = signal(a, a.signals->ate, 0, 1.0);
    V inverse[3][3], m[3], t[3], f[3], dt[3];
    inverse_arm(a.et, inverse);
    for (int c = 0; c < 3; ++c) m[c] = s * a.et[9 + c];
    times(inverse, m, t);
    for (int i = 0; i < 3; ++i) {
        cross(t, a.et + 3 * i, f);
        for (int c = 0; c < 3; ++c) a.S[3 * i + c] = -f[c];
        a.S[9 + i] = broadcast(0.0);
    }
    for (int k = 9 * 12; k < 12 * 12; ++k) a.D[k] = broadcast(0.0);
    for (int j = 0; j < 3; ++j) {
        const V* d = a.et + 3 * j;
        const V along = d[0] * t[0] + d[1] * t[1] + d[2] * t[2];
        for (int k = 0; k < 3; ++k) {
            // dt = -A^-1 dA t for a change of d_j along axis k
            for (int c = 0; c < 3; ++c) m[c] = d[c] * t[k] - 2.0 * d[k] * t[c];
            m[k] += along;
            times(inverse, m, dt);
            torque_column(a, dt, t, 3 * j + k, j);
        }
    }
    for (int k = 0; k < 3; ++k) {
        for (int c = 0; c < 3; ++c) dt[c] = s * inverse[c][k];
        torque_column(a, dt, t, 9 + k, -1);
    }
}

// Coordinates given to functions from outside: element-fastest arrays that the callback has filled.
VISVIVA_INLINE void copy(const LawData& a, const double* from, int n, V* to) {
    for (int k = 0; k < n; ++k) to[k] = vload(from + k * a.view->stride + a.base);
}

VISVIVA_INLINE void callback_law(const LawData& a) {
    const ShapeView& s = a.view->shape;
    copy(a, a.view->cb_D, s.n_e * s.n_e, a.D);
    if (s.law == LawKind::rate_callback) copy(a, a.view->cb_R, s.n_e * s.n_e, a.R);
    if (s.law != LawKind::function_callback) {
        copy(a, a.view->cb_S, s.n_e, a.S);
        return;
    }
    copy(a, a.view->cb_Phi, s.n_m, a.Phi);
    copy(a, a.view->cb_J, s.n_m * s.n_e, a.J);
    copy(a, a.view->cb_Jt, s.n_e * s.n_m, a.Jt);
    for (int i = 0; i < s.n_e; ++i) {
        a.S[i] = broadcast(0.0);
        for (int m = 0; m < s.n_m; ++m) a.S[i] += a.Jt[i * s.n_m + m] * a.lam[m];
    }
}

VISVIVA_INLINE void evaluate_law(const LawData& a) {
    const ShapeView& s = a.view->shape;
    switch (s.law) {
        case LawKind::linear:
            a.S[0] = a.par(0);
            break;
        case LawKind::quadratic:
            potential_law<QuadraticEnergy>(a);
            break;
        case LawKind::length:
            potential_law<LengthEnergy>(a);
            break;
        case LawKind::constraint:
            for (int m = 0; m < s.n_m; ++m) {
                a.Phi[m] = a.e1[m] - signal(a, a.signals->at1, m, 0.0);
                a.S[m] = a.lam[m];
            }
            break;
        case LawKind::angle:
            angle_law(a);
            break;
        case LawKind::servo:
            for (int m = 0; m < s.n_m; ++m) {
                a.Phi[m] = a.e1[m] - signal(a, a.signals->at1, m, 0.0);
                a.S[m] = broadcast(0.0);
                a.S[s.n_m + m] = -a.lam[m];
            }
            break;
        case LawKind::load:
            a.S[0] = -a.par(0) * signal(a, a.signals->ate, 0, 1.0);
            break;
        case LawKind::viscous:
            a.S[0] = a.par(0) * a.edot[0];
            a.R[0] = a.par(0);
            a.D[0] = broadcast(0.0);
            break;
        case LawKind::viscous_length:  // force c l', l' = e'/(2 l), S = force / (2 l)
            a.R[0] = 0.25 * a.par(0) / a.et[0];
            a.S[0] = a.R[0] * a.edot[0];
            a.D[0] = -a.S[0] / a.et[0];
            break;
        case LawKind::energy_callback:
        case LawKind::function_callback:
        case LawKind::rate_callback:
            callback_law(a);
            break;
        case LawKind::follower:
            follower_law(a);
            break;
        case LawKind::couple:
            couple_law(a);
            break;
        case LawKind::torque:
            torque_law(a);
            break;
    }
}

VISVIVA_INLINE V law_energy(const LawData& a) {
    switch (a.view->shape.law) {
        case LawKind::linear:
            return LinearEnergy::energy(a.e1[0], a.par(0), a.par(1));
        case LawKind::quadratic:
            return QuadraticEnergy::energy(a.e1[0], a.par(0), a.par(1));
        case LawKind::length:
            return LengthEnergy::energy(a.e1[0], a.par(0), a.par(1));
        case LawKind::energy_callback:
            return vload(a.view->cb_W + a.base);
        default:
            return broadcast(0.0);
    }
}

}  // namespace visviva::VISVIVA_ISA
