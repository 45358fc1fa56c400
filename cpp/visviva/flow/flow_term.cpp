#include "visviva/flow/flow_term.hpp"

#include <stdexcept>

namespace visviva {

namespace {

bool has_kernels(int dim, int nodes, int pressures) {
#define VISVIVA_HAS(D, N, P) \
    if (dim == D && nodes == N && pressures == P) return true;
    VISVIVA_FLOW_PAIRS(VISVIVA_HAS)
#undef VISVIVA_HAS
    return false;
}

}  // namespace

FlowTerm::FlowTerm(const FlowData& d)
    : TermMemory("flow", 1),
      slots_(d.index, d.n, d.n_nodes + d.n_pressures, d.n_nodes == d.n_pressures ? 2 * d.n_nodes : d.n_nodes),
      pressures_(d.pressures),
      N_(d.N, d.N + d.n_points * d.n_nodes),
      M_(d.M, d.M + d.n_points * d.n_pressures) {
    if (!has_kernels(d.dim, d.n_nodes, d.n_pressures) || (d.n_nodes == d.n_pressures && !d.metric))
        throw std::invalid_argument("there are no fluid elements with these nodes and pressures");
    needs_rates = true;
    const std::int64_t nq = d.n_points;
    in_lanes(G_, d.gradients, nq * d.n_nodes * d.dim, d.n);
    in_lanes(w_, d.volume, nq, d.n);
    in_lanes(X_, d.positions, d.n_nodes * d.dim, d.n);
    in_lanes(metric_, d.metric, nq * (d.dim * (d.dim + 1) / 2 + 1), d.n);
    FlowView& f = view_;
    f.n = d.n, f.n_blocks = slots_.n_blocks(), f.dim = d.dim, f.n_nodes = d.n_nodes,
    f.n_pressures = d.n_pressures, f.n_points = d.n_points, f.rho = d.density, f.mu = d.viscosity,
    f.convection = d.convects ? 1 : 0;
    f.index = slots_.index(), f.N = N_.data(), f.M = M_.data(), f.G = G_.data(), f.w = w_.data(),
    f.X = X_.data(), f.metric = metric_.data();
    out_.assign(static_cast<std::size_t>(flow_ledger_rows) * f.n_blocks * slot_lanes, 0.0);
}

void FlowTerm::connect(const Pattern& pattern) {
    slots_.connect(pattern);
    view_.row = slots_.row(), view_.length = slots_.length(), view_.offset = slots_.offset();
}

// The metric is in lanes: eight elements beside each other, block by block.
void FlowTerm::scale_metric(const double* factor) {
    if (given_metric_.empty()) given_metric_ = metric_;
    const std::size_t rows = metric_.size() / (static_cast<std::size_t>(view_.n_blocks) * slot_lanes);
    for (int e = 0; e < view_.n; ++e) {
        std::size_t at = e / slot_lanes * rows * slot_lanes + e % slot_lanes;
        for (std::size_t k = 0; k < rows; ++k, at += slot_lanes) metric_[at] = factor[e] * given_metric_[at];
    }
}

void FlowTerm::blind(const double* directions) {
    in_lanes(blind_, directions, view_.dim, view_.n);
    view_.blind = blind_.data();
}

void FlowTerm::update_force(double t) {
    if (!load_ || t == force_time_) return;
    const std::int64_t rows = view_.n_points * view_.dim;
    given_.resize(rows * view_.n);
    load_(t, given_.data());
    in_lanes(force_, given_.data(), rows, view_.n);
    view_.force = force_.data(), force_time_ = t;
}

void FlowTerm::residual(const Context& c, double* r) {
    update_force(c.step.te);
    slots_.for_tasks(
        [&](int begin, int end) { flow_kernels().residual(view_, c.step, c.vectors, begin, end, r); });
}

void FlowTerm::tangent(const Context& c, double* values) {
    update_force(c.step.te);
    slots_.assemble(values, [&](int begin, int end) {
        flow_kernels().tangent(view_, c.step, c.vectors, begin, end, values);
    });
}

void FlowTerm::rows(const Context& c, double* total) {
    update_force(c.step.te);
    slots_.for_tasks([&](int begin, int end) {
        flow_kernels().ledger(view_, c.step, c.vectors, begin, end, out_.data());
    });
    const std::size_t stride = static_cast<std::size_t>(view_.n_blocks) * slot_lanes;
    for (int k = 0; k < flow_ledger_rows; ++k) {
        total[k] = 0;
        for (int e = 0; e < view_.n; ++e) total[k] += out_[k * stride + e];
    }
}

void FlowTerm::ledger(const Context& c, const double*, LedgerSums& sums) {
    double total[flow_ledger_rows], before[flow_ledger_rows];
    rows(c, total);
    sums.energy[kinetic_account] += total[0];
    for (int k = 0; k < 3; ++k)
        if (work_account[k] >= 0) sums.work[work_account[k]] += c.step.h * total[1 + k];
    for (int k = 0; k < 6; ++k) sums.momentum[6 * static_cast<std::size_t>(owner) + k] += total[4 + k];
    // From one steady flow to the next no power accounts for the kinetic energy.
    if (c.step.flow[0][0] == 0 && c.step.h != 0) {
        rows({c.step, {c.vectors.x0, c.vectors.x0, c.vectors.rate, c.vectors.second_rate}, c.signals},
             before);
        sums.work[work_account[3]] += total[0] - before[0];
    }
}

}  // namespace visviva
