// Coulomb friction at a gap: the relative displacement over a step of what touches there, the forces that do
// its work and have neither resultant nor torque, and the traction.
#pragma once
#include <Eigen/Dense>

#include "visviva/contact/complement.hpp"
#include "visviva/contact/gaps.hpp"

namespace visviva {

/// A traction in the tangent plane within the limit of Coulomb, and its derivatives.
struct Traction {
    Eigen::Vector2d value = Eigen::Vector2d::Zero(), by_limit = Eigen::Vector2d::Zero();
    Eigen::Matrix2d by_trial = Eigen::Matrix2d::Zero();
    bool slips = false;
};

/// The traction nearest to a trial one that is no larger than `limit`.
Traction coulomb(const Eigen::Vector2d& trial, double limit);

/// The displacement g = q . P D of a gap's stencil from increments D about the positions x = x0 + theta D,
/// with the grip's weights times tangents q and without the rigid motion of the vertices that have `masses`
/// (P); and forces P^T q t, whose work is t . g.
class Sliding {
  public:
    Sliding(const Grip& grip, const Eigen::VectorXd& x, const Eigen::VectorXd& D,
            const Eigen::VectorXd& masses, int dim);
    Eigen::Vector2d displacement() const { return q_.transpose() * relative_.motion(); }
    Eigen::VectorXd force(const Eigen::Vector2d& traction) const;
    /// P^T q
    Eigen::MatrixXd directions() const;
    /// dg/dD and, at constant traction, d(force)/dD
    Eigen::MatrixXd displacement_gradient(double theta) const;
    Eigen::MatrixXd force_gradient(const Eigen::Vector2d& traction, double theta) const;

  private:
    const Grip& grip_;
    Eigen::VectorXd x_, masses_;
    int dim_;
    Complement relative_;
    Eigen::MatrixXd q_;
};

}  // namespace visviva
