// The search for neighbours, for as long as surfaces stay where it has swept.
#pragma once
#include <vector>

#include "visviva/contact/gaps.hpp"

namespace visviva {

class SweptSearch {
  public:
    explicit SweptSearch(double reach) : reach_(reach) {}
    double reach() const { return reach_; }

    /// Whether a configuration has left what was swept by so much that it is time for another search.
    bool is_due(const std::vector<double>& X) const;
    /// Looks for neighbours between two configurations and a few steps ahead, so that the tangent's pattern
    /// lasts; true if gaps have others than before.
    bool find_neighbours(Gaps& gaps, const std::vector<double>& X0, const std::vector<double>& X1);
    /// A vertex so far out of what was swept that its neighbours are not known; -1: none.
    int lost(const std::vector<double>& X) const;

    void write(std::vector<double>& memory) const;
    /// True if gaps have other neighbours than before.
    bool read(const double*& memory, Gaps& gaps);

  private:
    int beyond(const std::vector<double>& X, double margin) const;

    double reach_;
    std::vector<double> from_, to_;  // what was swept; empty: nothing yet
};

}  // namespace visviva
