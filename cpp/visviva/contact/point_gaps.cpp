#include "visviva/contact/point_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "visviva/base/parallel.hpp"
#include "visviva/contact/way_about.hpp"

namespace visviva {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using At = Eigen::Map<const Vector3>;

PointGaps::PointGaps(Skin skin, PointOptions options) : Gaps(std::move(skin)), options_(std::move(options)) {
    n_ = static_cast<int>(options_.areas.size()), copies_ = options_.copies;
    stencils_.resize(n_), sides_.resize(n_), left_.resize(n_), come_.resize(n_);
    Skin whole = skin_;
    if (!options_.facets.empty()) whole.facets = options_.facets;
    if (!options_.facets.empty() || (skin_.n_first > 0 && deforms(0))) around_.build(whole);
}

// --- the way in --------------------------------------------------------------------------------------------
Vector3 PointGaps::nudged(const double* X, int A) const {
    constexpr double rounding = 1e-9;
    const auto known = std::find_if(middles_.begin(), middles_.end(), [&](auto& m) { return m.X == X; });
    const Vector3 middle = known == middles_.end() ? middle_at(X) : known->place;
    Vector3 inwards = rounding * (middle - At(X + 3 * A));
    if (flush_ > 0 && !around_.corners.empty())
        inwards -= std::sqrt(3.0) * flush_ * around_.by_angles(X, A % (n_ / options_.copies)).normalized();
    return At(X + 3 * A) + inwards;
}

// By areas, so that it stays where it is as meshes are refined in parts.
Vector3 PointGaps::middle_at(const double* X) const {
    Vector3 sum = Vector3::Zero();
    double area = 0;
    for (int A = 0; A < n_; ++A) sum += options_.areas[A] * At(X + 3 * A), area += options_.areas[A];
    return sum / area;
}

void PointGaps::find_middles(std::initializer_list<const double*> configurations) const {
    middles_.clear();
    for (const double* X : configurations)
        if (X) middles_.push_back({X, middle_at(X)});
}

// What comes in by a side that it does not face has been in there before its corner: it lies on another side,
// deep by what the step took, and the corner slid off that and comes back. It would be pushed out where
// nothing holds what goes on from there.
bool PointGaps::looks(const double* X, int A, const Vector3& normal) const {
    if (around_.corners.empty()) return true;
    const int own = A % (n_ / options_.copies);
    Vector3 out = around_.by_angles(X, own).normalized();
    if (deforms(own) && !around_.normal(X, own, out.data())) return true;
    return out.dot(normal) < facing;
}

// A potential is one of the sides that a corner may have touched: by others it goes in and out freely.
int PointGaps::side(const double* X, int A) const {
    if (sides_.start().empty()) return Sides::nearest;
    if (deforms(A)) return side_of_node(X, A);
    const int kept = sides_.of(A).face;
    if (kept >= 0 && keeps_) return kept;
    const double* start = sides_.start().data();
    if (is_inside(X, A)) return side_inside(X, A, kept);
    const int out = kept < 0 ? Sides::nearest : entrance(X, start, A);
    return out < 0 || touches(start, A, out) ? Sides::nearest : kept;
}

// What sags over an edge goes in and out below that by sides that it does not face, freely: gaps would jump
// from the distance to these to the depth below the others. Multipliers have no energy to be let go.
int PointGaps::side_of_node(const double* X, int A) const {
    if (static_ || around_.corners.empty()) return Sides::nearest;
    const int kept = sides_.of(A).face;
    const double* start = sides_.start().data();
    const bool inside = is_inside(X, A);
    if (inside == (kept >= 0) || (!inside && keeps_)) return Sides::nearest;
    const int passed = inside ? entrance(start, X, A) : entrance(X, start, A);
    if (passed < 0 || touches(inside ? X : start, A, passed)) return Sides::nearest;
    return inside ? Sides::none : kept;
}

int PointGaps::side_inside(const double* X, int A, int kept) const {
    const double* start = sides_.start().data();
    if (kept < 0) {
        int came = entrance(start, X, A);
        // what is barely inside may have come in by a side that it sags past all the same
        if (const int near = nearest_side(X, A); came < 0 && !keeps_ && swings_by(X, A, near)) came = near;
        if (came < 0 || (keeps_ && !sagged(start, A, came)) || touches(start, A, came)) return came;
        const int face = touched(X, A, came);
        return static_ || lands(X, A, came, face) ? face : Sides::none;
    }
    const int near = nearest_side(X, A);
    if (near < 0 || are_same(X, kept, near)) return Sides::nearest;
    return touches(start, A, near) && slides_out(X, A, kept, near) ? Sides::nearest : kept;
}

// Whether what comes by a wall that another body covers was above the face beside it where the step began: as
// on one floor it lands on that.
bool PointGaps::lands(const double* X, int A, int wall, int face) const {
    return face >= 0 && covers_.has(1) && depth(start(), A, face) <= 0 && goes_by(X, A, wall, false);
}

// Of the second body the wall is covered, in front of the edge at which the face begins; of the first one the
// vertex itself, a corner, is. All of it where the step began.
bool PointGaps::is_flush(const double* X, int A, const Plane& wall, const Plane& face) const {
    constexpr double beside = 1e-3;  // so far from a corner to the middle: as wide bodies end there
    if (!start() || deforms(A) || !covers_.has_any()) return false;
    const Vector3& w = wall.normal;
    const Vector3 up = (face.normal - face.normal.dot(w) * w).normalized();
    const double above = (face.height - wall.height * face.normal.dot(w)) / face.normal.dot(up);
    const std::vector<int> all = others(A);
    const RigidMotion body(start(), X, all, std::vector<double>(all.size(), 1.0));
    const Vector3 edge = body.back(At(X + 3 * A) - wall.height * w - above * up),
                  front = body.turn.transpose() * w, top = body.turn.transpose() * face.normal;
    const At x(start() + 3 * A);
    const double height = (x - edge).dot(top);
    if (covers_.leads_over(1, {edge, top, front, x, height})) return true;
    Vector3 inwards = beside * (middle_at(start()) - x);
    const bool is_behind = inwards.dot(top) > 0 && inwards.dot(front) > 0;
    if (!covers_.has(0) || around_.corners.empty() || !is_behind) return false;
    inwards -= inwards.dot(front) * front;
    inwards -= inwards.dot(top) * top;
    return covers_.leads_over(0, {x + inwards, -top, -front, edge, height});
}

// Whether a vertex has come out by one side by more than it has gone in by the other one, which was nearer:
// where both are as near the gap is the same.
bool PointGaps::slides_out(const double* X, int A, int in, int out) const {
    const double* start = sides_.start().data();
    const double in_before = depth(start, A, in), out_before = depth(start, A, out);
    return in_before <= out_before && out_before - depth(X, A, out) > depth(X, A, in) - in_before;
}

// A vertex that slides along inside goes from facet to facet of its side, so that the side turns with a
// curved surface and does not end at some angle from where it came in. The force on what is found inside
// begins from zero, so that it has no energy but what it has been given.
Entered PointGaps::find_side(const double* X, int A) const {
    const int came = side(X, A);
    if (came == Sides::none) {
        const int face = touched(X, A, Sides::nearest);
        return {face, face < 0 || keeps_ ? 0.0 : std::max(depth(X, A, face), 0.0)};
    }
    const int near = nearest_side(X, A);
    const bool follows = near >= 0 && came >= 0 && are_same(X, came, near);
    const int face = came < 0 || follows ? near : came;
    const double before = sides_.of(A).offset;
    return {face, before > 0 && face >= 0 ? std::clamp(depth(X, A, face), 0.0, before) : 0.0};
}

bool PointGaps::settle(const double* X) {
    find_middles({X, start()});
    const std::vector<Entered> before = sides_.all();
    const bool changed = sides_.settle({X, X + skin_.constant.size()}, [&](std::vector<Entered>& sides) {
        for (int A = 0; A < n_; ++A)
            if (is_inside(X, A)) sides[A] = find_side(X, A);
    });
    for (int A = 0; A < n_; ++A) {
        const Entered& now = sides_.of(A);
        left_[A] = before[A].face >= 0 && now.face < 0;
        come_[A] = before[A].face < 0 && now.face >= 0 && now.offset > 0;
    }
    return changed;
}

// The way of a vertex' stencil in a step, seen by the other body: straight, but for what turns.
class PointGaps::Path {
  public:
    Path(const PointGaps& gaps, const double* from, const double* to, const Matrix3& turn, int A)
        : gaps_(gaps), from_(from), to_(to), A_(A), others_(gaps.others(A)) {
        const std::vector<double> alike(others_.size(), 1.0);
        other_ = RigidMotion(from, to, others_, alike);
        even_ = EvenWay(other_.turn.transpose() * turn);
        double straight = 0, round = 0;
        for (const int v : gaps.stencils_[A]) {
            Vector3 rate = other_.back(At(to + 3 * v)) - At(from + 3 * v);
            const bool beyond = std::find(others_.begin(), others_.end(), v) != others_.end();
            if (!beyond) rate = even_.rate(rate);
            rates_.push_back({rate, beyond});
            double& farthest = beyond ? straight : round;
            farthest = std::max(farthest, rate.norm());
        }
        length = straight + round;
    }
    double length;  // bound of the motion relative to each other
    double gap(double t) const { return near(t, 0).value - gaps_.options_.radius; }
    /// Zero where nothing is near.
    Vector3 normal(double t) const {
        const Distance d = near(t, 1);
        if (d.gradient.size() == 0) return Vector3::Zero();
        const Vector3 n = gaps_.push(d, A_).normalized();
        return t == 1 ? Vector3(other_.turn.transpose() * n) : n;
    }

  private:
    Distance near(double t, int derivatives) const {
        const double* X = t == 0 ? from_ : to_;
        if (t > 0 && t < 1) {
            if (X_.empty()) X_.assign(from_, from_ + gaps_.skin_.constant.size());
            for (std::size_t k = 0; k < rates_.size(); ++k) {
                const int v = gaps_.stencils_[A_][k];
                const auto& [rate, beyond] = rates_[k];
                const Vector3 gone = beyond ? Vector3(t * rate) : even_.gone(rate, t);
                for (int i = 0; i < 3; ++i) X_[3 * v + i] = from_[3 * v + i] + gone[i];
            }
            X = X_.data();
        }
        Distance d;
        if (gaps_.distance(X, A_, derivatives, d) == Reach::near) return d;
        return {gaps_.options_.reach + gaps_.options_.radius, {}, {}};
    }
    const PointGaps& gaps_;
    const double *from_, *to_;
    int A_;
    std::vector<int> others_;
    RigidMotion other_;
    EvenWay even_;
    std::vector<std::pair<Vector3, bool>> rates_;  // of the stencil, and whether it is the other body's
    mutable std::vector<double> X_;
};

// Whether what is open at both ends of a step went through a corner on the way. Distances change by no more
// than the way: so far one may go without missing anything.
bool PointGaps::cuts_through(const Path& path, double before, double after, double near) const {
    constexpr double shallow = 0.01;  // part of the way: steps that are halved come to end in the corner
    const double least = std::max(shallow * path.length, near);
    double begin = before / path.length, end = 1 - after / path.length;
    auto step = [&](double t) { return std::max(path.gap(t), least) / path.length; };
    while (begin < end && path.gap(begin) > 0) begin += step(begin);
    while (begin < end && path.gap(end) > 0) end -= step(end);
    return begin < end && path.gap(0.5 * (begin + end)) < -least;
}

// Whether what touches at the end of a step pushes elsewhere than where it closed, and might touch there.
bool PointGaps::turns_about(const Path& path, const double* from, int A) const {
    constexpr double same = 0.5;  // least agreement of normals
    const double rounding = 1e-6 * path.length;
    const Vector3 end = path.normal(1);
    if (path.normal(0).dot(end) > same) return false;
    double open = 0, closed = 1;
    for (int halving = 0; halving < 20; ++halving) {
        const double t = 0.5 * (open + closed);
        (path.gap(t) > -rounding ? open : closed) = t;
    }
    const Vector3 begin = path.normal(open);
    return begin.dot(end) <= same && looks(from, A, begin);
}

int PointGaps::strays(const double* from, const double* to, const double* before, const double* after) const {
    find_middles({from, to, start()});
    std::vector<char> stray(n_, 0);
    std::vector<int> own(n_ / options_.copies);
    std::iota(own.begin(), own.end(), 0);
    // Nodes of a solid that touch an edge move across it by what the solid deforms: what is so near to it is
    // not judged.
    constexpr double deformation = 1e-3;
    const Vector3 middle = middles_[1].place;
    const Matrix3 turn = RigidMotion(from, to, own, options_.areas).turn;
    parallel_for(n_, [&](int A) {
        if (stencils_[A].empty() || before[A] <= 0 || sides_.of(A).offset > 0) return;
        if (before[A] + after[A] >= options_.areas[A] * way(from, to, A)) return;
        const Path path(*this, from, to, turn, A);
        const double area = options_.areas[A];
        const double near = deforms(A) ? deformation * (middle - At(to + 3 * A)).norm()
                                       : (nudged(to, A) - At(to + 3 * A)).norm();
        if (after[A] > 0)
            stray[A] = cuts_through(path, before[A] / area, after[A] / area, near);
        else if (after[A] < -near * area)
            stray[A] = turns_about(path, from, A);
    });
    const auto first = std::find(stray.begin(), stray.end(), 1);
    return first == stray.end() ? -1 : static_cast<int>(first - stray.begin());
}

void PointGaps::values(const double* X, double* gap, double* area) {
    find_middles({X, start()});
    beyond_.resize(n_);
    parallel_for(n_, [&](int A) {
        Distance d;
        const Reach reach = distance(X, A, 0, d);
        beyond_[A] = d.beyond;
        area[A] = reach == Reach::near ? options_.areas[A] : 0;
        if (!static_) d.value += sides_.of(A).offset;
        gap[A] = options_.areas[A] * (reach == Reach::near ? d.value - options_.radius : options_.reach);
    });
}

void PointGaps::gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) {
    find_middles({X, start()});
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
    find_middles({X, start()});
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
    find_middles({X, start()});
    parallel_for(n_, [&](int A) {
        if (!wanted[A]) return;
        const Eigen::Index k = stencils_[A].size();
        Grip& g = out[A];
        g.weight.setZero(k), g.turning.setZero(k), g.tangent.setZero();
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
