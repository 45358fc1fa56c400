// Forces of multipliers on what they hold, by which Newton's method judges increments of multipliers.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "visviva/linear/csr.hpp"

namespace visviva {

/// Multipliers have units of all kinds, and redundant ones no value of their own: what counts is the force
/// that all of them together put on a coordinate. Times the coordinate's scale it compares with others, and
/// is large beside the largest of those that balance each other in the step: of the multipliers, and of the
/// tangent's diagonal times the increment of the step, which is inertia in time and stiffness in statics.
class MultiplierForces {
  public:
    /// Adds over processes, each of which knows a part of the tangent, and all the same coordinates.
    using Total = std::function<void(std::vector<double>&)>;

    /// Adds one at each unknown that is_judged[unknown] multipliers act on.
    static void mark(const Csr&, const std::vector<char>& is_judged, std::vector<double>& acted_on);
    /// The same for all processes: acted_on[unknown], and 1 / scale of coordinates, zero for what is none.
    void analyze(const Csr&, const std::vector<char>& is_judged, const std::vector<double>& acted_on,
                 const std::vector<double>& inverse_scale);

    /// The largest force by such values or increments of the multipliers, with the values of the tangent.
    double largest(const double* values, const double* multipliers, const Total&);

    struct Size {
        double balanced = 0;  // the largest that balance each other
        double stiffest = 0;  // force by which a coordinate would be displaced by its scale
    };
    /// Of the forces at the unknowns x1 that the step has reached by increments dx.
    Size sizes(const double* values, const double* x1, const double* dx, const Total&);

  private:
    struct Row {  // of a coordinate
        int unknown;
        double scale;
        std::int64_t diagonal = -1;  // where it has none here
        std::size_t end = 0;         // of its entries
    };
    struct Entry {
        std::int64_t place;
        int multiplier;
    };
    std::vector<Row> rows_;
    std::vector<Entry> entries_;
    std::vector<double> sums_;  // by row
};

}  // namespace visviva
