// Gaps between round bars: of points of one to the middle of the other, less both radii. A point stands for
// the stretches to its neighbours along its bar, so that bars that cross touch where they do and slide across
// each other without a bump (see Crossing). What is nearest may be an end or a joint of segments: what
// crosses, lies along or slides off is one function of the positions, continuous with its gradient.
#include <algorithm>
#include <cmath>

#include "visviva/base/parallel.hpp"
#include "visviva/contact/crossing.hpp"
#include "visviva/contact/point_gaps.hpp"
#include "visviva/contact/search.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

struct Candidate {
    int facet, local[2];  // a segment, and the places of its ends in the stencil, which their frames follow
};

/// A point along the same bar, and its place in the stencil.
struct Neighbour {
    int vertex, local;
};

/// Nearest part of a bar: a segment and the stretch to a neighbour that comes nearest to it, as places
/// of both ends of the stretch and of the segment in the stencil.
struct Nearest {
    int local[4];
    Stretches stretches;
    Crossing crossing;
};

constexpr int FRAME = 4;

class LineGaps : public PointGaps {
  public:
    LineGaps(Skin skin, PointOptions options, OwnSegments beside, BarFrames frames)
        : PointGaps(std::move(skin), std::move(options)),
          beside_(std::move(beside)),
          frames_(std::move(frames)),
          neighbours_(n_),
          candidates_(n_) {
        const auto& ends = frames_.stretches;
        for (std::size_t i = 0; i + 1 < ends.size(); i += 2) {
            neighbours_[ends[i]].push_back({ends[i + 1], 0});
            neighbours_[ends[i + 1]].push_back({ends[i], 0});
        }
    }
    bool search(const double* from, const double* to) override;
    void approaches(const double* from, const double* to, std::vector<Approach>& out) const override;

  protected:
    Reach distance(const double* X, int vertex, int derivatives, Distance& out) const override;
    Vector3 push(const Distance& d, int vertex) const override;
    std::vector<int> others(int vertex) const override;
    double way(const double* from, const double* to, int vertex) const override;
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
    double longest(const double* X) const;
    bool nearest(const double* X, int A, Nearest& found) const;
    bool rubs() const { return !frames_.second.empty(); }
    bool turns() const { return !options_.turning.empty(); }
    void make_stencil(int A, const std::vector<int>& facets);

    OwnSegments beside_;
    BarFrames frames_;
    PointSearch near_facets_;
    std::vector<std::vector<Neighbour>> neighbours_;
    std::vector<std::vector<Candidate>> candidates_;
};

// Of the stretches.
double LineGaps::longest(const double* X) const {
    double length = 0;
    for (int A = 0; A < n_; ++A)
        for (const Neighbour& b : neighbours_[A])
            length = std::max(length, (At(X + 3 * b.vertex) - At(X + 3 * A)).norm());
    return length;
}

bool LineGaps::search(const double* from, const double* to) {
    const int begin = skin_.second_begin;
    const double margin = 2 * options_.reach + options_.radius + longest(from);
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
    for (Neighbour& b : neighbours_[A]) {
        b.local = static_cast<int>(stencil.size());
        stencil.push_back(b.vertex);
        if (turns()) add_frame(options_.turning[b.vertex]);
    }
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

// What pushes on a stretch pushes on both of its ends.
Vector3 LineGaps::push(const Distance& d, int A) const {
    Vector3 sum = d.gradient.head<3>();
    for (const Neighbour& b : neighbours_[A]) sum += d.gradient.segment<3>(3 * b.local);
    return sum;
}

std::vector<int> LineGaps::others(int A) const {
    std::vector<int> corners;
    for (const Candidate& c : candidates_[A])
        corners.insert(corners.end(), skin_.corners(c.facet), skin_.corners(c.facet) + 2);
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    return corners;
}

double LineGaps::way(const double* from, const double* to, int A) const {
    auto moved = [&](int v) -> Vector3 { return At(to + 3 * v) - At(from + 3 * v); };
    double farthest = 0;
    for (const Candidate& c : candidates_[A])
        for (int i = 0; i < 2; ++i) {
            const Vector3 other = moved(skin_.corners(c.facet)[i]);
            farthest = std::max(farthest, (other - moved(A)).norm());
            for (const Neighbour& b : neighbours_[A])
                farthest = std::max(farthest, (other - moved(b.vertex)).norm());
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

bool LineGaps::nearest(const double* X, int A, Nearest& found) const {
    double least = options_.reach + options_.radius;
    auto take = [&](const Candidate& c, const Neighbour& b) {
        const int* ends = skin_.corners(c.facet);
        const Stretches m{At(X + 3 * A), At(X + 3 * b.vertex), At(X + 3 * ends[0]), At(X + 3 * ends[1])};
        const Crossing crossing = cross(m);
        if (crossing.distance >= least) return;
        least = crossing.distance;
        found = {{0, b.local, c.local[0], c.local[1]}, m, crossing};
    };
    for (const Candidate& c : candidates_[A]) {
        if (neighbours_[A].empty()) take(c, {A, 0});
        for (const Neighbour& b : neighbours_[A]) take(c, b);
    }
    return least < options_.reach + options_.radius;
}

PointGaps::Reach LineGaps::distance(const double* X, int A, int derivatives, Distance& out) const {
    Nearest near;
    const bool found = nearest(X, A, near);
    const int size = 3 * static_cast<int>(stencils_[A].size());
    if (derivatives > 0) out.gradient.setZero(size);
    if (derivatives > 1) out.hessian.setZero(size, size);
    if (!found) return Reach::far;
    out.value = near.crossing.distance;
    if (derivatives == 0) return Reach::near;
    const CrossingDerivatives d = differentiate(near.stretches, near.crossing);
    for (int c = 0; c < 4; ++c) out.gradient.segment<3>(3 * near.local[c]) += d.gradient.segment<3>(3 * c);
    for (int c = 0; c < 4 && derivatives > 1; ++c)
        for (int e = 0; e < 4; ++e)
            out.hessian.block<3, 3>(3 * near.local[c], 3 * near.local[e]) +=
                d.hessian.block<3, 3>(3 * c, 3 * e);
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

// Rows by the ends of both stretches as rows by the stencil.
template <class Rows>
Eigen::MatrixXd spread(const Rows& rows, const Nearest& near, Eigen::Index size) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows.rows(), size);
    for (int c = 0; c < 4; ++c)
        all.template middleCols<3>(3 * near.local[c]) += rows.template middleCols<3>(3 * c);
    return all;
}

// Both bars touch at one point, which turns with each of them; tractions turn with the first one.
void LineGaps::grip(const double* X, int A, bool gradients, Grip& out) const {
    Nearest near;
    if (!nearest(X, A, near)) return;
    const CrossingDerivatives d = differentiate(near.stretches, near.crossing);
    const auto& stencil = stencils_[A];
    const Eigen::Index size = 3 * static_cast<Eigen::Index>(stencil.size());
    const Vector3 n = d.normal;
    const double rest = d.apart - frames_.radius;  // from the middle of the second bar to where they touch
    Eigen::MatrixXd N, first, second;
    if (gradients) {
        N = spread(d.normals, near, size);
        first = -frames_.radius * N;
        second = n * spread(d.aparts.transpose(), near, size) + rest * N;
    }
    const Eigen::MatrixXd places = spread(d.places, near, size);
    for (int c = 0; c < 4; ++c) {
        const int i = c / 2;
        const double sign = (i == 0 ? -1 : 1) * (c % 2 == 0 ? -1 : 1), s = near.crossing.place[i];
        const Share share{c % 2 == 0 ? -sign * (1 - s) : sign * s, sign * places.row(i)};
        const int own = near.local[c] + 1;
        if (i == 1 || turns()) {
            add_arm(X + 3 * stencil[own], own, (i == 0 ? -frames_.radius : rest) * n, i == 0 ? first : second,
                    share, out);
        } else {
            out.weight[near.local[c]] += share.value;
            if (gradients) out.weight_gradient.row(near.local[c]) += share.gradient;
        }
    }
    const int origin = turns() ? 1 : near.local[2] + 1;
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
