// Extrapolates the motion of the last steps, so that Newton starts close and factorisations last.
#pragma once
#include <vector>

#include "visviva/linear/linear.hpp"

namespace visviva {

// The last of some numbers that come step by step, with its backward differences. The next is extrapolated by
// the rule that would have predicted the last one best: polynomials through few or many values, and the same
// beside a part that changes its sign from step to step, as multipliers and what spreads have it under
// midpoint rules. Of what spreads alone, without motion, it may be nothing.
class Extrapolation {
  public:
    // The weight of each number in the choice of the rule.
    void resize(std::vector<double> weight, bool spreads = false);
    void forget() { known_ = order_ = 0, alternates_ = false; }
    bool knows() const { return known_ > 0; }
    void push(const double* x);
    void next(double* x) const;
    double largest() const;  // of the last, by weight

    std::size_t written() const { return 3 + most * weight_.size(); }
    void write(std::vector<double>& memory) const;
    const double* read(const double* memory);

  private:
    static constexpr int most = 7;
    std::vector<double> weight_, difference_[most];  // made when they are first known
    int known_ = 0, order_ = 0;  // how many differences are known, and how many are added up
    bool alternates_ = false;    // the one after these is subtracted
    bool spreads_ = false;
};

// Remembers increments of equal step length: of coordinates, of multipliers, and as Cayley rotations of rigid
// bodies, whose directors are predicted by turning them.
class Predictor {
  public:
    // Unknowns to be predicted (directors of rigid bodies apart) and the coordinates' weights; whether they
    // spread, and nothing moves.
    void resize(std::vector<int> coordinates, std::vector<double> weight, bool spread,
                std::vector<int> multipliers, std::vector<RigidUnknowns> rigid);
    void forget() { motion_.forget(), multiplier_.forget(), turn_.forget(); }
    // The increment of a step of length h from x with the rates v. Nothing known: coordinates go on with
    // their rates, multipliers keep their values. Where nothing `moves` rigid bodies turn on alone. Nothing
    // else in dx is changed.
    void predict(double h, const double* x, const double* v, bool moves, double* dx);
    void predict_multipliers(double h, double* dx);
    void record(const double* x0, const double* dx, double h);
    // The largest increment of the last step of this length, by weight.
    double largest(double h) const { return h == h_ && motion_.knows() ? motion_.largest() : 0; }

    void write(std::vector<double>& memory) const;
    const double* read(const double* memory);

  private:
    void predict_rotations(double h, const double* x, const double* v, double* dx);
    void record_rotations(const double* x0, const double* dx);

    std::vector<int> coordinates_, multipliers_;
    std::vector<RigidUnknowns> rigid_;
    Extrapolation motion_, multiplier_, turn_;
    std::vector<double> work_;
    double h_ = 0;
};

}  // namespace visviva
