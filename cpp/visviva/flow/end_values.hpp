// Unknowns that a scheme finds where it evaluates forces, in the middle of a step, at the step's end.
#pragma once
#include <vector>

#include "visviva/term/step.hpp"

namespace visviva {

// Values of the end by the smaller of the last two slopes, none where these differ in sign: of second order
// from the third step on, and neither what swings from step to step nor the shock of a sudden start is
// carried on.
class EndValues {
  public:
    explicit EndValues(std::vector<int> unknowns);

    void settle(const Step& step, double* x);
    void write(std::vector<double>& memory) const;
    void read(const double*& memory);

  private:
    std::vector<int> unknown_;
    std::vector<double> middle_, slope_;  // of the last step, and that towards it
    double h_ = 0;                        // of the last step
    int known_ = 0;                       // how many of middle and slope
};

}  // namespace visviva
