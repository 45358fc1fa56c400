// Extrapolates the motion of the last steps, so that Newton starts close and factorisations last.
#pragma once
#include <vector>

#include "linear.hpp"
#include "step.hpp"

namespace visviva {

// Remembers up to three increments of equal step length: of every unknown, and as Cayley rotations of rigid
// bodies, whose directors are predicted by turning them.
class Predictor {
  public:
    void resize(int n_unknowns, std::vector<RigidUnknowns> rigid);
    void forget() { known_ = 0; }
    // Increments of motion unknowns [begin, end) in dx, from the rates v where nothing is remembered yet.
    void predict(int begin, int end, double h, const double* v, double* dx) const;
    // The same for multipliers, which change faster: one order less, and nothing known means no change.
    void predict_multipliers(int begin, int end, double h, double* dx) const;
    void predict_rotations(double h, const double* x, const double* v, double* dx) const;
    void record(const double* x0, const double* dx, double h);

    void write(std::vector<double>& memory) const;
    const double* read(const double* memory);

  private:
    int usable(double h) const { return h == h_ ? known_ : 0; }
    std::vector<RigidUnknowns> rigid_;
    std::vector<double> dx_[3], turn_[3];  // the last first
    int known_ = 0;
    double h_ = 0;
};

}  // namespace visviva
