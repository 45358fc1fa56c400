// What processes that share the terms of a system evaluate together. A process alone has nothing to do here.
#include <algorithm>
#include <exception>
#include <string>

#include "visviva/system/system.hpp"

namespace visviva {

static std::string what_of(const std::exception_ptr& failure) {
    if (!failure) return {};
    try {
        std::rethrow_exception(failure);
    } catch (const std::exception& error) {
        return error.what();
    }
}

// Sums over processes what each has evaluated [n + 1], or gives up if one of them could not.
void System::add_up(std::span<double> values, const std::exception_ptr& failure) {
    if (!processes_) return failure ? std::rethrow_exception(failure) : void();
    values[n_] = failure ? 1 : 0;
    processes_->sum(values.data(), static_cast<std::size_t>(n_) + 1);
    agree(failure, values[n_] > 0);
    values[n_] = 0;
}

// Fails if any of them has failed, for the same reason.
void System::agree(const std::exception_ptr& failure, bool any) const {
    if (!any) return;
    std::string why = what_of(failure);
    int none = -1;
    if (processes_) processes_->tell(why, none);
    if (failure) std::rethrow_exception(failure);
    throw FailedElsewhere(why);
}

// All refuse what one refuses.
void System::agree(Refusal& no) const {
    if (any(!no.reason.empty()) && processes_) processes_->tell(no.reason, no.unknown);
}

// Anew with every pattern.
void System::meet() {
    if (processes_) own_ = processes_->own(csr_.unknown, n_);
    needs_rates_ = any(needs_rates_);  // sums of all read them everywhere
    searches_ = any(std::any_of(terms_.begin(), terms_.end(), [](const Part& p) { return p.can.search; }));
}

bool System::any(bool here) const { return processes_ ? processes_->any(here) : here; }

double System::largest(double here) const { return processes_ ? processes_->largest(here) : here; }

// Of what each has of the same numbers.
void System::total(std::vector<double>& parts) const {
    if (processes_ && !parts.empty()) processes_->sum(parts.data(), parts.size());
}

// What fails in one process fails in all: they go on to the same next thing.
bool System::factor_by(LinearSolver& solver, const Step& step) {
    return !any(!solver.factor(values_.data(), place(step)));
}

// Solves K d = -r for the residual r_, all of which every process knows.
bool System::solve_for(LinearSolver& solver, const Step& step, double tolerance) {
    if (!processes_) return solver.solve(r_.data(), place(step), d_.data(), tolerance);
    Unknowns part = r_;
    for (int u = 0; u < n_; ++u)
        if (!is_own(u)) part[u] = 0;
    return share(solver.solve(part.data(), place(step), d_.data(), tolerance));
}

// All get the solution of those who have the equations.
bool System::share(bool solved) {
    if (any(!solved)) return false;
    if (processes_) processes_->share(d_.data(), static_cast<std::size_t>(n_));
    return true;
}

// The ledger's sums of a step, of the terms of all.
void System::add_up(LedgerSums& s, const std::exception_ptr& failure) {
    if (!processes_) return failure ? std::rethrow_exception(failure) : void();
    std::vector<double> all{failure ? 1.0 : 0.0};
    const auto parts = {&s.energy, &s.work, &s.momentum, &s.defect, &s.release, &s.entropy};
    for (const auto* part : parts) all.insert(all.end(), part->begin(), part->end());
    processes_->sum(all.data(), all.size());
    agree(failure, all[0] > 0);
    auto from = all.begin() + 1;
    for (auto* part : parts) {
        std::copy_n(from, part->size(), part->begin());
        from += static_cast<std::ptrdiff_t>(part->size());
    }
}

}  // namespace visviva
