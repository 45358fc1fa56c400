#include <algorithm>
#include <cmath>

#include "visviva/linear/krylov/krylov.hpp"

namespace visviva {

void conjugate_gradients(KrylovRun& run) {
    const std::size_t n = run.r.size();
    Vector z(n), p(n), q(n);
    double rz = 0, rr = dot(run.r, run.r);
    while (std::sqrt(rr) > run.target && run.iterations < run.max_iterations) {
        run.preconditioning.apply(run.r.data(), z.data());
        const double rz1 = dot(run.r, z);
        if (!(rz1 > 0)) return void(run.trouble = "the preconditioner is not positive definite");
        const double beta = run.iterations == 0 ? 0 : rz1 / rz;
        rz = rz1;
        scale_add(beta, p, z);
        run.matrix.multiply(p.data(), q.data());
        const double pq = dot(p, q);
        if (!(pq > 0)) return void(run.trouble = "the tangent is not positive definite");
        add(rz / pq, p, run.x);
        rr = add_dot(-rz / pq, q, run.r, run.r);
        ++run.iterations;
    }
}

namespace {

// The small least-squares problem of GMRES, kept triangular by Givens' rotations.
struct Hessenberg {
    explicit Hessenberg(int m) : h(static_cast<std::size_t>(m) * (m + 1)), c(m), s(m), g(m + 1), m(m) {}
    double& at(int i, int j) { return h[static_cast<std::size_t>(j) * (m + 1) + i]; }

    void rotate(int j) {
        for (int i = 0; i < j; ++i) turn(i, at(i, j), at(i + 1, j));
        const double length = std::hypot(at(j, j), at(j + 1, j));
        c[j] = length > 0 ? at(j, j) / length : 1, s[j] = length > 0 ? at(j + 1, j) / length : 0;
        turn(j, at(j, j), at(j + 1, j));
        g[j + 1] = 0;
        turn(j, g[j], g[j + 1]);
    }
    void turn(int i, double& a, double& b) const {
        const double t = c[i] * a + s[i] * b;
        b = c[i] * b - s[i] * a, a = t;
    }
    bool solve(int k, Vector& y) {
        for (int i = k - 1; i >= 0; --i) {
            y[i] = g[i];
            for (int j = i + 1; j < k; ++j) y[i] -= at(i, j) * y[j];
            if (at(i, i) == 0) return false;
            y[i] /= at(i, i);
        }
        return true;
    }

    Vector h, c, s, g;
    int m;
};

}  // namespace

// Saad & Schultz 1986, modified Gram-Schmidt. One call makes one cycle; the caller restarts it.
void gmres(KrylovRun& run, int restart) {
    const std::size_t n = run.r.size();
    const int m = std::min(restart, run.max_iterations);
    auto& v = run.basis;
    auto room = [&](std::size_t k) -> Vector& {
        if (v.size() <= k) v.resize(k + 1);
        v[k].resize(n);
        return v[k];
    };
    room(0) = run.r;
    Hessenberg h(m);
    h.g[0] = norm(run.r);
    if (!(h.g[0] > 0)) return;
    scale(1 / h.g[0], v[0]);
    Vector z(n), y(m);
    int k = 0;
    while (k < m && std::abs(h.g[k]) > run.target) {
        run.preconditioning.apply(v[k].data(), z.data());
        Vector& w = room(k + 1);
        run.matrix.multiply(z.data(), w.data());
        h.at(0, k) = dot(w, v[0]);
        for (int i = 0; i < k; ++i) h.at(i + 1, k) = add_dot(-h.at(i, k), v[i], w, v[i + 1]);
        const double length = h.at(k + 1, k) = std::sqrt(add_dot(-h.at(k, k), v[k], w, w));
        if (!std::isfinite(length)) return void(run.trouble = "it met a number that is not finite");
        h.rotate(k++);
        if (length == 0) break;
        scale(1 / length, w);
    }
    run.iterations = k;
    if (!h.solve(k, y)) return void(run.trouble = "the tangent is singular");
    Vector sum(n);
    for (int i = 0; i < k; ++i) add(y[i], v[i], sum);
    run.preconditioning.apply(sum.data(), z.data());
    add(1, z, run.x);
}

// van der Vorst 1992.
void bicgstab(KrylovRun& run) {
    const std::size_t n = run.r.size();
    Vector &r = run.r, shadow = r, p(n), v(n), y(n), z(n), t(n);
    double rho = 1, alpha = 1, omega = 1;
    while (norm(r) > run.target && run.iterations < run.max_iterations) {
        const double rho1 = dot(shadow, r);
        if (rho1 == 0 || omega == 0 || !std::isfinite(rho1)) return void(run.trouble = "it broke down");
        const double beta = run.iterations == 0 ? 0 : rho1 / rho * (alpha / omega);
        rho = rho1;
        for (std::size_t i = 0; i < n; ++i) p[i] = r[i] + beta * (p[i] - omega * v[i]);
        run.preconditioning.apply(p.data(), y.data());
        run.matrix.multiply(y.data(), v.data());
        alpha = rho / dot(shadow, v);
        if (!std::isfinite(alpha)) return void(run.trouble = "it broke down");
        add(-alpha, v, r), add(alpha, y, run.x);
        run.preconditioning.apply(r.data(), z.data());
        run.matrix.multiply(z.data(), t.data());
        const double tt = dot(t, t);
        omega = tt > 0 ? dot(t, r) / tt : 0;
        add(omega, z, run.x), add(-omega, t, r);
        ++run.iterations;
    }
}

}  // namespace visviva
