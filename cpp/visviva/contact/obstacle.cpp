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

// Distance of a place along each of the directions that bound the core.
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

const Scalar* deepest(const Scalar (&q)[3], int n) {
    return std::max_element(q, q + n, [](const Scalar& a, const Scalar& b) { return a.v < b.v; });
}

// What is outside around an edge, as its body leads away from both sides there, has none: the way that it
// goes on tells.
bool beyond_edge(const Scalar (&q)[3], int n) {
    return std::count_if(q, q + n, [](const Scalar& excess) { return excess.v > 0; }) > 1;
}

// Outside the core the distance to it, inside minus the distance to its surface, or to one side of it.
Scalar distance_to_core(const ObstacleShape& shape, const Vector3& y, int side) {
    Scalar q[3];
    const int n = excesses(shape, y, q);
    if (side >= 0) return q[side];
    if (deepest(q, n)->v <= 0) return *deepest(q, n);
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
    std::vector<int> others(int A) const override {
        return {stencils_[A].begin() + 1, stencils_[A].begin() + 5};
    }
    double way(const double* from, const double* to, int vertex) const override {
        return (local(to, vertex) - local(from, vertex)).norm();
    }
    int nearest_side(const double* X, int vertex) const override;
    int entrance(const double* from, const double* to, int vertex) const override;
    double depth(const double* X, int vertex, int side) const override;
    bool are_same(const double*, int side, int other) const override { return side == other; }
    int touched(const double* X, int vertex, int side) const override;
    bool goes_by(const double* X, int vertex, int side, bool sags) const override;
    int face_beside(const double* X, int vertex) const;

  private:
    Vector3 out(const double* X, const Vector3& gradient) const;
    Vector3 local(const double* X, const Vector3& x) const;
    Vector3 local(const double* X, int vertex) const { return local(X, At(X + 3 * vertex)); }
    bool reaches(const double* from, const double* to, int vertex) const;
    bool turns() const { return !options_.turning.empty(); }  // a ball that rubs
    // Balls whose middle is just above an edge come in from above.
    double on_edge() const { return 1e-9 * options_.radius; }
    ObstacleShape shape_;
};

// The stencil is the vertex and the frame: its origin and the ends of its axes, behind all vertices; then the
// frame of a ball that rubs.
bool Obstacle::search(const double*, const double*) {
    if (stencils_.empty() || !stencils_[0].empty()) return false;
    for (int A = 0; A < n_; ++A) {
        stencils_[A] = {A};
        for (int k = 4; k > 0; --k) stencils_[A].push_back(skin_.n_vertices() - k);
        for (int k = 0; turns() && k < 4; ++k) stencils_[A].push_back(options_.turning[A] + k);
    }
    return true;
}

Vector3 Obstacle::local(const double* X, const Vector3& x) const {
    const double* frame = X + 3 * (skin_.n_vertices() - 4);
    const At o(frame);
    Vector3 y;
    for (int i = 0; i < 3; ++i) y[i] = (x - o).dot(At(frame + 3 + 3 * i) - o) / shape_.axis;
    return y;
}

// A half space holds whatever is below its plane; of other shapes points come out at the other side.
void Obstacle::approaches(const double* from, const double* to, std::vector<Approach>& out) const {
    out.assign(n_, {});
    if (shape_.core == ObstacleShape::half_space) return;
    const double least = *std::min_element(shape_.half, shape_.half + 3);
    for (int A = 0; A < n_; ++A)
        if (reaches(from, to, A)) out[A] = {least + shape_.radius + options_.radius, way(from, to, A)};
}

// Whether the way of a vertex, as seen from the frame, leads through the box about the shape. As the frame
// turns that way bends.
bool Obstacle::reaches(const double* from, const double* to, int A) const {
    const bool round = shape_.core == ObstacleShape::cylinder;
    const double *frame0 = from + 3 * (skin_.n_vertices() - 4), *frame1 = to + 3 * (skin_.n_vertices() - 4);
    const Vector3 start = local(from, A), way = local(to, A) - start;
    const Vector3 arm = At(to + 3 * A) - At(frame1) - (At(from + 3 * A) - At(frame0));
    double begin = 0, end = 1;
    for (int i = 0; i < 3; ++i) {
        const int a = 3 + 3 * i;
        const Vector3 turn = At(frame1 + a) - At(frame1) - (At(frame0 + a) - At(frame0));
        const double bend = 0.25 * std::abs(arm.dot(turn)) / shape_.axis;
        const double half = shape_.half[round && i == 1 ? 0 : i] + shape_.radius + options_.radius + bend;
        if (std::abs(way[i]) <= 1e-14 * half) {
            if (std::abs(start[i]) > half) return false;
            continue;
        }
        const double one = (-half - start[i]) / way[i], other = (half - start[i]) / way[i];
        begin = std::max(begin, std::min(one, other)), end = std::min(end, std::max(one, other));
    }
    return begin <= end;
}

// Inside, there or where nudging moves it, so that what touches an edge keeps its side.
int Obstacle::nearest_side(const double* X, int A) const {
    if (shape_.core == ObstacleShape::half_space) return Sides::nearest;
    constexpr double rounding = 1e-9;
    Scalar there[3], q[3];
    const Vector3 y = local(X, A);
    // most are outside, and by more than what nudging them may change
    constexpr double far = 1e-2;
    if (deepest(there, excesses(shape_, y, there))->v > far * y.norm()) return Sides::nearest;
    const int n = excesses(shape_, local(X, nudged(X, A)), q);
    const double touching = skin_.mesh_node[skin_.first[A]] ? 0 : rounding * y.norm() + on_edge();
    for (int k = 0; k < n; ++k)
        if ((touching > 0 ? std::min(there[k].v, q[k].v) : q[k].v) >= touching) return Sides::nearest;
    return beyond_edge(q, n) ? Sides::nearest : static_cast<int>(deepest(q, n) - q);
}

double Obstacle::depth(const double* X, int A, int side) const {
    Scalar q[3];
    excesses(shape_, local(X, A), q);
    return -q[side].v;
}

// The core is convex: it is the side that the vertex passes last, or if it cannot touch that the nearest that
// it can.
int Obstacle::entrance(const double* from, const double* to, int A) const {
    const Vector3 start = local(from, nudged(from, A)), end = local(to, nudged(to, A));
    double latest = 0;
    int side = Sides::nearest;
    Scalar q[3];
    const int n = excesses(shape_, end, q);
    if (beyond_edge(q, n)) return side;
    for (int k = 0; k < n; ++k) {
        excesses(shape_, start, q);
        if (q[k].v < on_edge()) continue;
        double before = 0, after = 1;
        for (int halving = 0; halving < 50; ++halving) {
            const double t = 0.5 * (before + after);
            excesses(shape_, start + t * (end - start), q);
            (q[k].v > 0 ? before : after) = t;
        }
        if (after > latest) latest = after, side = k;
    }
    excesses(shape_, end, q);
    if (side < 0 || !keeps_ || looks(to, A, out(to, q[side].d))) return side;
    const int other = touched(to, A, side);
    return other < 0 ? side : other;
}

// Of a side, the outward normal.
Vector3 Obstacle::out(const double* X, const Vector3& gradient) const {
    const double* frame = X + 3 * (skin_.n_vertices() - 4);
    Vector3 normal = Vector3::Zero();
    for (int i = 0; i < 3; ++i) normal += gradient[i] / shape_.axis * (At(frame + 3 + 3 * i) - At(frame));
    return normal;
}

bool Obstacle::goes_by(const double* X, int A, int side, bool sags) const {
    if (deforms(A)) return false;
    Scalar q[3];
    const int n = excesses(shape_, local(X, A), q);
    for (int k = 0; k < n; ++k) {
        const Plane face{out(X, q[k].d), q[k].v};
        if (k == side || !looks(X, A, face.normal)) continue;
        if (sags && sags_.reach(face.height, face.normal)) return true;
        if (side >= 0 && is_flush(X, A, {out(X, q[side].d), q[side].v}, face)) return true;
    }
    return false;
}

// Of what is over a body that is flush with a face, and was above it where the step began, that face: it
// lands there as on one floor.
int Obstacle::face_beside(const double* X, int A) const {
    Scalar q[3], before[3];
    const int n = excesses(shape_, local(X, A), q);
    excesses(shape_, local(start(), A), before);
    for (int wall = 0; wall < n; ++wall)
        for (int k = 0; q[wall].v > 0 && k < n; ++k) {
            const Plane face{out(X, q[k].d), q[k].v};
            if (k != wall && before[k].v >= 0 && looks(X, A, face.normal) &&
                is_flush(X, A, {out(X, q[wall].d), q[wall].v}, face))
                return k;
        }
    return Sides::nearest;
}

int Obstacle::touched(const double* X, int A, int side) const {
    Scalar q[3];
    const int n = excesses(shape_, local(X, nudged(X, A)), q);
    auto may = [&](int k) { return looks(X, A, out(X, q[k].d)) && !swings_by(X, A, k); };
    if (side >= 0 && may(side)) return side;
    int other = Sides::nearest;
    for (int k = 0; k < n; ++k)
        if ((other < 0 || q[k].v > q[other].v) && may(k)) other = k;
    return other;
}

// With the place y_i = (x - o) . (p_i - o) / L in the frame.
PointGaps::Reach Obstacle::distance(const double* X, int A, int derivatives, Distance& out) const {
    const double* frame = X + 3 * (skin_.n_vertices() - 4);
    const At x(X + 3 * A), o(frame);
    const double L = shape_.axis;
    Matrix3 axes;
    for (int i = 0; i < 3; ++i) axes.row(i) = (At(frame + 3 + 3 * i) - o) / L;
    const Vector3 arm = x - o;
    const int over = may_land(A) ? face_beside(X, A) : Sides::nearest, in = over < 0 ? side(X, A) : over;
    const Reach reach = in == Sides::none ? Reach::far : Reach::near;
    const Scalar g = distance_to_core(shape_, axes * arm, in);
    out.value = (over < 0 ? g.v : std::max(g.v, 0.0)) - shape_.radius;
    if (derivatives == 0) return reach;
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
    if (derivatives == 1) return reach;
    out.hessian.setZero(out.gradient.size(), out.gradient.size());
    out.hessian.topLeftCorner<15, 15>() = J.transpose() * g.dd * J;
    for (int i = 0; i < 3; ++i) {  // d2y_i = 2 (dx - do) . (dp_i - do) / L
        const Matrix3 h = g.d[i] / L * Matrix3::Identity();
        out.hessian.block<3, 3>(0, 6 + 3 * i) += h, out.hessian.block<3, 3>(6 + 3 * i, 0) += h;
        out.hessian.block<3, 3>(3, 6 + 3 * i) -= h, out.hessian.block<3, 3>(6 + 3 * i, 3) -= h;
        out.hessian.block<3, 3>(0, 3) -= h, out.hessian.block<3, 3>(3, 0) -= h;
        out.hessian.block<3, 3>(3, 3) += 2 * h;
    }
    return reach;
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
        add_weights(X + 3 * options_.turning[A], shape_.axis, c, C, 5, -1, out);
    else
        out.weight[0] = -1;
    add_weights(frame, shape_.axis, c, C, 1, 1, out);
    turn_with_frame(1, out.turning);
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
