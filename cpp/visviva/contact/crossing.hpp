// Where two straight stretches come nearest, with the derivatives of that.
#pragma once
#include <Eigen/Dense>

namespace visviva {

/// The stretches from a to b and from c to d, each of which may be a single point.
struct Stretches {
    Eigen::Vector3d a, b, c, d;

    Eigen::Vector3d first(double s) const { return a + s * (b - a); }
    Eigen::Vector3d second(double t) const { return c + t * (d - c); }
};

/// The place x(s) on the first stretch and y(t) on the second that make
///     g^2 = |x(s) - y(t)|^2 + k |x(s) - a|^2
/// least: for stretches that cross the point where they do, for parallel ones s = 0, and all between without
/// a jump, as g^2 is a convex function of both. `distance` is g, `apart` the first of its parts.
struct Crossing {
    static constexpr double k = 0.02;
    double place[2] = {0, 0};  // s and t
    bool free[2] = {false, false};
    double distance = HUGE_VAL, apart = HUGE_VAL;
};

Crossing cross(const Stretches&);

/// Derivatives by a, b, c, d, three numbers each: of g, of s and t, and of the unit vector from y to x.
struct CrossingDerivatives {
    Eigen::Matrix<double, 12, 1> gradient;
    Eigen::Matrix<double, 12, 12> hessian;
    Eigen::Matrix<double, 2, 12> places;
    Eigen::Vector3d normal;
    Eigen::Matrix<double, 3, 12> normals;
    double apart = 0;
    Eigen::Matrix<double, 12, 1> aparts;
};

CrossingDerivatives differentiate(const Stretches&, const Crossing&);

}  // namespace visviva
