#include "visviva/flow/open_term.hpp"

#include <cmath>

namespace visviva {

// At a point of a face: velocity, its gradient, the traction, and what leaves (v . n times the area), and the
// part of it that carries kinetic energy.
struct OpenTerm::Point {
    const double *N, *G, *n;
    double area, v[3], L[9], t[3], leaving, carried;

    // Force on the fluid per shape function, taken off: outflow, viscosity and, apart, the traction
    double through(int i, double rho, double mu, int dim) const {
        double sum = 0.5 * rho * carried * v[i];
        for (int j = 0; j < dim; ++j) sum -= mu * L[j * dim + i] * n[j];
        return sum;
    }
};

OpenTerm::OpenTerm(const OpenData& d)
    : n_(d.n),
      nodes_(d.n_nodes),
      points_(d.n_points),
      dim_(d.dim),
      rho_(d.density),
      mu_(d.viscosity),
      directional_(d.directional) {
    const auto points = static_cast<std::size_t>(d.n) * d.n_points;
    index_.assign(d.index, d.index + static_cast<std::size_t>(d.n) * d.n_nodes);
    N_.assign(d.N, d.N + points * d.n_nodes), G_.assign(d.G, d.G + points * d.n_nodes * d.dim);
    normal_.assign(d.normal, d.normal + points * d.dim), traction_.assign(points * d.dim, 0.0);
}

void OpenTerm::couple(Pattern& pattern) const {
    for (int f = 0; f < n_; ++f)
        for (int a = 0; a < nodes_; ++a)
            for (int b = 0; b < nodes_; ++b) pattern.couple(index_[f * nodes_ + a], index_[f * nodes_ + b]);
}

void OpenTerm::connect(const Pattern& pattern) {
    start_.clear(), length_.clear();
    for (int f = 0; f < n_; ++f)
        for (int a = 0; a < nodes_; ++a)
            for (int b = 0; b < nodes_; ++b) {
                const int row = index_[f * nodes_ + a];
                start_.push_back(pattern.position(row, index_[f * nodes_ + b]));
                length_.push_back(pattern.row_length(row));
            }
}

void OpenTerm::update_load(double t) {
    if (!load_ || t == load_time_) return;
    load_(t, traction_.data());
    load_time_ = t;
}

OpenTerm::Point OpenTerm::at(const Context& c, int face, int point) const {
    const std::size_t k = static_cast<std::size_t>(face) * points_ + point;
    Point p{&N_[k * nodes_], &G_[k * nodes_ * dim_], &normal_[k * dim_], 0, {}, {}, {}, 0, 0};
    for (int a = 0; a < nodes_; ++a)
        for (int i = 0; i < dim_; ++i) {
            const int u = index_[face * nodes_ + a] + i;
            const double v = c.vectors.x0[u] + c.step.theta * (c.vectors.x1[u] - c.vectors.x0[u]);
            p.v[i] += p.N[a] * v;
            for (int j = 0; j < dim_; ++j) p.L[i * dim_ + j] += v * p.G[a * dim_ + j];
        }
    for (int i = 0; i < dim_; ++i) p.area += p.n[i] * p.n[i], p.leaving += p.v[i] * p.n[i];
    p.area = std::sqrt(p.area), p.carried = directional_ && p.leaving < 0 ? 0 : p.leaving;
    for (int i = 0; i < dim_; ++i) p.t[i] = p.area * traction_[k * dim_ + i];
    return p;
}

template <class F>
void OpenTerm::each_point(F f) const {
    for (int face = 0; face < n_; ++face)
        for (int point = 0; point < points_; ++point) f(face, point);
}

void OpenTerm::residual(const Context& c, double* r) {
    update_load(c.step.te);
    each_point([&](int face, int point) {
        const Point p = at(c, face, point);
        for (int i = 0; i < dim_; ++i) {
            const double force = p.through(i, rho_, mu_, dim_) - p.t[i];
            for (int a = 0; a < nodes_; ++a) r[index_[face * nodes_ + a] + i] += force * p.N[a];
        }
    });
}

void OpenTerm::tangent(const Context& c, double* values) {
    const double theta = c.step.theta;
    each_point([&](int face, int point) {
        const Point p = at(c, face, point);
        const double open = directional_ && p.leaving < 0 ? 0 : 0.5 * rho_ * theta;
        for (int a = 0; a < nodes_; ++a)
            for (int b = 0; b < nodes_; ++b) {
                const std::size_t k = (static_cast<std::size_t>(face) * nodes_ + a) * nodes_ + b;
                if (start_[k] < 0) continue;
                double* to = values + start_[k];
                for (int i = 0; i < dim_; ++i)
                    for (int j = 0; j < dim_; ++j) {
                        double d = open * p.N[b] * (p.n[j] * p.v[i] + (i == j ? p.leaving : 0.0));
                        d -= theta * mu_ * p.G[b * dim_ + i] * p.n[j];
                        to[i * length_[k] + j] += p.N[a] * d;
                    }
            }
    });
}

void OpenTerm::ledger(const Context& c, const double*, LedgerSums& sums) {
    update_load(c.step.te);
    double load = 0, flow = 0;
    each_point([&](int face, int point) {
        const Point p = at(c, face, point);
        for (int i = 0; i < dim_; ++i) {
            load += p.t[i] * p.v[i];
            flow -= p.through(i, rho_, mu_, dim_) * p.v[i];
        }
    });
    sums.work[load_account] += c.step.h * load;
    sums.work[flow_account] += c.step.h * flow;
}

}  // namespace visviva
