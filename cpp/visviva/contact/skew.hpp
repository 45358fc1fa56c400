// The matrix of the cross product.
#pragma once
#include <Eigen/Core>

namespace visviva {

inline Eigen::Matrix3d skew(const Eigen::Vector3d& w) {
    Eigen::Matrix3d m;
    m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
    return m;
}

}  // namespace visviva
