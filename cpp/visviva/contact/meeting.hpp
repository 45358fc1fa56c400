// The signed distances of two straight lines that are not parallel, and of a place and a plane, with their
// derivatives.
#pragma once
#include <Eigen/Dense>

namespace visviva {

/// Of four points the two places x and y that their shares make, the sum of shares times points being x - y,
/// and the distance n . (x - y) along a unit normal.
struct Meeting {
    Eigen::Vector3d normal;
    Eigen::Vector4d shares;
    double distance = 0;
    double sine = 0;  // of the angle between both directions; 0: parallel, and nothing else is known

    /// Of the lines through a and b, and through c and d: n is along (b - a) x (d - c) or, with sign -1,
    /// against it, and x and y are nearest to each other.
    static Meeting of_lines(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                            const Eigen::Vector3d& d, double sign);
    /// Of the plane through a, b and c, and of d: n is against (b - a) x (c - a), and x the foot of y = d.
    static Meeting of_plane(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                            const Eigen::Vector3d& d);

    // By the four points, three numbers each.
    using Row = Eigen::Matrix<double, 1, 12>;
    Row gradient() const;
    struct Derivatives {
        Eigen::Matrix<double, 3, 12> normal;
        Eigen::Matrix<double, 4, 12> shares;
        Eigen::Matrix<double, 12, 12> hessian;  // of the distance
    };
    Derivatives derivatives() const;

  private:
    void set_normal(double sign);
    // Directions that the normal is across, their product times its sign, and how the directions and the
    // shares change with the points and the two coordinates of x - y.
    Eigen::Vector3d e_, f_, cross_;
    double sign_ = 1;
    Eigen::Vector4d by_e_, by_f_;
};

}  // namespace visviva
