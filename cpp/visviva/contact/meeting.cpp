#include "visviva/contact/meeting.hpp"

#include "visviva/contact/skew.hpp"

namespace visviva {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

void Meeting::set_normal(double sign) {
    sign_ = sign, cross_ = sign * e_.cross(f_);
    const double size = cross_.norm(), lengths = e_.norm() * f_.norm();
    if (size == 0 || lengths == 0) return;
    sine = size / lengths, normal = cross_ / size;
}

Meeting Meeting::of_lines(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d,
                          double sign) {
    Meeting m;
    m.e_ = b - a, m.f_ = d - c, m.by_e_ << -1, 1, 0, 0, m.by_f_ << 0, 0, -1, 1;
    m.set_normal(sign);
    if (m.sine == 0) return m;
    const Vector3 w = c - a, across = sign * m.cross_ / m.cross_.squaredNorm();
    const double s = w.cross(m.f_).dot(across), t = w.cross(m.e_).dot(across);
    m.shares << 1 - s, s, t - 1, -t;
    m.distance = -m.normal.dot(w);
    return m;
}

Meeting Meeting::of_plane(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
    Meeting m;
    m.e_ = b - a, m.f_ = c - a, m.by_e_ << -1, 1, 0, 0, m.by_f_ << -1, 0, 1, 0;
    m.set_normal(-1);
    if (m.sine == 0) return m;
    const Vector3 w = d - a, across = -m.cross_ / m.cross_.squaredNorm();
    const double s = w.cross(m.f_).dot(across), t = m.e_.cross(w).dot(across);
    m.shares << 1 - s - t, s, t, -1;
    m.distance = -m.normal.dot(w);
    return m;
}

Meeting::Row Meeting::gradient() const {
    Row g;
    for (int v = 0; v < 4; ++v) g.segment<3>(3 * v) = shares[v] * normal.transpose();
    return g;
}

// The normal n stays across both directions e and f. Shares s and t of these make up for what is across n in
// the change of x - y = g n: e ds + f dt = g dn + n dg - (d(x - y) at fixed shares), which products with
// f x n and e x n solve. Between lines t counts the other way, which its column of shares says.
Meeting::Derivatives Meeting::derivatives() const {
    Derivatives out;
    const Matrix3 across = (Matrix3::Identity() - normal * normal.transpose()) * (sign_ / cross_.norm()),
                  turn_e = -across * skew(f_), turn_f = across * skew(e_);
    Eigen::Matrix<double, 3, 12> rest;
    for (int v = 0; v < 4; ++v) {
        out.normal.middleCols<3>(3 * v) = by_e_[v] * turn_e + by_f_[v] * turn_f;
        rest.middleCols<3>(3 * v) = -shares[v] * Matrix3::Identity();
    }
    rest += distance * out.normal;
    const Vector3 first = f_.cross(normal), second = e_.cross(normal);
    const Row ds = first.transpose() * rest / first.dot(e_), dt = second.transpose() * rest / second.dot(f_);
    out.shares = by_e_ * ds + by_f_ * dt;
    for (int v = 0; v < 4; ++v)
        out.hessian.middleRows<3>(3 * v) = shares[v] * out.normal + normal * out.shares.row(v);
    return out;
}

}  // namespace visviva
