// Tangent planes for friction, and masses where all vertices count the same.
#include "visviva/contact/gaps.hpp"
#include "visviva/contact/skew.hpp"

namespace visviva {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

void Gaps::masses(const double*, const std::vector<char>& wanted, bool, std::vector<Grip>& out) {
    for (int A = 0; A < n_; ++A) {
        const Eigen::Index k = stencils_[A].size();
        if (!wanted[A]) continue;
        out[A].weight.setOnes(k);
        out[A].weight_gradient.resize(0, 0);
    }
}

void set_tangents(int dim, const Vector3& n, const Eigen::MatrixXd* N, const Vector3& edge, int tail,
                  int head, Grip& out) {
    out.tangent.setZero();
    if (dim == 2) {
        const Matrix3 turn = skew(Vector3::UnitZ());
        out.tangent.col(0) = turn * n;
        if (N) out.tangent_gradient[0] = turn * *N, out.tangent_gradient[1].setZero(3, N->cols());
        return;
    }
    const Vector3 along = edge - n * n.dot(edge), t = along.normalized();
    out.tangent.col(0) = t, out.tangent.col(1) = n.cross(t);
    if (!N) return;
    const Matrix3 onto = Matrix3::Identity() - n * n.transpose(),
                  across = Matrix3::Identity() - t * t.transpose();
    Eigen::MatrixXd& first = out.tangent_gradient[0];
    first = -(n * (edge.transpose() * *N) + n.dot(edge) * *N);
    first.middleCols<3>(3 * head) += onto, first.middleCols<3>(3 * tail) -= onto;
    first = (across / along.norm() * first).eval();
    out.tangent_gradient[1] = skew(n) * first - skew(t) * *N;
}

}  // namespace visviva
