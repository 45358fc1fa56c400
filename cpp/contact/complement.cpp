#include "complement.hpp"

#include "skew.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

Eigen::VectorXd about_mean(const Eigen::VectorXd& x, int k) {
    Vector3 mean = Vector3::Zero();
    for (int i = 0; i < k; ++i) mean += x.segment<3>(3 * i) / k;
    Eigen::VectorXd r = x;
    for (int i = 0; i < k; ++i) r.segment<3>(3 * i) -= mean;
    return r;
}

}  // namespace

Complement::Complement(const Eigen::VectorXd& x, const Eigen::VectorXd& D, int dim)
    : k_(static_cast<int>(x.size() / 3)), r_(about_mean(x, k_)), a_(about_mean(D, k_)) {
    Matrix3 inertia = Matrix3::Zero();
    Vector3 spin = Vector3::Zero();
    for (int i = 0; i < k_; ++i) {
        const Vector3 r = r_.segment<3>(3 * i), a = a_.segment<3>(3 * i);
        inertia += r.squaredNorm() * Matrix3::Identity() - r * r.transpose();
        spin += r.cross(a);
    }
    inverse_.setZero();
    if (dim == 2)
        inverse_(2, 2) = inertia(2, 2) > 0 ? 1 / inertia(2, 2) : 0;
    else
        inverse_ = inertia.inverse();
    w_ = inverse_ * spin;
    p_ = a_;
    for (int i = 0; i < k_; ++i) p_.segment<3>(3 * i) -= w_.cross(Vector3(r_.segment<3>(3 * i)));
}

Eigen::MatrixXd Complement::derivative(double theta) const {
    Eigen::MatrixXd turn(3, 3 * k_), P(3 * k_, 3 * k_);
    for (int j = 0; j < k_; ++j) {
        const Vector3 r = r_.segment<3>(3 * j), a = a_.segment<3>(3 * j);
        const Matrix3 spin = skew(r) - theta * skew(a);
        const Matrix3 inertia = 2 * w_ * r.transpose() - r.dot(w_) * Matrix3::Identity() - r * w_.transpose();
        turn.middleCols<3>(3 * j) = inverse_ * (spin - theta * inertia);
    }
    const Matrix3 own = Matrix3::Identity() - theta * skew(w_);
    for (int i = 0; i < k_; ++i) P.middleRows<3>(3 * i) = skew(Vector3(r_.segment<3>(3 * i))) * turn;
    for (int i = 0; i < k_; ++i)
        for (int j = 0; j < k_; ++j) P.block<3, 3>(3 * i, 3 * j) += ((i == j ? 1.0 : 0.0) - 1.0 / k_) * own;
    return P;
}

}  // namespace visviva
