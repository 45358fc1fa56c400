// A term that another process adds: here it is evaluated along, so that it decides and remembers the same.
#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "visviva/term/term.hpp"

namespace visviva {

// Of terms that know no more than vectors nothing is evaluated.
class Mirror : public Term, public NeighbourSearch {
  public:
    explicit Mirror(std::shared_ptr<Term> term);

    TermCapabilities capabilities() override;
    void couple(Pattern&) const override {}
    void connect(const Pattern& pattern) override;
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;
    void begin(const double* x0) override;
    Refusal refuse(const Context& c) override { return is_seen_ ? term_->refuse(c) : Refusal{}; }
    void accept(const Context& c) override;
    void finish_step(const Step& step, double* x) override;

    bool find_neighbours(const Way& way) override { return can_.search->find_neighbours(way); }
    bool is_outdated() const override { return can_.search->is_outdated(); }
    bool update_tangent(const Context&, double* values) override;
    double resolution() const override { return can_.search->resolution(); }

  private:
    std::shared_ptr<Term> term_;
    TermCapabilities can_;
    bool is_seen_;                  // whether anything decides by more than the unknowns, or is shown
    std::vector<double> r_, none_;  // what is left to the other process; its tangent has no equations here
    LedgerSums sums_;
};

}  // namespace visviva
