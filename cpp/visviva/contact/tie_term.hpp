// Mesh tying: constant linear homogeneous constraints, vector by vector, sum of weight * x = 0 for every row.
#pragma once
#include "visviva/term/entry_term.hpp"

namespace visviva {

/// Row k: entries first[k] to first[k + 1] of the first unknowns of vectors and their weights, and the
/// multipliers of its `dim` components, -1 for components that are left out.
struct TieRows {
    int dim = 3;
    std::vector<int> first, unknown, multiplier;
    std::vector<double> weight;
    int n() const { return static_cast<int>(first.size()) - 1; }
};

class TieTerm : public EntryTerm {
  public:
    explicit TieTerm(TieRows rows) : rows_(std::move(rows)), x0_(rows_.multiplier.size(), 0.0) {}

    void begin(const double* x0) override;
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;

  private:
    void list_entries(std::vector<std::pair<int, int>>& entries) const override;
    void set_positions(const std::vector<std::int64_t>& positions) override;
    /// f(row's component, its multiplier, first entry, behind the last, which component)
    template <class F>
    void each(F f) const;
    double value(const double* x, int begin, int end, int i) const;

    TieRows rows_;
    std::vector<double> x0_;  // values of the constraints at the start of the step
    std::vector<std::int64_t> position_;
};

}  // namespace visviva
