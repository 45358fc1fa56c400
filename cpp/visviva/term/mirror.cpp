#include "visviva/term/mirror.hpp"

#include "visviva/term/pattern.hpp"

namespace visviva {

Mirror::Mirror(std::shared_ptr<Term> term)
    : term_(std::move(term)),
      can_(term_->capabilities()),
      is_seen_(can_.search || can_.memory || term_->sees_clock || term_->is_shown),
      none_(1, 0.0) {
    name = term_->name, is_lasting = term_->is_lasting;
    needs_rates = term_->needs_rates, sees_clock = term_->sees_clock;
}

TermCapabilities Mirror::capabilities() {
    return {nullptr, can_.search ? this : nullptr, can_.memory, can_.history, can_.limit};
}

void Mirror::connect(const Pattern& pattern) {
    if (!is_seen_) return;
    const Pattern nothing = pattern.without_equations();
    term_->connect(nothing);
    std::vector<char> cleared;
    if (can_.mesh) can_.mesh->clear_rows(nothing, cleared);
    r_.assign(pattern.n_unknowns() + 1, 0.0);
}

void Mirror::residual(const Context& c, double*) {
    if (is_seen_) term_->residual(c, r_.data());
}

void Mirror::tangent(const Context& c, double*) {
    if (is_seen_) term_->tangent(c, none_.data());
}

bool Mirror::update_tangent(const Context& c, double*) {
    return can_.search->update_tangent(c, none_.data());
}

// Accounts are as many as those of the others.
void Mirror::ledger(const Context& c, const double* v1, LedgerSums& sums) {
    if (!is_seen_) return;
    sums_ = sums;
    term_->ledger(c, v1, sums_);
}

void Mirror::begin(const double* x0) {
    if (is_seen_) term_->begin(x0);
}

void Mirror::accept(const Context& c) {
    if (is_seen_) term_->accept(c);
}

void Mirror::finish_step(const Step& step, double* x) {
    if (is_seen_) term_->finish_step(step, x);
}

}  // namespace visviva
