// What forces at points of a rigid body do against each other.
#pragma once
#include <Eigen/Dense>

namespace visviva {

/// The part without resultant and torque of forces of some sizes at places (3 x m) along directions (3 x m).
Eigen::VectorXd redundant_part(const Eigen::Matrix3Xd& places, const Eigen::Matrix3Xd& directions,
                               const Eigen::VectorXd& sizes);

}  // namespace visviva
