#include "visviva/term/callback_term.hpp"

#include <algorithm>

namespace visviva {

CallbackTerm::CallbackTerm(int n, int n_local, const int* index, Function residual, Function tangent,
                           Function ledger, Function accept)
    : n_(n),
      nl_(n_local),
      index_(index, index + static_cast<std::size_t>(n) * n_local),
      residual_(std::move(residual)),
      tangent_(std::move(tangent)),
      ledger_(std::move(ledger)),
      accept_(std::move(accept)) {
    needs_rates = sees_clock = true;
    const std::size_t size = index_.size();
    for (auto* a : {&x0_, &x1_, &rate_, &second_rate_, &v1_, &v0_, &r_}) a->assign(size, 0.0);
    k_.assign(size * n_local, 0.0);
    energy_.assign(n, 0.0), work_.assign(n, 0.0), momentum_.assign(6 * static_cast<std::size_t>(n), 0.0);
}

void CallbackTerm::list_entries(std::vector<std::pair<int, int>>& entries) const {
    for (int e = 0; e < n_; ++e)
        for (int i = 0; i < nl_; ++i)
            for (int j = 0; j < nl_; ++j) entries.push_back({index_[e * nl_ + i], index_[e * nl_ + j]});
}

void CallbackTerm::set_positions(const std::vector<std::int64_t>& positions) { position_ = positions; }

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
