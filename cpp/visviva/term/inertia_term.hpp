// Constant masses and capacities.
#pragma once
#include "visviva/base/aligned.hpp"
#include "visviva/term/entry_term.hpp"
#include "visviva/term/inertia.hpp"

namespace visviva {

class InertiaTerm : public EntryTerm {
  public:
    InertiaTerm(int order, int n_nodes, int dim, int n, std::vector<int> pair, const double* mass,
                const int* index, std::vector<char> is_position);
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;

  private:
    void list_entries(std::vector<std::pair<int, int>>& entries) const override;
    void set_positions(const std::vector<std::int64_t>& positions) override;
    InertiaView view_;
    std::vector<int> pair_, index_;
    std::vector<char> is_position_;
    Aligned<double> mass_, out_;
    Aligned<std::int64_t> position_;
};

}  // namespace visviva
