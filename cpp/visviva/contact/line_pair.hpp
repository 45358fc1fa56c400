// The signed distance of two straight lines that are not parallel, with its derivatives.
#pragma once
#include <Eigen/Dense>

namespace visviva {

/// Lines through a and b, and through c and d. The distance is n . (x - y) with the places x = a + s (b - a)
/// and y = c + t (d - c) that are nearest, and the unit normal n, along (b - a) x (d - c) or, with sign -1,
/// against it.
struct LinePair {
    Eigen::Vector3d e, f, normal;
    double place[2];  // s and t
    double distance = 0;
    double sine = 0;  // of the angle between the lines; 0: parallel, and nothing else is known

    LinePair(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
             const Eigen::Vector3d& d, double sign);

    // By a, b, c, d, three numbers each.
    using Row = Eigen::Matrix<double, 1, 12>;
    /// Shares of a, b, c, d in x - y.
    Eigen::Vector4d shares() const { return {1 - place[0], place[0], place[1] - 1, -place[1]}; }
    Row gradient() const;
    struct Derivatives {
        Eigen::Matrix<double, 3, 12> normal;
        Row place[2];
        Eigen::Matrix<double, 12, 12> hessian;  // of the distance
    };
    Derivatives derivatives() const;

  private:
    Eigen::Vector3d cross_;  // e x f times the sign
};

}  // namespace visviva
