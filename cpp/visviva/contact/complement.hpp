// Motion of a few points without their common rigid motion: forces along it
// have neither resultant nor torque, so they can mend energy without touching the momenta.
#pragma once
#include <Eigen/Dense>
#include <vector>

namespace visviva {

/// Points with masses, as a rigid body.
struct Arms {
    Arms(const Eigen::VectorXd& x, const Eigen::VectorXd& w, int dim);
    Eigen::Vector3d mean(const Eigen::VectorXd& a) const;
    /// The derivative of inertia times w by the j-th point.
    Eigen::Matrix3d inertia_gradient(const Eigen::Vector3d& w, Eigen::Index j) const;
    Eigen::Vector3d arm(Eigen::Index j) const { return r.segment<3>(3 * j); }

    Eigen::Index k;
    Eigen::VectorXd mass, r;  // about the centre
    double total;
    Eigen::Matrix3d inverse;  // of the inertia
};

class Complement {
  public:
    /// Of the increments D about the positions x, both (3 k), with the masses w.
    Complement(const Eigen::VectorXd& x, const Eigen::VectorXd& D, const Eigen::VectorXd& w, int dim);
    /// D without its rigid part.
    const Eigen::VectorXd& motion() const { return e_; }
    /// The same times the masses: orthogonal to all rigid motions at x.
    Eigen::VectorXd momentum() const;
    /// Times D, which is positive.
    double size() const { return e_.dot(momentum()); }
    /// Sum of masses times squared arms.
    double spread() const;
    /// d(motion)/dD where the positions are x0 + theta D.
    Eigen::MatrixXd derivative(double theta) const;
    /// d(momentum)/dw
    Eigen::MatrixXd by_masses() const;
    /// d(size)/dw
    Eigen::VectorXd size_by_masses() const;

  private:
    Arms arms_;
    Eigen::VectorXd a_, e_;  // increments about their mean, the result
    Eigen::Vector3d w_;      // rotation
};

/// Forces f without resultant and torque: what the masses take as a rigid body is taken away, so their work
/// on D is that of f on the complement of D.
class Balanced {
  public:
    Balanced(const Eigen::VectorXd& x, const Eigen::VectorXd& f, const Eigen::VectorXd& w, int dim);
    const Eigen::VectorXd& force() const { return balanced_; }
    /// d(force)/dx at constant f
    Eigen::MatrixXd derivative() const;

  private:
    Arms arms_;
    Eigen::VectorXd f_, balanced_;
    Eigen::Vector3d sum_, w_;
};

}  // namespace visviva
