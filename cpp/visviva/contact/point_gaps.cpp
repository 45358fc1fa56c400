#include "visviva/contact/point_gaps.hpp"

#include "visviva/base/parallel.hpp"

namespace visviva {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

PointGaps::PointGaps(Skin skin, PointOptions options) : Gaps(std::move(skin)), options_(std::move(options)) {
    n_ = static_cast<int>(options_.areas.size());
    stencils_.resize(n_);
}

void PointGaps::values(const double* X, double* gap, double* area) {
    parallel_for(n_, [&](int A) {
        Distance d;
        const Reach reach = distance(X, A, 0, d);
        area[A] = reach == Reach::near ? options_.areas[A] : 0;
        gap[A] = options_.areas[A] * (reach == Reach::near ? d.value - options_.radius : options_.reach);
    });
}

void PointGaps::gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) {
    parallel_for(n_, [&](int A) {
        if (!wanted[A]) return;
        Distance d;
        distance(X, A, 1, d);
        d.gradient *= options_.areas[A];
        out[A].gradient.assign(d.gradient.begin(), d.gradient.end());
    });
}

void PointGaps::seconds(const double* X, const std::vector<double>& S, const double* direction,
                        std::vector<Gap>& out) {
    parallel_for(n_, [&](int A) {
        if (S[A] == 0) return;
        Distance d;
        distance(X, A, 2, d);
        d.gradient *= options_.areas[A], d.hessian *= options_.areas[A];
        out[A].gradient.assign(d.gradient.begin(), d.gradient.end());
        if (direction) {
            Eigen::VectorXd D(d.gradient.size());
            for (std::size_t v = 0; v < stencils_[A].size(); ++v)
                D.segment<3>(3 * v) = Eigen::Map<const Eigen::Vector3d>(direction + 3 * stencils_[A][v]);
            const Eigen::VectorXd along = d.hessian * D;
            out[A].along.assign(along.begin(), along.end());
        }
        d.hessian *= S[A];
        out[A].hessian.assign(d.hessian.data(), d.hessian.data() + d.hessian.size());
    });
}

void PointGaps::grips(const double* X, const std::vector<char>& wanted, bool gradients,
                      std::vector<Grip>& out) {
    parallel_for(n_, [&](int A) {
        if (!wanted[A]) return;
        const Eigen::Index k = stencils_[A].size();
        Grip& g = out[A];
        g.weight.setZero(k), g.tangent.setZero();
        g.weight_gradient.setZero(gradients ? k : 0, 3 * k);
        for (auto& t : g.tangent_gradient) t.setZero(3, 3 * k);
        grip(X, A, gradients, g);
        g.weight *= options_.areas[A], g.weight_gradient *= options_.areas[A];
    });
}

void PointGaps::add_weights(const double* X, double L, const Vector3& c, const Eigen::MatrixXd& C, int own,
                            double sign, Grip& out) {
    const At o(X);
    out.weight[own] += sign;
    for (int i = 0; i < 3; ++i) {
        const Vector3 axis = At(X + 3 + 3 * i) - o, arm = c - o;
        const double y = sign * arm.dot(axis) / (L * L);
        out.weight[own + 1 + i] += y, out.weight[own] -= y;
        if (C.size() == 0) continue;
        Eigen::RowVectorXd dy = axis.transpose() * C;
        dy.segment<3>(3 * own) -= axis + arm, dy.segment<3>(3 * (own + 1 + i)) += arm;
        dy *= sign / (L * L);
        out.weight_gradient.row(own + 1 + i) += dy, out.weight_gradient.row(own) -= dy;
    }
}

}  // namespace visviva
