// What is left of the motion of a few points when their common rigid motion is taken away: forces along it
// have neither resultant nor torque, so they can mend energy without touching the momenta.
#pragma once
#include <Eigen/Dense>
#include <vector>

namespace visviva {

class Complement {
  public:
    /// Of the increments D about the positions x, both (3 k).
    Complement(const Eigen::VectorXd& x, const Eigen::VectorXd& D, int dim);
    /// D without its rigid part: orthogonal to all rigid motions at x.
    const Eigen::VectorXd& motion() const { return p_; }
    /// dp/dD where the positions are x0 + theta D.
    Eigen::MatrixXd derivative(double theta) const;

  private:
    int k_;
    Eigen::VectorXd r_, a_, p_;  // arms, increments about their mean, the result
    Eigen::Vector3d w_;          // rotation
    Eigen::Matrix3d inverse_;    // of the inertia of unit masses
};

}  // namespace visviva
