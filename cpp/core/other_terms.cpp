#include <algorithm>

#include "dispatch.hpp"
#include "term.hpp"

namespace visviva {

InertiaTerm::InertiaTerm(int order, int n_nodes, int dim, int n, std::vector<int> pair, const double* mass,
                         const int* index, std::vector<char> is_position)
    : pair_(std::move(pair)), is_position_(std::move(is_position)) {
    is_inertia = order == 2;
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

std::int64_t InertiaTerm::n_entries() const {
    return static_cast<std::int64_t>(view_.n_pairs) * view_.dim * view_.n;
}

void InertiaTerm::pattern(std::vector<std::pair<int, int>>& entries) const {
    for (int p = 0; p < view_.n_pairs; ++p)
        for (int c = 0; c < view_.dim; ++c)
            for (int e = 0; e < view_.n; ++e) {
                const int a = pair_[2 * p] * view_.dim + c, b = pair_[2 * p + 1] * view_.dim + c;
                entries.push_back({index_[static_cast<std::size_t>(a) * view_.stride + e],
                                   index_[static_cast<std::size_t>(b) * view_.stride + e]});
            }
}

void InertiaTerm::set_positions(const std::int64_t* positions) {
    const int rows = view_.n_pairs * view_.dim, stride = view_.stride;
    position_.resize(static_cast<std::size_t>(rows) * stride);
    for (int k = 0; k < rows; ++k)
        for (int e = 0; e < stride; ++e)
            position_[static_cast<std::size_t>(k) * stride + e] =
                positions[k * view_.n + std::min(e, view_.n - 1)];
    view_.position = position_.data();
}

void InertiaTerm::residual(const Context& c, double* r) { kernels().inertia_residual(view_, c.vectors, r); }

void InertiaTerm::tangent(const Context& c, double* values) {
    kernels().inertia_tangent(view_, c.step, values);
}

void InertiaTerm::ledger(const Context& c, const double* v1, LedgerSums& sums) {
    if (view_.order != 2) return;
    const int stride = view_.stride;
    kernels().inertia_ledger(view_, c.vectors.x1, v1, {out_.data(), out_.data() + stride});
    for (int e = 0; e < view_.n; ++e) {
        sums.energy[account[e]] += out_[e];
        double* momentum = &sums.momentum[6 * static_cast<std::size_t>(component[e])];
        for (int k = 0; k < 6; ++k) momentum[k] += out_[static_cast<std::size_t>(k + 1) * stride + e];
    }
}

CallbackTerm::CallbackTerm(int n, int n_local, const int* index, Function residual, Function tangent,
                           Function ledger, Function accept)
    : n_(n),
      nl_(n_local),
      index_(index, index + static_cast<std::size_t>(n) * n_local),
      residual_(std::move(residual)),
      tangent_(std::move(tangent)),
      ledger_(std::move(ledger)),
      accept_(std::move(accept)) {
    const std::size_t size = index_.size();
    for (auto* a : {&x0_, &x1_, &rate_, &second_rate_, &v1_, &v0_, &r_}) a->assign(size, 0.0);
    k_.assign(size * n_local, 0.0);
    energy_.assign(n, 0.0), work_.assign(n, 0.0), momentum_.assign(6 * static_cast<std::size_t>(n), 0.0);
}

void CallbackTerm::pattern(std::vector<std::pair<int, int>>& entries) const {
    for (int e = 0; e < n_; ++e)
        for (int i = 0; i < nl_; ++i)
            for (int j = 0; j < nl_; ++j) entries.push_back({index_[e * nl_ + i], index_[e * nl_ + j]});
}

void CallbackTerm::set_positions(const std::int64_t* positions) {
    position_.assign(positions, positions + n_entries());
}

TermArguments CallbackTerm::gather(const Context& c) {
    const Vectors& v = c.vectors;
    for (std::size_t k = 0; k < index_.size(); ++k) {
        x0_[k] = v.x0[index_[k]], x1_[k] = v.x1[index_[k]];
        rate_[k] = v.rate[index_[k]], second_rate_[k] = v.second_rate[index_[k]];
        v0_[k] = v.v0[index_[k]];
    }
    return {&c.step,   x0_.data(),     x1_.data(),   rate_.data(),     second_rate_.data(), r_.data(),
            k_.data(), energy_.data(), work_.data(), momentum_.data(), v1_.data(),          v0_.data()};
}

void CallbackTerm::residual(const Context& c, double* r) {
    residual_(gather(c));
    for (std::size_t k = 0; k < index_.size(); ++k) r[index_[k]] += r_[k];
}

void CallbackTerm::tangent(const Context& c, double* values) {
    tangent_(gather(c));
    for (std::size_t k = 0; k < k_.size(); ++k) values[position_[k]] += k_[k];
}

void CallbackTerm::ledger(const Context& c, const double* v1, LedgerSums& sums) {
    if (!ledger_) return;
    for (std::size_t k = 0; k < index_.size(); ++k) v1_[k] = v1[index_[k]];
    std::fill(energy_.begin(), energy_.end(), 0.0);
    std::fill(work_.begin(), work_.end(), 0.0);
    std::fill(momentum_.begin(), momentum_.end(), 0.0);
    ledger_(gather(c));
    for (int e = 0; e < n_; ++e) {
        sums.energy[account[e]] += energy_[e];
        if (work_account >= 0) sums.work[work_account] += work_[e];
        double* momentum = &sums.momentum[6 * static_cast<std::size_t>(component[e])];
        for (int k = 0; k < 6; ++k) momentum[k] += momentum_[6 * static_cast<std::size_t>(e) + k];
    }
}

void CallbackTerm::accept(const Context& c) {
    if (accept_) accept_(gather(c));
}

}  // namespace visviva
