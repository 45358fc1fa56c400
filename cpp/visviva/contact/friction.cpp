#include "visviva/contact/friction.hpp"

namespace visviva {

using Vector2 = Eigen::Vector2d;
using Matrix = Eigen::MatrixXd;

Traction coulomb(const Vector2& trial, double limit) {
    const double size = trial.norm();
    Traction t;
    t.slips = size > limit;
    if (!t.slips) {
        t.value = trial, t.by_trial.setIdentity();
        return t;
    }
    t.by_limit = trial / size;
    t.value = limit * t.by_limit;
    t.by_trial = limit / size * (Eigen::Matrix2d::Identity() - t.by_limit * t.by_limit.transpose());
    return t;
}

Sliding::Sliding(const Grip& grip, const Eigen::VectorXd& x, const Eigen::VectorXd& D,
                 const Eigen::VectorXd& masses, int dim)
    : grip_(grip), x_(x), masses_(masses), dim_(dim), relative_(x, D, masses, dim), q_(x.size(), 2) {
    for (Eigen::Index v = 0; v < grip.weight.size(); ++v)
        q_.middleRows<3>(3 * v) = grip.weight[v] * grip.tangent;
}

Eigen::VectorXd Sliding::force(const Vector2& traction) const {
    return Balanced(x_, q_ * traction, masses_, dim_).force();
}

Matrix Sliding::directions() const {
    Matrix d(q_.rows(), 2);
    for (int i = 0; i < 2; ++i) d.col(i) = force(Vector2::Unit(i));
    return d;
}

Matrix Sliding::displacement_gradient(double theta) const {
    const Eigen::Index k = grip_.weight.size();
    const Eigen::Map<const Eigen::Matrix3Xd> p(relative_.motion().data(), 3, k);
    const Eigen::Vector3d sum = p * grip_.weight;
    Matrix g = q_.transpose() * relative_.derivative(theta);
    for (int i = 0; i < 2; ++i)
        g.row(i) += theta * (grip_.tangent.col(i).transpose() * p * grip_.weight_gradient +
                             sum.transpose() * grip_.tangent_gradient[i]);
    return g;
}

Matrix Sliding::force_gradient(const Vector2& traction, double theta) const {
    const Eigen::Vector3d t = grip_.tangent * traction;
    const Matrix turn = traction[0] * grip_.tangent_gradient[0] + traction[1] * grip_.tangent_gradient[1];
    Matrix dq(q_.rows(), q_.rows());
    for (Eigen::Index v = 0; v < grip_.weight.size(); ++v)
        dq.middleRows<3>(3 * v) = t * grip_.weight_gradient.row(v) + grip_.weight[v] * turn;
    Matrix balanced = Balanced(x_, q_ * traction, masses_, dim_).derivative();
    for (Eigen::Index i = 0; i < dq.cols(); ++i)
        balanced.col(i) += Balanced(x_, dq.col(i), masses_, dim_).force();
    return theta * balanced;
}

}  // namespace visviva
