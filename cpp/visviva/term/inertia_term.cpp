#include "visviva/term/inertia_term.hpp"

#include <algorithm>

#include "visviva/term/inertia_dispatch.hpp"

namespace visviva {

InertiaTerm::InertiaTerm(int order, int n_nodes, int dim, int n, std::vector<int> pair, const double* mass,
                         const int* index, std::vector<char> is_position)
    : pair_(std::move(pair)), is_position_(std::move(is_position)) {
    is_inertia = order == 2, needs_rates = order == 1;
    const int stride = (n + 7) / 8 * 8, n_pairs = static_cast<int>(pair_.size() / 2);
    auto padded = [&](auto& to, const auto* from, int rows) {
        to.resize(static_cast<std::size_t>(rows) * stride);
        for (int k = 0; k < rows; ++k)
            for (int e = 0; e < stride; ++e)
                to[static_cast<std::size_t>(k) * stride + e] = from[k * n + std::min(e, n - 1)];
    };
    padded(mass_, mass, n_pairs);
    padded(index_, index, n_nodes * dim);
    out_.assign(static_cast<std::size_t>(7) * stride, 0.0);
    InertiaView& v = view_;
    v.n = n, v.stride = stride, v.n_nodes = n_nodes, v.dim = dim, v.n_pairs = n_pairs, v.order = order;
    v.pair = pair_.data(), v.mass = mass_.data(), v.index = index_.data(),
    v.is_position = is_position_.data();
}

void InertiaTerm::list_entries(std::vector<std::pair<int, int>>& entries) const {
    for (int p = 0; p < view_.n_pairs; ++p)
        for (int c = 0; c < view_.dim; ++c)
            for (int e = 0; e < view_.n; ++e) {
                const int a = pair_[2 * p] * view_.dim + c, b = pair_[2 * p + 1] * view_.dim + c;
                entries.push_back({index_[static_cast<std::size_t>(a) * view_.stride + e],
                                   index_[static_cast<std::size_t>(b) * view_.stride + e]});
            }
}

void InertiaTerm::set_positions(const std::vector<std::int64_t>& positions) {
    const int rows = view_.n_pairs * view_.dim, stride = view_.stride;
    position_.resize(static_cast<std::size_t>(rows) * stride);
    for (int k = 0; k < rows; ++k)
        for (int e = 0; e < stride; ++e)
            position_[static_cast<std::size_t>(k) * stride + e] =
                positions[k * view_.n + std::min(e, view_.n - 1)];
    view_.position = position_.data();
}

void InertiaTerm::residual(const Context& c, double* r) { inertia_kernels().residual(view_, c.vectors, r); }

void InertiaTerm::tangent(const Context& c, double* values) {
    inertia_kernels().tangent(view_, c.step, values);
}

void InertiaTerm::ledger(const Context& c, const double* v1, LedgerSums& sums) {
    if (view_.order != 2) return;
    const int stride = view_.stride;
    inertia_kernels().ledger(view_, c.vectors.x1, v1, {out_.data(), out_.data() + stride});
    for (int e = 0; e < view_.n; ++e) {
        sums.energy[account[e]] += out_[e];
        double* momentum = &sums.momentum[6 * static_cast<std::size_t>(component[e])];
        for (int k = 0; k < 6; ++k) momentum[k] += out_[static_cast<std::size_t>(k + 1) * stride + e];
    }
}

}  // namespace visviva
