#include "visviva/contact/crossing.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Both parts of g as one vector, whose length it is.
Vector6 both(const Stretches& m, double s, double t) {
    Vector6 W;
    W << m.first(s) - m.second(t), std::sqrt(Crossing::k) * (m.first(s) - m.a);
    return W;
}

Crossing at(const Stretches& m, double s, double t) {
    Crossing c;
    const double places[2] = {s, t};
    const bool point[2] = {m.a == m.b, m.c == m.d};
    for (int i = 0; i < 2; ++i) {
        c.place[i] = point[i] ? 0 : std::clamp(places[i], 0.0, 1.0);
        c.free[i] = !point[i] && places[i] > 0 && places[i] < 1;
    }
    const Vector6 W = both(m, c.place[0], c.place[1]);
    c.distance = W.norm(), c.apart = W.head<3>().norm();
    return c;
}

// On the second stretch, nearest to a point of the first.
double second_place(const Stretches& m, double s) {
    const Vector3 f = m.d - m.c;
    return f.dot(m.first(s) - m.c) / f.squaredNorm();
}

double first_place(const Stretches& m, double t) {
    const Vector3 e = m.b - m.a;
    return e.dot(m.second(t) - m.a) / ((1 + Crossing::k) * e.squaredNorm());
}

}  // namespace

Crossing cross(const Stretches& m) {
    const Vector3 e = m.b - m.a, f = m.d - m.c, w = m.a - m.c;
    const double ee = (1 + Crossing::k) * e.squaredNorm(), ef = e.dot(f), ff = f.squaredNorm();
    const double determinant = ee * ff - ef * ef;
    if (determinant > 0) {
        const Crossing inner = at(m, (ef * f.dot(w) - ff * e.dot(w)) / determinant,
                                  (ee * f.dot(w) - ef * e.dot(w)) / determinant);
        if (inner.free[0] && inner.free[1]) return inner;
    }
    Crossing best;
    auto take = [&](const Crossing& other) {
        if (other.distance < best.distance) best = other;
    };
    for (const double end : {0.0, 1.0}) {
        take(at(m, end, ff > 0 ? second_place(m, end) : 0));
        take(at(m, ee > 0 ? first_place(m, end) : 0, end));
    }
    return best;
}

// With W = (x - y, sqrt(k) (x - a)), which is linear in the places q = (s, t) and in the positions each:
// Z its derivative by the positions, T by those of s and t that are free, where T . W = 0. Then, as for the
// distance of a point from a facet, with S_j = T_j . Z + W . dT_j and M = T . T:
//     dq = -M^-1 S,  1/2 d(g^2) = W . Z,  1/2 d2(g^2) = Z . Z - S . M^-1 S.
CrossingDerivatives differentiate(const Stretches& m, const Crossing& c) {
    const double s = c.place[0], t = c.place[1], root = std::sqrt(Crossing::k);
    const Vector6 W = both(m, s, t);
    const Matrix3 one = Matrix3::Identity();
    Eigen::Matrix<double, 6, 12> Z;
    Z << (1 - s) * one, s * one, (t - 1) * one, -t * one,  //
        -root * s * one, root * s * one, Matrix3::Zero(), Matrix3::Zero();
    Eigen::Matrix<double, 6, 2> T;
    T << m.b - m.a, m.c - m.d, root * (m.b - m.a), Vector3::Zero();
    Eigen::Matrix<double, 2, 12> S = T.transpose() * Z;
    const Vector3 w = W.head<3>(), along = w + root * W.tail<3>();
    S.block<1, 3>(0, 0) -= along.transpose(), S.block<1, 3>(0, 3) += along.transpose();
    S.block<1, 3>(1, 6) += w.transpose(), S.block<1, 3>(1, 9) -= w.transpose();
    Eigen::Matrix2d M = T.transpose() * T;
    for (int i = 0; i < 2; ++i)
        if (!c.free[i]) M.row(i).setZero(), M.col(i).setZero(), M(i, i) = 1, S.row(i).setZero();
    CrossingDerivatives out;
    out.places = -M.inverse() * S;
    out.gradient = Z.transpose() * W / c.distance;
    out.hessian = (Z.transpose() * Z + S.transpose() * out.places - out.gradient * out.gradient.transpose()) /
                  c.distance;
    out.apart = c.apart, out.normal = w / c.apart;
    const Eigen::Matrix<double, 3, 12> dw = Z.topRows<3>() + T.topRows<3>() * out.places;
    out.aparts = dw.transpose() * out.normal;
    out.normals = (dw - out.normal * out.aparts.transpose()) / c.apart;
    return out;
}

}  // namespace visviva
