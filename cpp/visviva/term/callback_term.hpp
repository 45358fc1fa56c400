// Terms that are written outside the core.
#pragma once
#include <functional>

#include "visviva/term/entry_term.hpp"

namespace visviva {

// A whole term from outside: dense local tangents, element-slowest arrays [n][n_local].
struct TermArguments {
    const Step* step;
    const double *x0, *x1, *rate, *second_rate;  // gathered, [n][n_local]
    double *residual, *tangent;                  // [n][n_local], [n][n_local][n_local] or null
    double *energy, *work, *momentum;            // [n], [n], [n][6], for the ledger
    const double* v1;                            // ledger only
    const double* v0;                            // rates at the start of the step
};

class CallbackTerm : public EntryTerm {
  public:
    using Function = std::function<void(const TermArguments&)>;
    CallbackTerm(int n, int n_local, const int* index, Function residual, Function tangent, Function ledger,
                 Function accept);
    /// Called with all unknowns where a step begins, and where it has ended; null: nobody asks.
    std::function<void(const double*)> look;
    int work_account = -1;  // where work is booked that is done beside what is stored; -1: none

    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;
    void accept(const Context&) override;
    void begin(const double* x0) override {
        if (look) look(x0);
    }
    void finish_step(const Step&, double* x) override { begin(x); }

  private:
    void list_entries(std::vector<std::pair<int, int>>& entries) const override;
    void set_positions(const std::vector<std::int64_t>& positions) override;
    TermArguments gather(const Context&);
    int n_, nl_;
    std::vector<int> index_;
    Function residual_, tangent_, ledger_, accept_;
    std::vector<double> x0_, x1_, rate_, second_rate_, v1_, v0_, r_, k_, energy_, work_, momentum_;
    std::vector<std::int64_t> position_;
};

}  // namespace visviva
