#include "visviva/contact/line_pair.hpp"

#include "visviva/contact/skew.hpp"

namespace visviva {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

LinePair::LinePair(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d, double sign)
    : e(b - a), f(d - c), cross_(sign * e.cross(f)) {
    const double size = cross_.norm(), lengths = e.norm() * f.norm();
    if (size == 0 || lengths == 0) return;
    sine = size / lengths, normal = cross_ / size;
    const Vector3 w = c - a, m = sign * cross_;
    place[0] = w.cross(f).dot(m) / (size * size), place[1] = w.cross(e).dot(m) / (size * size);
    distance = -normal.dot(w);
}

LinePair::Row LinePair::gradient() const {
    Row g;
    for (int v = 0; v < 4; ++v) g.segment<3>(3 * v) = shares()[v] * normal.transpose();
    return g;
}

// The normal stays across both lines. From x - y = g n follows e ds - f dt = g dn + n dg - (dx - dy at fixed
// s and t), which products with f x n and e x n solve.
LinePair::Derivatives LinePair::derivatives() const {
    Derivatives out;
    const double size = cross_.norm();
    const double sign = cross_.dot(e.cross(f)) > 0 ? 1 : -1;
    const Matrix3 across = (Matrix3::Identity() - normal * normal.transpose()) * (sign / size),
                  by_e = -across * skew(f), by_f = across * skew(e);
    out.normal << -by_e, by_e, -by_f, by_f;
    const Eigen::Vector4d share = shares();
    Eigen::Matrix<double, 3, 12> rest = distance * out.normal;
    for (int v = 0; v < 4; ++v) rest.middleCols<3>(3 * v) -= share[v] * Matrix3::Identity();
    const Vector3 first = f.cross(normal), second = e.cross(normal);
    out.place[0] = first.transpose() * rest / first.dot(e);
    out.place[1] = -second.transpose() * rest / second.dot(f);
    const Row ds = out.place[0], dt = out.place[1], change[4] = {-ds, ds, dt, -dt};
    for (int v = 0; v < 4; ++v) out.hessian.middleRows<3>(3 * v) = share[v] * out.normal + normal * change[v];
    return out;
}

}  // namespace visviva
