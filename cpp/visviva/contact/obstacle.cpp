// Gaps of vertices above an exact shape in a frame: half space, rounded box (ball, capsule) or cylinder.
#include <algorithm>
#include <cmath>

#include "visviva/contact/point_gaps.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using At = Eigen::Map<const Vector3>;

// A number as a function of the place in the frame.
struct Scalar {
    double v = 0;
    Vector3 d = Vector3::Zero();
    Matrix3 dd = Matrix3::Zero();
};

// How far out a place is along each of the directions that bound the core.
int excesses(const ObstacleShape& shape, const Vector3& y, Scalar (&q)[3]) {
    if (shape.core == ObstacleShape::half_space) {
        q[0].v = y[2], q[0].d = Vector3::UnitZ();
        return 1;
    }
    int n = 0;
    if (shape.core == ObstacleShape::cylinder) {
        const double rho = std::hypot(y[0], y[1]);
        Scalar& s = q[n++];
        s.v = rho - shape.half[0];
        if (rho > 0) {
            s.d = Vector3(y[0], y[1], 0) / rho;
            s.dd = -s.d * s.d.transpose() / rho;
            s.dd(0, 0) += 1 / rho, s.dd(1, 1) += 1 / rho;
        }
    }
    for (int i = n == 0 ? 0 : 2; i < 3; ++i) {
        Scalar& s = q[n++];
        s.v = std::abs(y[i]) - shape.half[i];
        s.d[i] = y[i] < 0 ? -1 : 1;
    }
    return n;
}

// Outside the core the distance to it, inside minus the distance to its surface.
Scalar distance_to_core(const ObstacleShape& shape, const Vector3& y) {
    Scalar q[3];
    const int n = excesses(shape, y, q);
    const Scalar* deepest =
        std::max_element(q, q + n, [](const Scalar& a, const Scalar& b) { return a.v < b.v; });
    if (deepest->v <= 0) return *deepest;
    Scalar r;
    for (int k = 0; k < n; ++k)
        if (q[k].v > 0) r.v = std::hypot(r.v, q[k].v);
    for (int k = 0; k < n; ++k)
        if (q[k].v > 0) {
            r.d += q[k].v / r.v * q[k].d;
            r.dd += (q[k].d * q[k].d.transpose() + q[k].v * q[k].dd) / r.v;
        }
    r.dd -= r.d * r.d.transpose() / r.v;
    return r;
}

class Obstacle : public PointGaps {
  public:
    Obstacle(Skin skin, PointOptions options, const ObstacleShape& shape)
        : PointGaps(std::move(skin), std::move(options)), shape_(shape) {}
    bool search(const double*, const double*) override;
    void approaches(const double* from, const double* to, std::vector<Approach>& out) const override;

  protected:
    Reach distance(const double* X, int vertex, int derivatives, Distance& out) const override;
    void grip(const double* X, int vertex, bool gradients, Grip& out) const override;

  private:
    Vector3 place(const double* X, int vertex) const;
    bool turns() const { return options_.rubs && options_.radius > 0; }  // a ball that rubs
    ObstacleShape shape_;
};

// The stencil is the vertex and the frame: its origin and the ends of its axes, behind all vertices; then the
// frame of a ball that rubs.
bool Obstacle::search(const double*, const double*) {
    if (stencils_.empty() || !stencils_[0].empty()) return false;
    for (int A = 0; A < n_; ++A) {
        stencils_[A] = {A};
        for (int frame = 0; frame < (turns() ? 2 : 1); ++frame)
            for (int k = 4; k > 0; --k) stencils_[A].push_back(skin_.n_vertices() - 4 * frame - k);
    }
    return true;
}

Vector3 Obstacle::place(const double* X, int A) const {
    const double* frame = X + 3 * (skin_.n_vertices() - 4);
    const At x(X + 3 * A), o(frame);
    Vector3 y;
    for (int i = 0; i < 3; ++i) y[i] = (x - o).dot(At(frame + 3 + 3 * i) - o) / shape_.axis;
    return y;
}

// A half space holds whatever is below its plane; of other shapes points come out at the other side.
void Obstacle::approaches(const double* from, const double* to, std::vector<Approach>& out) const {
    out.assign(n_, {});
    if (shape_.core == ObstacleShape::half_space) return;
    double least = HUGE_VAL;
    for (double half : shape_.half)
        if (half > 0) least = std::min(least, half);
    if (!std::isfinite(least)) least = 0;
    for (int A = 0; A < n_; ++A)
        out[A] = {least + shape_.radius + options_.radius, (place(to, A) - place(from, A)).norm()};
}

// With the place y_i = (x - o) . (p_i - o) / L in the frame.
PointGaps::Reach Obstacle::distance(const double* X, int A, int derivatives, Distance& out) const {
    const double* frame = X + 3 * (skin_.n_vertices() - 4);
    const At x(X + 3 * A), o(frame);
    const double L = shape_.axis;
    Matrix3 axes;
    for (int i = 0; i < 3; ++i) axes.row(i) = (At(frame + 3 + 3 * i) - o) / L;
    const Vector3 arm = x - o;
    const Scalar g = distance_to_core(shape_, axes * arm);
    out.value = g.v - shape_.radius;
    if (derivatives == 0) return Reach::near;
    Eigen::Matrix<double, 3, 15> J;
    J.leftCols<3>() = axes;
    J.middleCols<3>(3) = -axes;
    J.rightCols<9>().setZero();
    for (int i = 0; i < 3; ++i) {
        J.block<1, 3>(i, 3) -= arm.transpose() / L;
        J.block<1, 3>(i, 6 + 3 * i) = arm.transpose() / L;
    }
    out.gradient.setZero(3 * stencils_[A].size());
    out.gradient.head<15>() = J.transpose() * g.d;
    if (derivatives == 1) return Reach::near;
    out.hessian.setZero(out.gradient.size(), out.gradient.size());
    out.hessian.topLeftCorner<15, 15>() = J.transpose() * g.dd * J;
    for (int i = 0; i < 3; ++i) {  // d2y_i = 2 (dx - do) . (dp_i - do) / L
        const Matrix3 h = g.d[i] / L * Matrix3::Identity();
        out.hessian.block<3, 3>(0, 6 + 3 * i) += h, out.hessian.block<3, 3>(6 + 3 * i, 0) += h;
        out.hessian.block<3, 3>(3, 6 + 3 * i) -= h, out.hessian.block<3, 3>(6 + 3 * i, 3) -= h;
        out.hessian.block<3, 3>(0, 3) -= h, out.hessian.block<3, 3>(3, 0) -= h;
        out.hessian.block<3, 3>(3, 3) += 2 * h;
    }
    return Reach::near;
}

// What touches is the vertex, or the point of the ball that is nearest, against the point of the shape's
// frame there.
void Obstacle::grip(const double* X, int A, bool gradients, Grip& out) const {
    Distance d;
    distance(X, A, gradients ? 2 : 1, d);
    const double* frame = X + 3 * (skin_.n_vertices() - 4);
    const Vector3 m = d.gradient.head<3>(), n = m.normalized();
    const Vector3 c = At(X + 3 * A) - options_.radius * n;
    Eigen::MatrixXd N, C;
    if (gradients) {
        N = (Matrix3::Identity() - n * n.transpose()) / m.norm() * d.hessian.topRows<3>();
        C = -options_.radius * N;
        C.leftCols<3>() += Matrix3::Identity();
    }
    if (turns())
        add_weights(frame - 12, shape_.axis, c, C, 5, -1, out);
    else
        out.weight[0] = -1;
    add_weights(frame, shape_.axis, c, C, 1, 1, out);
    // the third axis, or the first where that is across
    constexpr double across = 0.9;
    const Vector3 third = (At(frame + 9) - At(frame)).normalized();
    const int end = std::abs(third.dot(n)) < across ? 3 : 1;
    const Vector3 edge = At(frame + 3 * end) - At(frame);
    set_tangents(skin_.dim, n, gradients ? &N : nullptr, edge, 1, 1 + end, out);
}

}  // namespace

std::unique_ptr<Gaps> make_obstacle(Skin skin, PointOptions options, const ObstacleShape& shape) {
    return std::make_unique<Obstacle>(std::move(skin), std::move(options), shape);
}

}  // namespace visviva
