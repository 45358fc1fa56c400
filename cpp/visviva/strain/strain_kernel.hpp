// Residual, tangent and ledger of the generic strain term, W elements at a time.
#pragma once
#include "visviva/strain/strain_laws.hpp"

namespace visviva::VISVIVA_ISA {

// Work arrays of one group, laid into the term's scratch memory.
struct Work {
    V *y1, *yt, *ydot, *e1, *et, *edot, *e0, *lam, *S, *D, *R, *Phi, *J, *Jt, *g, *g1, *gc, *gr, *ky, *gy;
    Work(const ShapeView& s, double* scratch) {
        V* p = reinterpret_cast<V*>(scratch);
        auto take = [&p](int n) {
            V* q = p;
            p += n;
            return q;
        };
        const int ny = s.n_y, ne = s.n_e, nm = s.n_m;
        y1 = take(ny), yt = take(ny), ydot = take(ny), gy = take(ny);
        e1 = take(ne), et = take(ne), edot = take(ne), e0 = take(ne), S = take(ne);
        lam = take(nm), Phi = take(nm);
        D = take(ne * ne), R = take(ne * ne), J = take(nm * ne), Jt = take(nm * ne);
        g = take(ne * ny), g1 = take(ne * ny), gc = take(ne * ny), gr = take(ne * ny);
        ky = take(ny * ny);
    }
};

VISVIVA_INLINE void forms(const StrainView& v, const double* x, int base, bool constant, V* y) {
    const ShapeView& s = v.shape;
    for (int a = 0; a < s.n_y; ++a) y[a] = constant ? vload(v.y_const + a * v.stride + base) : broadcast(0.0);
    const int n = s.n_forms;
    const int *row = s.form_row, *col = s.form_col;
    int last = -1;
    V xj = broadcast(0.0);
    for (int k = 0; k < n; ++k) {
        if (col[k] != last) {
            last = col[k];
            xj = gather(x, v.index + last * v.stride + base);
        }
        y[row[k]] += vload(v.weight + k * v.stride + base) * xj;
    }
}

VISVIVA_INLINE void strains(const StrainView& v, const V* y, int base, V* e) {
    const ShapeView& s = v.shape;
    for (int i = 0; i < s.n_e; ++i) e[i] = vload(v.e_const + i * v.stride + base);
    const int nq = s.n_quad, nl = s.n_lin;
    const int *qe = s.quad_e, *qa = s.quad_a, *qb = s.quad_b;
    for (int k = 0; k < nq; ++k) e[qe[k]] += s.quad_coef[k] * y[qa[k]] * y[qb[k]];
    for (int k = 0; k < nl; ++k) e[s.lin_e[k]] += s.lin_coef[k] * y[s.lin_a[k]];
}

// g[i * n_y + a] = d e_i / d y_a at y; without the linear part: the same for the rate of the gradient.
VISVIVA_INLINE void gradients(const ShapeView& s, const V* y, bool linear, V* g) {
    for (int k = 0; k < s.n_e * s.n_y; ++k) g[k] = broadcast(0.0);
    const int nq = s.n_quad, nl = s.n_lin;
    for (int k = 0; k < nq; ++k) {
        const int i = s.quad_e[k] * s.n_y, a = s.quad_a[k], b = s.quad_b[k];
        const double c = s.quad_coef[k];
        g[i + a] += c * y[b];
        g[i + b] += c * y[a];
    }
    if (!linear) return;
    for (int k = 0; k < nl; ++k) g[s.lin_e[k] * s.n_y + s.lin_a[k]] += s.lin_coef[k];
}

// de/dt at y with the rates ydot of the forms.
VISVIVA_INLINE void strain_rates(const ShapeView& s, const V* y, const V* ydot, V* edot) {
    for (int i = 0; i < s.n_e; ++i) edot[i] = broadcast(0.0);
    for (int k = 0; k < s.n_quad; ++k) {
        const int a = s.quad_a[k], b = s.quad_b[k];
        edot[s.quad_e[k]] += s.quad_coef[k] * (ydot[a] * y[b] + y[a] * ydot[b]);
    }
    for (int k = 0; k < s.n_lin; ++k) edot[s.lin_e[k]] += s.lin_coef[k] * ydot[s.lin_a[k]];
}

VISVIVA_INLINE double term_theta(const ShapeView& s, const Step& step) {
    return traits(s.law).is_constraint ? step.theta_g : step.theta;
}

// Laws that look at strains between the ends; for the others their gradients are all that theta is about.
VISVIVA_INLINE bool looks_at_theta(LawKind k) {
    return k != LawKind::linear && k != LawKind::constraint && k != LawKind::servo && k != LawKind::load;
}

// Strains at the ends and at theta, their rate, and what the law makes of them.
VISVIVA_INLINE LawData evaluate(const StrainView& v, const Step& step, const Vectors& x,
                                const Signals& signals, int base, const Work& w, bool law = true) {
    const ShapeView& s = v.shape;
    const double theta = term_theta(s, step);
    forms(v, x.x1, base, true, w.y1);
    strains(v, w.y1, base, w.e1);
    for (int a = 0; a < s.n_y; ++a) {
        V y0 = vload(v.y0 + a * v.stride + base);
        w.yt[a] = theta == 1.0 ? w.y1[a] : y0 + theta * (w.y1[a] - y0);
    }
    if (looks_at_theta(s.law)) {
        for (int i = 0; i < s.n_e; ++i) w.e0[i] = vload(v.e0 + i * v.stride + base);
        strains(v, w.yt, base, w.et);
    }
    if (traits(s.law).needs_rate) {
        if (x.rate) forms(v, x.rate, base, false, w.ydot);
        for (int b = 0; !x.rate && b < s.n_y; ++b)  // their mean in the step
            w.ydot[b] = (w.y1[b] - vload(v.y0 + b * v.stride + base)) / step.h;
        strain_rates(s, w.yt, w.ydot, w.edot);
    }
    for (int m = 0; m < s.n_m; ++m) w.lam[m] = gather(x.x1, v.index + (s.n_x + m) * v.stride + base);
    LawData a{&step, &v, &signals, base, w.e0, w.e1, w.et, w.edot, w.lam, w.S, w.D, w.R, w.Phi, w.J, w.Jt};
    if (law) evaluate_law(a);
    return a;
}

// gy = grad e(y)^T S
VISVIVA_INLINE void form_forces(const ShapeView& s, const V* y, const V* S, V* gy) {
    for (int a = 0; a < s.n_y; ++a) gy[a] = broadcast(0.0);
    for (int k = 0; k < s.n_quad; ++k) {
        const int a = s.quad_a[k], b = s.quad_b[k];
        const V c = s.quad_coef[k] * S[s.quad_e[k]];
        gy[a] += c * y[b];
        gy[b] += c * y[a];
    }
    for (int k = 0; k < s.n_lin; ++k) gy[s.lin_a[k]] += s.lin_coef[k] * S[s.lin_e[k]];
}

VISVIVA_INLINE int active(const StrainView& v, int base) { return v.n - base < W ? v.n - base : W; }

VISVIVA_INLINE void scatter(V a, const int* index, int n, double* r) {
    for (int l = 0; l < n; ++l) r[index[l]] += a[l];
}

// The end of a step is the begin of the next.
VISVIVA_INLINE void keep_ends(const StrainView& v, int base, const Work& w) {
    for (int a = 0; a < v.shape.n_y; ++a) vstore(v.y0 + a * v.stride + base, w.y1[a]);
    for (int i = 0; i < v.shape.n_e; ++i) vstore(v.e0 + i * v.stride + base, w.e1[i]);
}

void strain_begin(const StrainView& v, const double* x) {
    Work w(v.shape, v.scratch);
    for (int base = 0; base < v.n; base += W) {
        forms(v, x, base, true, w.y1);
        strains(v, w.y1, base, w.e1);
        keep_ends(v, base, w);
    }
}

// The arguments of a callback law: strains at theta, their rate, strains at the end.
void strain_strains(const StrainView& v, const Step& step, const Vectors& x) {
    Work w(v.shape, v.scratch);
    Signals none;
    for (int base = 0; base < v.n; base += W) {
        evaluate(v, step, x, none, base, w, false);
        for (int i = 0; i < v.shape.n_e; ++i) {
            vstore(v.e_eval + i * v.stride + base, w.et[i]);
            vstore(v.e1 + i * v.stride + base, w.e1[i]);
            if (traits(v.shape.law).needs_rate) vstore(v.e_rate + i * v.stride + base, w.edot[i]);
        }
    }
}

void strain_residual(const StrainView& v, const Step& step, const Vectors& x, const Signals& signals,
                     double* r) {
    const ShapeView& s = v.shape;
    Work w(s, v.scratch);
    const int n_forms = s.n_forms;
    for (int base = 0; base < v.n; base += W) {
        evaluate(v, step, x, signals, base, w);
        const int n = active(v, base);
        form_forces(s, w.yt, w.S, w.gy);
        const int *row = s.form_row, *col = s.form_col;
        for (int k = 0; k < n_forms;) {
            const int j = col[k];
            V rj = broadcast(0.0);
            for (; k < n_forms && col[k] == j; ++k)
                rj += vload(v.weight + k * v.stride + base) * w.gy[row[k]];
            scatter(rj, v.index + j * v.stride + base, n, r);
        }
        for (int m = 0; m < s.n_m; ++m) scatter(w.Phi[m], v.index + (s.n_x + m) * v.stride + base, n, r);
    }
}

// gc: derivative of the strain that the law's D refers to; gr: of the strain rate.
VISVIVA_INLINE void chain_gradients(const StrainView& v, const Step& step, const Work& w) {
    const ShapeView& s = v.shape;
    const double theta = term_theta(s, step);
    gradients(s, w.y1, true, w.g1);
    for (int k = 0; k < s.n_e * s.n_y; ++k)
        w.gc[k] =
            step.stress == Stress::discrete_gradient && !traits(s.law).is_at_theta ? w.g1[k] : theta * w.g[k];
    if (traits(s.law).needs_rate) {
        gradients(s, w.ydot, false, w.gr);
        for (int k = 0; k < s.n_e * s.n_y; ++k) w.gr[k] = theta * w.gr[k] + step.motion[0][0] * w.g[k];
    }
}

// d(stress_i)/dy_b of the material part, times nothing yet.
VISVIVA_INLINE V stress_gradient(const ShapeView& s, const Work& w, int i, int b) {
    V d = broadcast(0.0);
    for (int j = 0; j < s.n_e; ++j) {
        d += w.D[i * s.n_e + j] * w.gc[j * s.n_y + b];
        if (traits(s.law).needs_rate) d += w.R[i * s.n_e + j] * w.gr[j * s.n_y + b];
    }
    return d;
}

VISVIVA_INLINE bool has_material_part(LawKind k) {
    return k != LawKind::linear && k != LawKind::constraint && k != LawKind::servo && k != LawKind::load;
}

VISVIVA_INLINE void form_tangent(const StrainView& v, const Step& step, const Work& w) {
    const ShapeView& s = v.shape;
    const double theta = term_theta(s, step);
    for (int k = 0; k < s.n_y * s.n_y; ++k) w.ky[k] = broadcast(0.0);
    const int nq = s.n_quad;
    for (int k = 0; k < nq; ++k) {
        const int a = s.quad_a[k], b = s.quad_b[k];
        const V c = theta * s.quad_coef[k] * w.S[s.quad_e[k]];
        w.ky[a * s.n_y + b] += c;
        w.ky[b * s.n_y + a] += c;
    }
    if (!has_material_part(s.law)) return;
    chain_gradients(v, step, w);
    if (s.n_e == 1 && !traits(s.law).needs_rate) {  // symmetric to the last bit
        for (int b = 0; b < s.n_y; ++b)
            for (int a = 0; a < s.n_y; ++a) w.ky[a * s.n_y + b] += (w.g[a] * w.gc[b]) * w.D[0];
        return;
    }
    for (int i = 0; i < s.n_e; ++i)
        for (int b = 0; b < s.n_y; ++b) {
            const V d = stress_gradient(s, w, i, b);
            for (int a = 0; a < s.n_y; ++a) w.ky[a * s.n_y + b] += w.g[i * s.n_y + a] * d;
        }
}

VISVIVA_INLINE void add(V a, const StrainView& v, int slot, int base, int n, double* values) {
    const long* position =
        reinterpret_cast<const long*>(v.position) + static_cast<long>(slot) * v.stride + base;
    for (int l = 0; l < n; ++l) values[position[l]] += a[l];
}

VISVIVA_INLINE V law_derivative(const ShapeView& s, const V* matrix, int i, int m, bool column) {
    switch (s.law) {
        case LawKind::constraint:
            return broadcast(i == m ? 1.0 : 0.0);
        case LawKind::servo:
            return column ? broadcast(i == s.n_m + m ? -1.0 : 0.0) : broadcast(i == m ? 1.0 : 0.0);
        default:
            return column ? matrix[i * s.n_m + m] : matrix[m * s.n_e + i];
    }
}

void strain_tangent(const StrainView& v, const Step& step, const Vectors& x, const Signals& signals,
                    double* values) {
    const ShapeView& s = v.shape;
    Work w(s, v.scratch);
    for (int base = 0; base < v.n; base += W) {
        evaluate(v, step, x, signals, base, w);
        const int n = active(v, base);
        gradients(s, w.yt, true, w.g);
        if (v.n_products) form_tangent(v, step, w);
        for (int k = 0; k < v.n_products;) {
            const int slot = v.products[k].slot;
            V a = broadcast(0.0);
            for (; k < v.n_products && v.products[k].slot == slot; ++k) {
                const Product& p = v.products[k];
                const int* ab = v.pairs + 2 * p.pair;
                a += (vload(v.weight + p.k1 * v.stride + base) * vload(v.weight + p.k2 * v.stride + base)) *
                     w.ky[ab[0] * s.n_y + ab[1]];
            }
            add(a, v, slot, base, n, values);
        }
        if (!v.n_columns) continue;
        for (int k = 0; k < v.n_columns; ++k) {
            const Border& c = v.columns[k];
            add(vload(v.weight + c.k * v.stride + base) * law_derivative(s, w.Jt, c.e, c.m, true) *
                    w.g[c.e * s.n_y + c.a],
                v, c.slot, base, n, values);
        }
        gradients(s, w.y1, true, w.g1);
        for (int k = 0; k < v.n_rows; ++k) {
            const Border& c = v.rows[k];
            add(vload(v.weight + c.k * v.stride + base) * law_derivative(s, w.J, c.e, c.m, false) *
                    w.g1[c.e * s.n_y + c.a],
                v, c.slot, base, n, values);
        }
    }
}

// Largest violation of the multiplier rows of a group: at position level, and of their rates with velocity
// v1.
VISVIVA_INLINE void defects(const StrainView& v, const LawData& a, const Signals& signals, const double* v1,
                            const Work& w, V& defect, V& rate_defect) {
    const ShapeView& s = v.shape;
    defect = rate_defect = broadcast(0.0);
    forms(v, v1, a.base, false, w.ydot);
    strain_rates(s, w.y1, w.ydot, w.edot);
    const bool driven = s.law == LawKind::constraint || s.law == LawKind::servo;
    for (int m = 0; m < s.n_m; ++m) {
        defect = vmax(defect, vabs(w.Phi[m]));
        V rate = driven ? w.edot[m] - signal(a, signals.rate1, m, 0.0) : broadcast(0.0);
        for (int i = 0; !driven && i < s.n_e; ++i) rate += w.J[m * s.n_e + i] * w.edot[i];
        rate_defect = vmax(rate_defect, vabs(rate));
    }
}

void strain_ledger(const StrainView& v, const Step& step, const Vectors& x, const Signals& signals,
                   const double* v1, const StrainLedger& out) {
    const ShapeView& s = v.shape;
    Work w(s, v.scratch);
    Step booked = step;
    Vectors by = x;
    if (traits(s.law).is_viscous && step.remembers()) booked.theta = 0.5, by.rate = nullptr;
    for (int base = 0; base < v.n; base += W) {
        LawData a = evaluate(v, booked, by, signals, base, w);
        V work = broadcast(0.0), defect = work, rate_defect = work;
        form_forces(s, w.yt, w.S, w.gy);
        for (int b = 0; b < s.n_y; ++b) work -= w.gy[b] * (w.y1[b] - vload(v.y0 + b * v.stride + base));
        const V energy = law_energy(a);
        if (s.n_m) defects(v, a, signals, v1, w, defect, rate_defect);
        keep_ends(v, base, w);
        vstore(out.energy + base, energy);
        vstore(out.work + base, work);
        vstore(out.defect + base, defect);
        vstore(out.rate_defect + base, rate_defect);
    }
}

}  // namespace visviva::VISVIVA_ISA
