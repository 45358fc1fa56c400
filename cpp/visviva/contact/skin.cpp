#include "visviva/contact/skin.hpp"

#include <cmath>

namespace visviva {

void Skin::evaluate(const double* q, std::vector<double>& X) const {
    for (int v = 0; v < n_vertices(); ++v)
        for (int k = first[v]; k < first[v + 1]; ++k)
            for (int i = 0; i < dim; ++i) X[3 * v + i] += weight[k] * q[unknown[k] + i];
}

void Skin::positions(const double* q, std::vector<double>& X) const {
    X = constant;
    evaluate(q, X);
}

void Skin::increments(const double* dq, std::vector<double>& D) const {
    D.assign(constant.size(), 0.0);
    evaluate(dq, D);
}

void Skin::add_force(int v, const double* f, double factor, double* r) const {
    for (int k = first[v]; k < first[v + 1]; ++k)
        for (int i = 0; i < dim; ++i) r[unknown[k] + i] += factor * weight[k] * f[i];
}

void NormalField::build(const Skin& skin) {
    dim = skin.dim;
    std::vector<std::vector<Corner>> of(skin.n_vertices());
    for (int f = 0; f < skin.n_facets(); ++f) {
        const int n = skin.n_corners(f);
        const int* c = skin.corners(f);
        for (int a = 0; a < n; ++a)
            of[c[a]].push_back(n > 2    ? Corner{c[(a + 1) % n], c[(a + n - 1) % n]}
                               : a == 0 ? Corner{c[1], -1}
                                        : Corner{-1, c[0]});
    }
    start.assign(1, 0);
    for (const auto& list : of) {
        corners.insert(corners.end(), list.begin(), list.end());
        start.push_back(static_cast<int>(corners.size()));
    }
}

void NormalField::sum(const double* X, int vertex, double* m) const {
    m[0] = m[1] = m[2] = 0;
    const double* a = X + 3 * vertex;
    for (int k = start[vertex]; k < start[vertex + 1]; ++k) {
        const Corner& corner = corners[k];
        if (dim == 2) {  // an edge from p to q looks along (q - p) x e_z
            const double* p = corner.next >= 0 ? a : X + 3 * corner.previous;
            const double* q = corner.next >= 0 ? X + 3 * corner.next : a;
            m[0] += q[1] - p[1], m[1] -= q[0] - p[0];
            continue;
        }
        const double *b = X + 3 * corner.next, *c = X + 3 * corner.previous;
        const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                     w[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        m[0] += u[1] * w[2] - u[2] * w[1], m[1] += u[2] * w[0] - u[0] * w[2],
            m[2] += u[0] * w[1] - u[1] * w[0];
    }
}

bool NormalField::normal(const double* X, int vertex, double* n) const {
    sum(X, vertex, n);
    const double size = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(size > 0)) return false;
    for (int i = 0; i < 3; ++i) n[i] /= size;
    return true;
}

Eigen::Vector3d NormalField::by_angles(const double* X, int vertex) const {
    using Vector3 = Eigen::Vector3d;
    using At = Eigen::Map<const Vector3>;
    Vector3 sum = Vector3::Zero();
    const At a(X + 3 * vertex);
    for (int k = start[vertex]; k < start[vertex + 1]; ++k) {
        const Corner& corner = corners[k];
        Vector3 m;
        double angle = 1;
        if (dim == 2) {
            const Vector3 e =
                corner.next >= 0 ? At(X + 3 * corner.next) - a : a - At(X + 3 * corner.previous);
            m = e.cross(Vector3::UnitZ());
        } else {
            const Vector3 u = At(X + 3 * corner.next) - a, w = At(X + 3 * corner.previous) - a;
            m = u.cross(w), angle = std::atan2(m.norm(), u.dot(w));
        }
        if (m.norm() > 0) sum += angle * m.normalized();
    }
    return sum;
}

}  // namespace visviva
