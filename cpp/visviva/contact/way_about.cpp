#include "visviva/contact/way_about.hpp"

#include <cmath>

#include "visviva/contact/skew.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using At = Eigen::Map<const Vector3>;

}  // namespace

// A rotation by phi about n changes arms by 2 tan(phi / 2) n times their mean: the momentum of the change
// about the mean arms says which it is.
RigidMotion::RigidMotion(const double* X0, const double* X1, const std::vector<int>& vertices,
                         const std::vector<double>& weights) {
    double total = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        from += weights[i] * At(X0 + 3 * vertices[i]), to += weights[i] * At(X1 + 3 * vertices[i]);
        total += weights[i];
    }
    from /= total, to /= total;
    Matrix3 inertia = Matrix3::Zero();
    Vector3 spin = Vector3::Zero();
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vector3 before = At(X0 + 3 * vertices[i]) - from, after = At(X1 + 3 * vertices[i]) - to;
        const Vector3 arm = 0.5 * (before + after);
        inertia += weights[i] * (arm.squaredNorm() * Matrix3::Identity() - arm * arm.transpose());
        spin += weights[i] * arm.cross(Vector3(after - before));
    }
    constexpr double same = 1e-12;  // relative: points at one place do not turn
    if (inertia.trace() <= total * (from.squaredNorm() + to.squaredNorm()) * same * same) return;
    Eigen::CompleteOrthogonalDecomposition<Matrix3> decomposed;
    decomposed.setThreshold(same);
    const Vector3 tangents = decomposed.compute(inertia).solve(spin);
    if (const double size = tangents.norm(); size > 0)
        turn = Eigen::AngleAxisd(2 * std::atan(0.5 * size), tangents / size).toRotationMatrix();
}

EvenWay::EvenWay(const Matrix3& turn) {
    const Eigen::AngleAxisd rotation(turn);
    axis_ = rotation.axis(), angle_ = rotation.angle();
    first_ = mean(1).inverse();
}

// Of exp(s angle axis) for s from 0 to t.
Matrix3 EvenWay::mean(double t) const {
    const double phi = t * angle_;
    const Matrix3 n = skew(axis_);
    if (std::abs(phi) < 1e-8) return Matrix3::Identity() + 0.5 * phi * n;
    return Matrix3::Identity() + (1 - std::cos(phi)) / phi * n + (1 - std::sin(phi) / phi) * n * n;
}

}  // namespace visviva
