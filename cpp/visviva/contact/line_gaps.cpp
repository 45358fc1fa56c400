// Gaps between round bars: of points along the middle of one to the middle of the other, less both radii.
// The closest point may be an end or a joint of segments, so that what crosses, lies along or slides off is
// one function of the positions, continuous with its gradient.
#include <algorithm>
#include <cmath>

#include "visviva/base/parallel.hpp"
#include "visviva/contact/closest.hpp"
#include "visviva/contact/point_gaps.hpp"
#include "visviva/contact/search.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

struct Candidate {
    int facet, local[2];  // a segment, and the places of its ends in the stencil, which their frames follow
};

constexpr int FRAME = 4;

class LineGaps : public PointGaps {
  public:
    LineGaps(Skin skin, PointOptions options, OwnSegments beside, BarFrames frames)
        : PointGaps(std::move(skin), std::move(options)),
          beside_(std::move(beside)),
          frames_(std::move(frames)),
          candidates_(n_) {}
    bool search(const double* from, const double* to) override;
    void approaches(const double* from, const double* to, std::vector<Approach>& out) const override;

  protected:
    Reach distance(const double* X, int vertex, int derivatives, Distance& out) const override;
    double way(const double* from, const double* to, int vertex) const override;
    bool is_inside(const double*, int) const override { return false; }
    int nearest_side(const double*, int) const override { return Sides::nearest; }
    int entrance(const double*, const double*, int) const override { return Sides::nearest; }
    double depth(const double*, int, int) const override { return 0; }
    bool are_same(const double*, int side, int other) const override { return side == other; }
    void grip(const double* X, int vertex, bool gradients, Grip& out) const override;

  private:
    bool is_beside(int A, int f) const {
        const int *begin = beside_.own.data() + beside_.start[A],
                  *end = beside_.own.data() + beside_.start[A + 1];
        return std::find(begin, end, f) != end;
    }
    FacetShape shape(const double* X, int f) const;
    const Candidate* nearest(const double* X, int A, Foot& foot) const;
    bool rubs() const { return !frames_.second.empty(); }
    bool turns() const { return !options_.turning.empty(); }
    void make_stencil(int A, const std::vector<int>& facets);

    OwnSegments beside_;
    BarFrames frames_;
    PointSearch near_facets_;
    std::vector<std::vector<Candidate>> candidates_;
};

FacetShape LineGaps::shape(const double* X, int f) const {
    FacetShape s;
    s.n = 2;
    for (int i = 0; i < 2; ++i) s.corner[i] = At(X + 3 * skin_.corners(f)[i]);
    return s;
}

bool LineGaps::search(const double* from, const double* to) {
    const int begin = skin_.second_begin;
    const double margin = 2 * options_.reach + options_.radius;
    return near_facets_.find(skin_, begin, n_, from, to, margin, [&](int A, std::vector<int>& found) {
        std::erase_if(found, [&](int f) { return is_beside(A, f - begin); });
        const auto& old = candidates_[A];
        if (std::equal(old.begin(), old.end(), found.begin(), found.end(),
                       [](const Candidate& c, int f) { return c.facet == f; }))
            return false;
        make_stencil(A, found);
        return true;
    });
}

void LineGaps::make_stencil(int A, const std::vector<int>& facets) {
    auto& stencil = stencils_[A];
    stencil.assign(1, A), candidates_[A].clear();
    auto add_frame = [&](int first) {
        for (int k = 0; k < FRAME; ++k) stencil.push_back(first + k);
    };
    if (turns()) add_frame(options_.turning[A]);
    for (int f : facets) {
        Candidate c{f, {}};
        for (int i = 0; i < 2; ++i) {
            const int v = skin_.corners(f)[i];
            const auto at = std::find(stencil.begin(), stencil.end(), v);
            c.local[i] = static_cast<int>(at - stencil.begin());
            if (at != stencil.end()) continue;
            stencil.push_back(v);
            if (rubs()) add_frame(frames_.second[v - n_]);
        }
        candidates_[A].push_back(c);
    }
    if (facets.empty()) stencil.clear();
}

double LineGaps::way(const double* from, const double* to, int A) const {
    const Vector3 own = At(to + 3 * A) - At(from + 3 * A);
    double farthest = 0;
    for (const Candidate& c : candidates_[A])
        for (int i = 0; i < 2; ++i) {
            const int v = skin_.corners(c.facet)[i];
            farthest = std::max(farthest, (At(to + 3 * v) - At(from + 3 * v) - own).norm());
        }
    return farthest;
}

// What has passed the middle of a bar is pushed out on its other side.
void LineGaps::approaches(const double* from, const double* to, std::vector<Approach>& out) const {
    out.assign(n_, {});
    for (int A = 0; A < n_; ++A) {
        Distance d;
        if (distance(from, A, 0, d) == Reach::near || distance(to, A, 0, d) == Reach::near)
            out[A] = {options_.radius, way(from, to, A)};
    }
}

const Candidate* LineGaps::nearest(const double* X, int A, Foot& foot) const {
    const Candidate* found = nullptr;
    double least = options_.reach + options_.radius;
    for (const Candidate& c : candidates_[A]) {
        const Foot other = on_edge(shape(X, c.facet), 0, 0, 1, At(X + 3 * A));
        if (other.distance < least) least = other.distance, foot = other, found = &c;
    }
    return found;
}

PointGaps::Reach LineGaps::distance(const double* X, int A, int derivatives, Distance& out) const {
    const At x(X + 3 * A);
    Foot foot;
    const Candidate* near = nearest(X, A, foot);
    const int size = 3 * static_cast<int>(stencils_[A].size());
    if (derivatives > 0) out.gradient.setZero(size);
    if (derivatives > 1) out.hessian.setZero(size, size);
    if (!near) return Reach::far;
    out.value = foot.distance;
    if (derivatives == 0) return Reach::near;
    const FacetShape bar = shape(X, near->facet);
    Vector3 normal = x;
    for (int i = 0; i < foot.n; ++i) normal -= foot.coordinate[i] * bar.corner[foot.vertex[i]];
    normal /= foot.distance;
    Eigen::VectorXd g;
    Eigen::MatrixXd H;
    differentiate(bar, foot, normal, foot.distance, g, derivatives > 1 ? &H : nullptr);
    auto place = [&](int c) { return c == 0 ? 0 : 3 * near->local[c - 1]; };
    for (int c = 0; c < 3; ++c) out.gradient.segment<3>(place(c)) += g.segment<3>(3 * c);
    for (int c = 0; c < 3 && derivatives > 1; ++c)
        for (int d = 0; d < 3; ++d)
            out.hessian.block<3, 3>(place(c), place(d)) += H.block<3, 3>(3 * c, 3 * d);
    return Reach::near;
}

// --- friction
// ------------------------------------------------------------------------------------------------ A point at
// an arm from the origin of a frame moves as the frame's vertices do, whose weights make the arm of its axes,
// exactly so where these are interpolated and not quite orthonormal: then forces on them have no moment that
// the point has not.
struct Share {
    double value;
    Eigen::RowVectorXd gradient;
};

void add_arm(const double* frame, int own, const Vector3& arm, const Eigen::MatrixXd& change,
             const Share& share, Grip& out) {
    Eigen::Matrix3d axes;
    for (int i = 0; i < 3; ++i) axes.col(i) = At(frame + 3 + 3 * i) - At(frame);
    const Eigen::Matrix3d inverse = axes.inverse();
    const Vector3 y = inverse * arm;
    out.weight[own] += share.value * (1 - y.sum());
    out.weight.segment<3>(own + 1) += share.value * y;
    if (change.size() == 0) return;
    Eigen::MatrixXd turned = change;
    turned.middleCols<3>(3 * own) += y.sum() * Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) turned.middleCols<3>(3 * (own + 1 + i)) -= y[i] * Eigen::Matrix3d::Identity();
    const Eigen::MatrixXd dy = inverse * turned;
    out.weight_gradient.row(own) += (1 - y.sum()) * share.gradient - share.value * dy.colwise().sum();
    out.weight_gradient.middleRows<3>(own + 1) += share.value * dy + y * share.gradient;
}

// Of the ends of a segment in the closest point to x, by the places of x and both ends.
Share share_of_end(const FacetShape& bar, const Foot& foot, int i, const Vector3& x, const int (&place)[3],
                   Eigen::Index size) {
    Share share{foot.coordinate[i], Eigen::RowVectorXd::Zero(size)};
    if (foot.n < 2) return share;
    const int a = foot.vertex[1 - i], b = foot.vertex[i];
    const Vector3 e = bar.corner[b] - bar.corner[a], r = x - bar.corner[a];
    const double square = e.squaredNorm();
    const Vector3 by_end = (r - 2 * share.value * e) / square;
    share.gradient.segment<3>(3 * place[0]) += (e / square).transpose();
    share.gradient.segment<3>(3 * place[1 + b]) += by_end.transpose();
    share.gradient.segment<3>(3 * place[1 + a]) -= (e / square + by_end).transpose();
    return share;
}

// Both bars touch at one point, which turns with each of them; tractions turn with the first one.
void LineGaps::grip(const double* X, int A, bool gradients, Grip& out) const {
    Foot foot;
    const Candidate* near = nearest(X, A, foot);
    if (!near) return;
    Distance d;
    distance(X, A, gradients ? 2 : 1, d);
    const auto& stencil = stencils_[A];
    const Eigen::Index size = 3 * static_cast<Eigen::Index>(stencil.size());
    const Vector3 n = d.gradient.head<3>();
    const double rest = d.value - frames_.radius;  // from the middle of the second bar to where they touch
    Eigen::MatrixXd N, first, second;
    if (gradients) {
        N = d.hessian.topRows<3>();
        first = -frames_.radius * N;
        second = n * d.gradient.transpose() + rest * N;
    }
    const Share whole{-1, Eigen::RowVectorXd::Zero(size)};
    if (turns())
        add_arm(X + 3 * options_.turning[A], 1, -frames_.radius * n, first, whole, out);
    else
        out.weight[0] = -1;
    const FacetShape bar = shape(X, near->facet);
    const int place[3] = {0, near->local[0], near->local[1]};
    for (int i = 0; i < foot.n; ++i) {
        const int own = near->local[foot.vertex[i]] + 1;
        add_arm(X + 3 * stencil[own], own, rest * n, second,
                share_of_end(bar, foot, i, At(X + 3 * A), place, size), out);
    }
    const int origin = turns() ? 1 : near->local[0] + 1;
    turn_with_frame(origin, out.turning);
    // the third axis, or the first where that is across
    constexpr double across = 0.9;
    auto axis = [&](int i) -> Vector3 {
        return At(X + 3 * stencil[origin + i]) - At(X + 3 * stencil[origin]);
    };
    const int end = std::abs(axis(3).normalized().dot(n)) < across ? 3 : 1;
    set_tangents(skin_.dim, n, gradients ? &N : nullptr, axis(end), origin, origin + end, out);
}

}  // namespace

std::unique_ptr<Gaps> make_line_gaps(Skin skin, PointOptions options, OwnSegments beside, BarFrames frames) {
    return std::make_unique<LineGaps>(std::move(skin), std::move(options), std::move(beside),
                                      std::move(frames));
}

}  // namespace visviva
