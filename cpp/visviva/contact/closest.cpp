#include "visviva/contact/closest.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

Vector3 place(const FacetShape& facet, const Foot& foot) {
    Vector3 y = Vector3::Zero();
    for (int i = 0; i < foot.n; ++i) y += foot.coordinate[i] * facet.corner[foot.vertex[i]];
    return y;
}

// z, u and the tangents of the derivatives below.
struct Variations {
    Eigen::MatrixXd z, u, T;
};

Variations variations(const FacetShape& facet, const Foot& foot, const Vector3& normal) {
    const int size = 3 * (1 + facet.n), m = foot.n - 1;
    Variations v{Eigen::MatrixXd::Zero(3, size), Eigen::MatrixXd::Zero(m, size), Eigen::MatrixXd(3, m)};
    v.z.leftCols<3>().setIdentity();
    for (int c = 0; c < facet.n; ++c) {
        const double first = facet.share(foot.vertex[0], c);
        for (int i = 0; i < foot.n; ++i) {
            const double share = facet.share(foot.vertex[i], c);
            v.z.middleCols<3>(3 + 3 * c) -= foot.coordinate[i] * share * Matrix3::Identity();
            if (i > 0) v.u.block<1, 3>(i - 1, 3 + 3 * c) = (share - first) * normal.transpose();
        }
    }
    for (int j = 0; j < m; ++j) v.T.col(j) = facet.corner[foot.vertex[j + 1]] - facet.corner[foot.vertex[0]];
    return v;
}

}  // namespace

Foot on_edge(const FacetShape& facet, int simplex, int a, int b, const Vector3& x) {
    const Vector3 e = facet.corner[b] - facet.corner[a];
    const double t = e.dot(x - facet.corner[a]), length = e.squaredNorm();
    Foot foot{simplex, 1, {t > 0 ? b : a}, {1}};
    if (t > 0 && t < length) foot = {simplex, 2, {a, b}, {1 - t / length, t / length}};
    foot.distance = (x - place(facet, foot)).norm();
    return foot;
}

Vector3 FacetShape::normal(int simplex) const {
    const Vector3& a = corner[vertex(simplex, 0)];
    const Vector3 e = corner[vertex(simplex, 1)] - a;
    const Vector3 m = dim == 2 ? e.cross(Vector3::UnitZ()) : e.cross(corner[vertex(simplex, 2)] - a);
    const double size = m.norm();
    return size > 0 ? Vector3(m / size) : Vector3::Zero();
}

Vector3 FacetShape::middle(int simplex) const {
    Vector3 sum = Vector3::Zero();
    for (int i = 0; i < dim; ++i) sum += corner[vertex(simplex, i)] / dim;
    return sum;
}

Vector3 FacetShape::place(const Foot& foot) const {
    Vector3 sum = Vector3::Zero();
    for (int i = 0; i < foot.n; ++i) sum += foot.coordinate[i] * corner[foot.vertex[i]];
    return sum;
}

bool lean_together(const FacetShape& facet, int simplex, const FacetShape& other, int its, double part) {
    return facet.height(simplex, other.middle(its)) > part * facet.size() &&
           other.height(its, facet.middle(simplex)) > part * other.size();
}

Foot whole(const FacetShape& facet, int simplex, const Vector3& x) {
    Foot foot{simplex, facet.dim};
    for (int i = 0; i < facet.dim; ++i) foot.vertex[i] = facet.vertex(simplex, i);
    const Vector3 &a = facet.corner[foot.vertex[0]], u = facet.corner[foot.vertex[1]] - a, d = x - a;
    if (facet.dim == 2) {
        foot.coordinate[1] = u.dot(d) / u.squaredNorm();
    } else {
        const Vector3 w = facet.corner[foot.vertex[2]] - a;
        const double uu = u.dot(u), uw = u.dot(w), ww = w.dot(w), ud = u.dot(d), wd = w.dot(d);
        const double det = uu * ww - uw * uw;
        foot.coordinate[1] = (ww * ud - uw * wd) / det, foot.coordinate[2] = (uu * wd - uw * ud) / det;
    }
    foot.coordinate[0] = 1 - foot.coordinate[1] - foot.coordinate[2];
    foot.distance = (x - place(facet, foot)).norm();
    return foot;
}

Foot closest(const FacetShape& facet, int simplex, const Vector3& x) {
    Foot best = whole(facet, simplex, x);
    if (std::all_of(best.coordinate, best.coordinate + facet.dim, [](double c) { return c >= 0; }))
        return best;
    best.distance = HUGE_VAL;
    for (int i = 0; i < (facet.dim == 2 ? 1 : 3); ++i) {
        const Foot foot =
            on_edge(facet, simplex, facet.vertex(simplex, i), facet.vertex(simplex, (i + 1) % facet.dim), x);
        if (foot.distance < best.distance) best = foot;
    }
    return best;
}

// The distance d is that of x from y = sum N_i p_i, where the convective coordinates of y make w = x - y = d
// n orthogonal to the tangents t_j = p_j - p_0. By the implicit-function theorem, with z = dx - sum N_i dp_i
// and u_j = n . dt_j, and M_ij = t_i . t_j:
//     dd  = n . z
//     d2d = z . Q z / d - 2 u . M^-1 t . z - d u . M^-1 u,  Q the projection across n and all t_j.
void differentiate(const FacetShape& facet, const Foot& foot, const Vector3& normal, double distance,
                   Eigen::VectorXd& gradient, Eigen::MatrixXd* hessian) {
    const auto [z, u, T] = variations(facet, foot, normal);
    const int size = static_cast<int>(z.cols()), m = foot.n - 1;
    gradient = z.transpose() * normal;
    if (!hessian) return;
    Matrix3 Q = Matrix3::Identity() - normal * normal.transpose();
    hessian->setZero(size, size);
    if (m > 0) {
        const Eigen::MatrixXd inverse = (T.transpose() * T).inverse();
        const Eigen::MatrixXd mixed = u.transpose() * (inverse * (T.transpose() * z));
        *hessian = -mixed - mixed.transpose() - distance * (u.transpose() * (inverse * u));
        Q -= T * inverse * T.transpose();
    }
    if (foot.n < facet.dim) {
        if (facet.dim == 2) Q.row(2).setZero(), Q.col(2).setZero();
        *hessian += z.transpose() * Q * z / distance;
    }
}

// With w = d n, so that it is known at d = 0 as well, and s_j = t_j . z + w . dt_j:
//     1/2 d(d^2) = w . z,  1/2 d2(d^2) = z . z - s . M^-1 s.
Expansion squared_distance(const FacetShape& facet, const Foot& foot, const Vector3& x) {
    const Vector3 w = x - place(facet, foot);
    const auto [z, u, T] = variations(facet, foot, w);
    Expansion q{w.squaredNorm(), 2 * z.transpose() * w, 2 * z.transpose() * z};
    if (foot.n == 1) return q;
    const Eigen::MatrixXd s = T.transpose() * z + u;
    q.hessian -= 2 * s.transpose() * ((T.transpose() * T).inverse() * s);
    return q;
}

namespace {

Expansion operator+(const Expansion& a, const Expansion& b) {
    return {a.value + b.value, a.gradient + b.gradient, a.hessian + b.hessian};
}

Expansion operator*(double f, const Expansion& a) { return {f * a.value, f * a.gradient, f * a.hessian}; }

Expansion square(const Expansion& a) {
    return {a.value * a.value, 2 * a.value * a.gradient,
            2 * (a.gradient * a.gradient.transpose() + a.value * a.hessian)};
}

Expansion root(const Expansion& a) {
    const double s = std::sqrt(a.value);
    const Eigen::VectorXd g = a.gradient / (2 * s);
    return {s, g, (0.5 * a.hessian - g * g.transpose()) / s};
}

Expansion edge_length(const FacetShape& facet, int a, int b) {
    Eigen::MatrixXd e = Eigen::MatrixXd::Zero(3, 3 * (1 + facet.n));
    for (int c = 0; c < facet.n; ++c)
        e.middleCols<3>(3 + 3 * c) = (facet.share(b, c) - facet.share(a, c)) * Matrix3::Identity();
    const Vector3 d = facet.corner[b] - facet.corner[a];
    const double length = d.norm();
    const Vector3 t = d / length;
    return {length, e.transpose() * t,
            e.transpose() * ((Matrix3::Identity() - t * t.transpose()) / length) * e};
}

}  // namespace

Expansion beyond_border(const FacetShape& facet, const Foot& rim, double part, const Vector3& x) {
    const Foot plane = whole(facet, rim.simplex, x);
    const Vector3 n = facet.normal(rim.simplex);
    Expansion above{n.dot(x - place(facet, plane)), {}, {}};
    differentiate(facet, plane, n, above.value, above.gradient, &above.hessian);
    const int s = rim.simplex;
    const Expansion radius = part * edge_length(facet, facet.vertex(s, 0), facet.vertex(s, 1));
    const Expansion height = above + radius;
    Expansion aside =
        squared_distance(facet, rim, x) + -1.0 * square(above);  // deep below, numbers that are alike
    aside.value = (place(facet, plane) - place(facet, rim)).squaredNorm();
    return (height.value > 0 ? root(aside + square(height)) : root(aside)) + -1.0 * radius;
}

// From t_j . (x - y) = 0: M dN = t . z + d u.
Eigen::MatrixXd coordinate_gradients(const FacetShape& facet, const Foot& foot, const Vector3& normal,
                                     double distance) {
    const auto [z, u, T] = variations(facet, foot, normal);
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(foot.n, z.cols());
    if (foot.n == 1) return N;
    N.bottomRows(foot.n - 1) = (T.transpose() * T).inverse() * (T.transpose() * z + distance * u);
    N.row(0) = -N.bottomRows(foot.n - 1).colwise().sum();
    return N;
}

}  // namespace visviva
