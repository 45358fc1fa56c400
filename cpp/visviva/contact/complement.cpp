#include "visviva/contact/complement.hpp"

#include "visviva/contact/skew.hpp"

namespace visviva {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Eigen::Index;

Arms::Arms(const Eigen::VectorXd& x, const Eigen::VectorXd& w, int dim)
    : k(w.size()), mass(w), r(x), total(w.sum()) {
    const Vector3 centre = mean(x);
    Matrix3 inertia = Matrix3::Zero();
    for (Index i = 0; i < k; ++i) {
        r.segment<3>(3 * i) -= centre;
        inertia += mass[i] * (arm(i).squaredNorm() * Matrix3::Identity() - arm(i) * arm(i).transpose());
    }
    inverse.setZero();
    if (dim == 2)
        inverse(2, 2) = inertia(2, 2) > 0 ? 1 / inertia(2, 2) : 0;
    else
        inverse = inertia.inverse();
}

Vector3 Arms::mean(const Eigen::VectorXd& a) const {
    Vector3 sum = Vector3::Zero();
    for (Index i = 0; i < k; ++i) sum += mass[i] * a.segment<3>(3 * i);
    return sum / total;
}

Matrix3 Arms::inertia_gradient(const Vector3& w, Index j) const {
    const Vector3 r = arm(j);
    return mass[j] * (2 * w * r.transpose() - r.dot(w) * Matrix3::Identity() - r * w.transpose());
}

Complement::Complement(const Eigen::VectorXd& x, const Eigen::VectorXd& D, const Eigen::VectorXd& w, int dim)
    : arms_(x, w, dim), a_(D) {
    const Vector3 mean = arms_.mean(D);
    Vector3 spin = Vector3::Zero();
    for (Index i = 0; i < arms_.k; ++i) {
        a_.segment<3>(3 * i) -= mean;
        spin += w[i] * arms_.arm(i).cross(Vector3(a_.segment<3>(3 * i)));
    }
    w_ = arms_.inverse * spin;
    e_ = a_;
    for (Index i = 0; i < arms_.k; ++i) e_.segment<3>(3 * i) -= w_.cross(arms_.arm(i));
}

Eigen::VectorXd Complement::momentum() const {
    Eigen::VectorXd p = e_;
    for (Index i = 0; i < arms_.k; ++i) p.segment<3>(3 * i) *= arms_.mass[i];
    return p;
}

double Complement::spread() const {
    double sum = 0;
    for (Index i = 0; i < arms_.k; ++i) sum += arms_.mass[i] * arms_.arm(i).squaredNorm();
    return sum;
}

Eigen::MatrixXd Complement::derivative(double theta) const {
    const Index k = arms_.k;
    Eigen::MatrixXd turn(3, 3 * k), P(3 * k, 3 * k);
    for (Index j = 0; j < k; ++j) {
        const Vector3 a = a_.segment<3>(3 * j);
        const Matrix3 spin = arms_.mass[j] * (skew(arms_.arm(j)) - theta * skew(a));
        turn.middleCols<3>(3 * j) = arms_.inverse * (spin - theta * arms_.inertia_gradient(w_, j));
    }
    const Matrix3 own = Matrix3::Identity() - theta * skew(w_);
    for (Index i = 0; i < k; ++i) P.middleRows<3>(3 * i) = skew(arms_.arm(i)) * turn;
    for (Index j = 0; j < k; ++j) {
        const Matrix3 common = arms_.mass[j] / arms_.total * own;
        for (Index i = 0; i < k; ++i) P.block<3, 3>(3 * i, 3 * j) -= common;
        P.block<3, 3>(3 * j, 3 * j) += own;
    }
    return P;
}

Eigen::MatrixXd Complement::by_masses() const {
    const Index k = arms_.k;
    Eigen::MatrixXd P(3 * k, k);
    for (Index j = 0; j < k; ++j) {
        const Vector3 e = e_.segment<3>(3 * j), shift = e / arms_.total,
                      turn = arms_.inverse * arms_.arm(j).cross(e);
        for (Index i = 0; i < k; ++i)
            P.block<3, 1>(3 * i, j) = -arms_.mass[i] * (shift + turn.cross(arms_.arm(i)));
        P.block<3, 1>(3 * j, j) += e;
    }
    return P;
}

Eigen::VectorXd Complement::size_by_masses() const {
    return Eigen::Map<const Eigen::Matrix3Xd>(e_.data(), 3, arms_.k).colwise().squaredNorm();
}

Balanced::Balanced(const Eigen::VectorXd& x, const Eigen::VectorXd& f, const Eigen::VectorXd& w, int dim)
    : arms_(x, w, dim), f_(f), balanced_(f), sum_(Vector3::Zero()) {
    Vector3 torque = Vector3::Zero();
    for (Index i = 0; i < arms_.k; ++i) {
        sum_ += f.segment<3>(3 * i);
        torque += arms_.arm(i).cross(Vector3(f.segment<3>(3 * i)));
    }
    w_ = arms_.inverse * torque;
    for (Index i = 0; i < arms_.k; ++i)
        balanced_.segment<3>(3 * i) -= w[i] * (sum_ / arms_.total + w_.cross(arms_.arm(i)));
}

Eigen::MatrixXd Balanced::derivative() const {
    const Index k = arms_.k;
    Eigen::MatrixXd turn(3, 3 * k), P(3 * k, 3 * k);
    for (Index j = 0; j < k; ++j) {
        const Vector3 f = f_.segment<3>(3 * j) - arms_.mass[j] / arms_.total * sum_;
        turn.middleCols<3>(3 * j) = arms_.inverse * (-skew(f) - arms_.inertia_gradient(w_, j));
    }
    for (Index i = 0; i < k; ++i) P.middleRows<3>(3 * i) = arms_.mass[i] * skew(arms_.arm(i)) * turn;
    for (Index j = 0; j < k; ++j) {
        const Matrix3 common = arms_.mass[j] / arms_.total * skew(w_);
        for (Index i = 0; i < k; ++i) P.block<3, 3>(3 * i, 3 * j) += arms_.mass[i] * common;
        P.block<3, 3>(3 * j, 3 * j) -= arms_.mass[j] * skew(w_);
    }
    return P;
}

}  // namespace visviva
