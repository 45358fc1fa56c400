// Gaps between edges of two rigid bodies that cross: the distance of their lines, where these are nearest
// within both edges and each body is convex and looks at the other one there. What holds edges that end or
// lie along each other are vertices and facets.
#include <algorithm>
#include <cmath>

#include "visviva/contact/gaps.hpp"
#include "visviva/contact/line_pair.hpp"
#include "visviva/contact/search.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

constexpr double parallel = 1e-2;  // sine of an angle below which edges do not cross
constexpr double at_end = 1e-6;    // part of an edge by which places at its ends are none of it
constexpr double beside = 0.1;  // sine by which a normal may lie beside those of an edge: faces on each other
constexpr double coming = 0.5;  // part of an edge beyond its ends, and sine, from where a step may come
constexpr double again = 0.35;  // of the reach: so far bodies may move until the next search

class EdgeGaps : public Gaps {
  public:
    EdgeGaps(Skin skin, EdgeOptions options);
    int copies() const override { return n_; }
    int n_first() const override { return options_.n_vertices; }
    const std::vector<int>& neighbours(int) const override { return all_; }
    bool search(const double* from, const double* to) override;
    bool settle(const double* X) override;
    bool set_static(bool on) override { return std::exchange(static_, on) != on; }
    void keep_sides() override { keeps_ = true; }
    long place(int gap) const override { return held_[gap].place; }
    void values(const double* X, double* gap, double* area) override;
    void approaches(const double*, const double*, std::vector<Approach>& out) const override {
        out.assign(n_, {options_.depth, 0});  // half of that is too deep; what passes whole edges is watched
    }
    void gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) override;
    void seconds(const double* X, const std::vector<double>& S, const double* direction,
                 std::vector<Gap>& out) override;
    void grips(const double* X, const std::vector<char>& wanted, bool gradients,
               std::vector<Grip>& out) override;

  private:
    // Two edges, numbered like all pairs of them, with the sign of their normal.
    struct Held {
        long place = -1;
        double sign = 0;
        bool meets = false;  // where the step begins
        bool operator==(const Held&) const = default;
    };
    struct Candidate {
        Held held;
        double gap;
    };
    long n_second() const { return static_cast<long>(options_.edges.size()) / 4 - options_.n_first; }
    const int* edge(long place, int side) const {
        return &options_.edges[4 * (side == 0 ? place / n_second() : options_.n_first + place % n_second())];
    }
    LinePair lines(const double* X, const Held& held) const;
    bool looks(const double* X, const int* edge, const Vector3& n, double tolerance) const;
    bool meets(const double* X, const Held& held, double beyond, double sine) const;
    bool is_apart(const double* X, long place) const;
    bool sees(const double* X, int gap) const;
    void find(const double* X, std::vector<Candidate>& found) const;
    double size(const double* X, long place, int side) const {
        return (At(X + 3 * edge(place, side)[1]) - At(X + 3 * edge(place, side)[0])).norm();
    }

    EdgeOptions options_;
    std::vector<int> all_;  // so many vertices that all unknowns are among theirs
    std::vector<long> near_;
    std::vector<Held> held_;
    bool static_ = false, keeps_ = false;
};

EdgeGaps::EdgeGaps(Skin skin, EdgeOptions options) : Gaps(std::move(skin)), options_(std::move(options)) {
    n_ = options_.n_gaps;
    stencils_.resize(n_), held_.resize(n_);
    std::vector<int> seen;
    for (int v = 0; v < skin_.n_vertices(); ++v) {
        bool is_new = false;
        for (int k = skin_.first[v]; k < skin_.first[v + 1]; ++k)
            if (std::find(seen.begin(), seen.end(), skin_.unknown[k]) == seen.end())
                seen.push_back(skin_.unknown[k]), is_new = true;
        if (is_new) all_.push_back(v);
    }
}

LinePair EdgeGaps::lines(const double* X, const Held& held) const {
    const int *one = edge(held.place, 0), *two = edge(held.place, 1);
    return {At(X + 3 * one[0]), At(X + 3 * one[1]), At(X + 3 * two[0]), At(X + 3 * two[1]), held.sign};
}

// Whether a unit vector across an edge lies between the normals of the facets beside it.
bool EdgeGaps::looks(const double* X, const int* edge, const Vector3& n, double tolerance) const {
    const Vector3 a = At(X + 3 * edge[0]), along = (At(X + 3 * edge[1]) - a).normalized();
    const Vector3 left = along.cross(At(X + 3 * edge[2]) - a).normalized(),
                  right = (At(X + 3 * edge[3]) - a).cross(along).normalized();
    return left.cross(n).dot(along) >= -tolerance && n.cross(right).dot(along) >= -tolerance &&
           n.dot(left + right) > 0;
}

// What is nearer to the end of an edge than half as deep leaves past that, and by what touches there: so does
// the vertical edge of a box that has sunk a little into another one on which it stands.
bool EdgeGaps::meets(const double* X, const Held& held, double beyond, double sine) const {
    const LinePair pair = lines(X, held);
    if (pair.sine < parallel || std::abs(pair.distance) > options_.depth) return false;
    const double lengths[2] = {pair.e.norm(), pair.f.norm()};
    for (int side : {0, 1}) {
        const double place = pair.place[side], from_end = std::min(place, 1 - place);
        if (from_end < -beyond) return false;
        if (beyond <= 0 && -pair.distance > 2 * from_end * lengths[side]) return false;
    }
    return looks(X, edge(held.place, 0), -pair.normal, sine) &&
           looks(X, edge(held.place, 1), pair.normal, sine);
}

bool EdgeGaps::is_apart(const double* X, long place) const {
    Vector3 middle[2];
    for (int side : {0, 1})
        middle[side] = 0.5 * (At(X + 3 * edge(place, side)[0]) + At(X + 3 * edge(place, side)[1]));
    const double sizes = size(X, place, 0) + size(X, place, 1);
    return (middle[1] - middle[0]).norm() > (0.5 + coming) * sizes + options_.depth;
}

bool EdgeGaps::search(const double* from, const double* to) {
    std::vector<Box> boxes;
    for (std::size_t k = 0; k < options_.edges.size(); k += 4) {
        Box box{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
        for (const double* X : {from, to})
            for (int end : {0, 1})
                for (int i = 0; i < 3; ++i) {
                    const double x = X[3 * options_.edges[k + end] + i], margin = again * options_.reach;
                    box.low[i] = std::min(box.low[i], x - margin);
                    box.high[i] = std::max(box.high[i], x + margin);
                }
        boxes.push_back(box);
    }
    near_.clear();
    for (long p = 0; p < options_.n_first * n_second(); ++p)
        if (boxes[p / n_second()].meets(boxes[options_.n_first + p % n_second()])) near_.push_back(p);
    return false;  // couples all unknowns of both bodies always
}

// Those that meet, and then what is nearest to that.
void EdgeGaps::find(const double* X, std::vector<Candidate>& found) const {
    for (const long p : near_) {
        if (is_apart(X, p)) continue;
        for (const double sign : {1.0, -1.0}) {
            Held held{p, sign, false};
            if (!meets(X, held, coming, coming)) continue;
            held.meets = meets(X, held, -at_end, beside);
            found.push_back({held, lines(X, held).distance});
        }
    }
    auto sooner = [](const Candidate& a, const Candidate& b) {
        return std::pair(!a.held.meets, a.gap) < std::pair(!b.held.meets, b.gap);
    };
    std::stable_sort(found.begin(), found.end(), sooner);
}

// Pairs keep their gap from step to step unless another one wants it, and it follows from places alone.
bool EdgeGaps::settle(const double* X) {
    std::vector<Candidate> found;
    find(X, found);
    if (static_cast<int>(found.size()) > n_) found.resize(n_);
    std::stable_sort(found.begin(), found.end(),
                     [](const Candidate& a, const Candidate& b) { return a.held.place < b.held.place; });
    std::vector<Held> held(n_);
    for (const Candidate& c : found) {
        long gap = c.held.place % n_;
        while (held[gap].place >= 0) gap = (gap + 1) % n_;
        held[gap] = c.held;
    }
    if (held == held_) return false;
    held_ = std::move(held);
    for (int A = 0; A < n_; ++A) {
        stencils_[A].clear();
        if (held_[A].place < 0) continue;
        for (int side : {0, 1})
            for (int end : {0, 1}) stencils_[A].push_back(edge(held_[A].place, side)[end]);
    }
    return true;
}

// What multipliers hold in time they hold for the whole of a step, wherever that leads.
bool EdgeGaps::sees(const double* X, int A) const {
    const Held& held = held_[A];
    if (held.place < 0) return false;
    if (keeps_ && !static_) return held.meets && lines(X, held).sine > 0;
    return meets(X, held, -at_end, beside);
}

void EdgeGaps::values(const double* X, double* gap, double* area) {
    for (int A = 0; A < n_; ++A) {
        const bool near = sees(X, A);
        area[A] = near ? 1 : 0;
        gap[A] = near ? lines(X, held_[A]).distance : options_.depth;
    }
}

void EdgeGaps::gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) {
    for (int A = 0; A < n_; ++A) {
        if (!wanted[A]) continue;
        out[A].gradient.assign(3 * stencils_[A].size(), 0.0);
        if (!sees(X, A)) continue;
        const LinePair::Row g = lines(X, held_[A]).gradient();
        out[A].gradient.assign(g.begin(), g.end());
    }
}

void EdgeGaps::seconds(const double* X, const std::vector<double>& S, const double* direction,
                       std::vector<Gap>& out) {
    for (int A = 0; A < n_; ++A) {
        if (S[A] == 0) continue;
        LinePair::Row g = LinePair::Row::Zero();
        Eigen::Matrix<double, 12, 12> H = Eigen::Matrix<double, 12, 12>::Zero();
        if (sees(X, A)) {
            const LinePair pair = lines(X, held_[A]);
            g = pair.gradient(), H = pair.derivatives().hessian;
        }
        out[A].gradient.assign(g.begin(), g.end());
        if (direction) {
            Eigen::Matrix<double, 12, 1> D;
            for (int v = 0; v < 4; ++v) D.segment<3>(3 * v) = At(direction + 3 * stencils_[A][v]);
            const Eigen::Matrix<double, 12, 1> along = H * D;
            out[A].along.assign(along.begin(), along.end());
        }
        H *= S[A];
        out[A].hessian.assign(H.data(), H.data() + H.size());
    }
}

// Both bodies touch where their edges are nearest; tractions turn with the first edge.
void EdgeGaps::grips(const double* X, const std::vector<char>& wanted, bool gradients,
                     std::vector<Grip>& out) {
    for (int A = 0; A < n_; ++A) {
        if (!wanted[A]) continue;
        const Eigen::Index k = static_cast<Eigen::Index>(stencils_[A].size());
        Grip& g = out[A];
        g.weight.setZero(k), g.turning.setOnes(k), g.tangent.setZero();
        g.weight_gradient.setZero(gradients ? k : 0, 3 * k);
        for (auto& t : g.tangent_gradient) t.setZero(3, 3 * k);
        if (!sees(X, A)) continue;
        const LinePair pair = lines(X, held_[A]);
        g.weight = -pair.shares();
        Eigen::MatrixXd N;
        if (gradients) {
            const LinePair::Derivatives d = pair.derivatives();
            N = d.normal;
            g.weight_gradient << d.place[0], -d.place[0], -d.place[1], d.place[1];
        }
        set_tangents(skin_.dim, pair.normal, gradients ? &N : nullptr, pair.e, 0, 1, g);
    }
}

}  // namespace

std::unique_ptr<Gaps> make_edge_gaps(Skin skin, EdgeOptions options) {
    return std::make_unique<EdgeGaps>(std::move(skin), std::move(options));
}

}  // namespace visviva
