#include "visviva/contact/redundancy.hpp"

#include <cmath>

namespace visviva {

Eigen::VectorXd redundant_part(const Eigen::Matrix3Xd& places, const Eigen::Matrix3Xd& directions,
                               const Eigen::VectorXd& sizes) {
    constexpr double aligned = 1e-6;  // what turns points on a line about it turns nothing
    const Eigen::Vector3d centre = places.rowwise().mean();
    const Eigen::Matrix3Xd arms = places.colwise() - centre;
    const double length = std::sqrt(arms.colwise().squaredNorm().mean());
    Eigen::MatrixXd motions(sizes.size(), 6);  // along the directions, of the rigid motions
    for (Eigen::Index i = 0; i < sizes.size(); ++i) {
        motions.row(i).head<3>() = directions.col(i);
        motions.row(i).tail<3>().setZero();
        if (length > 0) motions.row(i).tail<3>() = arms.col(i).cross(directions.col(i)) / length;
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> rigid;
    rigid.setThreshold(aligned);
    rigid.compute(motions);
    return sizes - motions * rigid.solve(sizes);
}

}  // namespace visviva
