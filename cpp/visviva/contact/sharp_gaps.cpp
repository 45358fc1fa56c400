// Gaps between sharp parts of two rigid bodies: edges that cross, corners of the second in faces of the
// first. They count where each body is convex and looks at the other one there; what ends there or lies along
// each other has vertices that touch.
#include <algorithm>
#include <cmath>

#include "visviva/contact/sharp_pairs.hpp"
#include "visviva/contact/sides.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;
using Pair = SharpPairs::Pair;

constexpr double beside = 0.1;  // sine by which normals may lie beside those of a part: faces on each other
constexpr double coming = 0.5;  // part of an edge beyond its ends, and sine, from where a step may come
constexpr double close = 0.01;  // part of the depth that is seen, so near that what meets needs a gap
constexpr double again = 0.35;  // of the reach: so far bodies may move until the next search

/// What a gap holds in a step.
struct Held {
    Pair pair;
    bool meets = false, opens = false;  // where the step begins: whether it touches there, or is outside
    double offset = 0;                  // how deep it was found first, which stores no energy of a penalty
    bool operator==(const Held&) const = default;
};

void write_side(std::vector<double>& m, const Held& h) {
    m.insert(m.end(), {static_cast<double>(h.pair.number), h.pair.sign, h.meets ? 1.0 : 0.0,
                       h.opens ? 1.0 : 0.0, h.offset});
}

void read_side(const double*& m, Held& h) {
    h = {{static_cast<long>(m[0]), m[1]}, m[2] != 0, m[3] != 0, m[4]};
    m += 5;
}

class SharpGaps : public Gaps, public Offsets {
  public:
    SharpGaps(Skin skin, SharpOptions options);
    int n_first() const override { return options_.n_vertices; }
    const std::vector<int>& neighbours(int) const override { return all_; }
    bool search(const double* from, const double* to) override;
    bool settle(const double* X) override;
    bool set_static(bool on) override { return std::exchange(static_, on) != on; }
    void keep_sides() override { keeps_ = true; }
    Offsets* offsets() override { return this; }
    double offset(int gap) const override { return keeps_ ? 0 : held_.of(gap).offset; }
    void set_offset(int gap, double offset) override {
        Held held = held_.of(gap);
        held.offset = offset;
        held_.amend(gap, held);
    }
    void mark_tangent() override { held_.mark_tangent(); }
    void write_memory(std::vector<double>& m) const override { m.push_back(unheld_), held_.write(m); }
    void read_memory(const double*& m) override {
        unheld_ = static_cast<int>(*m++), held_.read(m);
        take_stencils();
    }
    long place(int gap) const override { return held_.of(gap).pair.number; }
    bool are_of_vertices() const override { return false; }
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
    struct Candidate {
        Held held;
        double gap;
    };
    bool sees(const double* X, const Held&) const;
    bool sees_sharp(const double* X, const Held&) const;
    bool goes_by(const Held&) const;
    bool comes(const Held&) const;
    bool is_over(const double* X, const Held&) const;
    bool sees(const double* X, int gap) const { return sees(X, held_.of(gap)); }
    std::vector<Pair> pairs_at(const double* X) const;
    bool settle_flush(const double* X, const std::vector<Pair>& pairs);
    Candidate candidate(const double* X, const Pair& pair) const;
    std::vector<Held> hold(const double* X, const std::vector<Pair>& pairs);
    void take_stencils();
    Meeting meeting(const double* X, int gap) const { return pairs_.meeting(X, held_.of(gap).pair); }

    SharpOptions options_;
    SharpPairs pairs_;
    std::vector<int> all_;  // so many vertices that all unknowns are among theirs
    std::vector<long> near_;
    SidesOf<Held> held_{{}};
    bool static_ = false, keeps_ = false;
};

SharpGaps::SharpGaps(Skin skin, SharpOptions options)
    : Gaps(std::move(skin)),
      options_(std::move(options)),
      pairs_(options_.parts, options_.depth, sags_, covers_) {
    n_ = copies_ = options_.n_gaps, flush_ = pairs_.flush();
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

bool SharpGaps::search(const double* from, const double* to) {
    near_ = pairs_.near(from, to, again * options_.reach);
    return false;  // couples all unknowns of both bodies always
}

// What was outside or touched where the last step began goes on by the side it came in. What comes to touch
// from inside, as where an edge slides past the end of another one, is held there: by penalty its force
// begins from zero, and what it has is never more than what it has been given.
SharpGaps::Candidate SharpGaps::candidate(const double* X, const Pair& pair) const {
    const auto& held = held_.all();
    const auto before = std::find_if(held.begin(), held.end(), [&](const Held& h) { return h.pair == pair; });
    const double gap = pairs_.meeting(X, pair).distance, deep = std::max(-gap, 0.0);
    const bool is_new = before == held.end(), stays = !is_new && before->meets && !goes_by(*before);
    Held next{pair, pairs_.meets(X, pair, 0, beside, stays), gap >= 0, 0};
    if (stays && !next.meets)
        next.meets =
            pairs_.leaves(held_.start().data(), X, pair) && pairs_.meets(X, pair, HUGE_VAL, beside, stays);
    if (next.meets && !static_ && !held_.start().empty())
        next.offset = is_new || !sees(X, *before) ? deep : std::min(before->offset, deep);
    return {next, gap};
}

std::vector<Pair> SharpGaps::pairs_at(const double* X) const {
    std::vector<Pair> pairs;
    for (const long p : near_) {
        if (pairs_.is_apart(X, p)) continue;
        for (const double sign : {1.0, -1.0}) {
            if (sign < 0 && !pairs_.has_signs(p)) continue;
            if (const Pair pair{p, sign};
                pairs_.meets(X, pair, coming, coming) && !pairs_.is_flush(X, X, pair))
                pairs.push_back(pair);
        }
    }
    return pairs;
}

bool SharpGaps::settle_flush(const double* X, const std::vector<Pair>& pairs) {
    std::vector<double> offsets;
    for (const Pair& pair : pairs) pairs_.add_offsets(X, pair, offsets);
    const bool changed = pairs_.settle_flush(std::move(offsets));
    flush_ = pairs_.flush();
    return changed;
}

// Pairs keep their gap from step to step unless another one wants it, and it follows from places alone. Those
// that meet come first, and then what is nearest to that.
std::vector<Held> SharpGaps::hold(const double* X, const std::vector<Pair>& pairs) {
    std::vector<Candidate> found;
    for (const Pair& pair : pairs) found.push_back(candidate(X, pair));
    auto sooner = [](const Candidate& a, const Candidate& b) {
        return std::pair(!a.held.meets, a.gap) < std::pair(!b.held.meets, b.gap);
    };
    std::stable_sort(found.begin(), found.end(), sooner);
    const auto meets = [&](const Candidate& c) { return c.held.meets && c.gap < close * options_.depth; };
    unheld_ = std::max(0, static_cast<int>(std::count_if(found.begin(), found.end(), meets)) - n_);
    if (static_cast<int>(found.size()) > n_) found.resize(n_);
    std::stable_sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
        return a.held.pair.number < b.held.pair.number;
    });
    std::vector<Held> held(n_);
    for (const Candidate& c : found) {
        long gap = c.held.pair.number % n_;
        while (held[gap].pair.number >= 0) gap = (gap + 1) % n_;
        held[gap] = c.held;
    }
    return held;
}

bool SharpGaps::settle(const double* X) {
    const std::vector<double> here{X, X + skin_.constant.size()};
    const std::vector<Held> before = held_.all();
    left_.assign(n_, 0), come_.assign(n_, 0);
    const std::vector<Pair> pairs = pairs_at(X);
    const bool other = settle_flush(X, pairs);
    if (!held_.settle(here, [&](std::vector<Held>& held) { held = hold(X, pairs); })) return other;
    take_stencils();
    const auto& now = held_.all();
    const auto is_among = [](const std::vector<Held>& all, const Held& one) {
        return std::any_of(all.begin(), all.end(), [&](auto& h) { return h.meets && h.pair == one.pair; });
    };
    for (int A = 0; A < n_; ++A) {
        left_[A] = before[A].meets && !is_among(now, before[A]);
        come_[A] = now[A].meets && now[A].offset > 0 && !is_among(before, now[A]);
    }
    return true;
}

void SharpGaps::take_stencils() {
    for (int A = 0; A < n_; ++A) {
        stencils_[A].clear();
        if (held_.of(A).pair.number < 0) continue;
        const auto stencil = pairs_.stencil(held_.of(A).pair.number);
        stencils_[A].assign(stencil.begin(), stencil.end());
    }
}

// What has come in from outside, and been held, stays.
bool SharpGaps::goes_by(const Held& held) const {
    const bool is_free = !held_.start().empty() && (held.opens || held.offset > 0);
    return is_free && pairs_.has_sagged(held_.start().data(), held.pair);
}

// Of a corner that was above a face where the step began.
bool SharpGaps::comes(const Held& held) const {
    return covers_.has(0) && !held.meets && !keeps_ && !static_ && !pairs_.has_signs(held.pair.number) &&
           !held_.start().empty();
}

// Whether such a corner is above the plane of the face, or over a body that is flush with that, where the
// plane goes on: the way in is one.
bool SharpGaps::is_over(const double* X, const Held& held) const {
    return pairs_.meeting(X, held.pair).distance >= 0 ||
           pairs_.is_over_flush(held_.start().data(), X, held.pair);
}

// What multipliers hold in time they hold for the whole of a step, wherever that leads. So do penalties with
// what lies in the other body: what slides off would fall for the rest of that.
bool SharpGaps::sees(const double* X, const Held& held) const {
    const bool is_seen = held.pair.number >= 0 && sees_sharp(X, held);
    return is_seen &&
           (static_ || held_.start().empty() || !pairs_.is_flush(held_.start().data(), X, held.pair));
}

bool SharpGaps::sees_sharp(const double* X, const Held& held) const {
    if (static_) return pairs_.meets(X, held.pair, 0, beside, false);
    if ((!held.meets && !held.opens) || goes_by(held)) return false;
    if (keeps_) return held.meets && pairs_.meeting(X, held.pair).sine > 0;
    if (comes(held)) {
        if (is_over(X, held)) return pairs_.meets(X, held.pair, HUGE_VAL, beside);
        if (pairs_.comes_past(held_.start().data(), X, held.pair)) return false;
    }
    const bool crosses = pairs_.has_signs(held.pair.number);
    const bool is_open = pairs_.meeting(X, held.pair).distance >= 0,
               comes_in = crosses && held.opens && !is_open;
    if (comes_in && !pairs_.touch(held_.start().data(), X, held.pair)) return false;
    // Edges deep in each other that were held from there are so where they cross alone: who lies in whom they
    // do not tell.
    const bool stays = held.meets && held.offset < close * options_.depth;
    const bool lies =
        crosses ? stays || (comes_in && pairs_.slides_in(X, held.pair)) : held.meets && !held.opens;
    return pairs_.meets(X, held.pair, lies ? HUGE_VAL : 0, beside, held.meets);
}

void SharpGaps::values(const double* X, double* gap, double* area) {
    for (int A = 0; A < n_; ++A) {
        const bool near = sees(X, A);
        const double least = near && comes(held_.of(A)) && is_over(X, held_.of(A)) ? 0 : -HUGE_VAL;
        area[A] = near ? 1 : 0;
        gap[A] = near ? std::max(meeting(X, A).distance, least) + (static_ ? 0 : offset(A)) : options_.depth;
    }
}

void SharpGaps::gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) {
    for (int A = 0; A < n_; ++A) {
        if (!wanted[A]) continue;
        out[A].gradient.assign(3 * stencils_[A].size(), 0.0);
        if (!sees(X, A)) continue;
        const Meeting::Row g = meeting(X, A).gradient();
        out[A].gradient.assign(g.begin(), g.end());
    }
}

void SharpGaps::seconds(const double* X, const std::vector<double>& S, const double* direction,
                        std::vector<Gap>& out) {
    for (int A = 0; A < n_; ++A) {
        if (S[A] == 0) continue;
        Meeting::Row g = Meeting::Row::Zero();
        Eigen::Matrix<double, 12, 12> H = Eigen::Matrix<double, 12, 12>::Zero();
        if (sees(X, A)) {
            const Meeting pair = meeting(X, A);
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

// Both bodies touch where they are nearest; tractions turn with an edge of the first. Faces turn by
// themselves: corners that come at them would seem to turn both, and to slip.
void SharpGaps::grips(const double* X, const std::vector<char>& wanted, bool gradients,
                      std::vector<Grip>& out) {
    for (int A = 0; A < n_; ++A) {
        if (!wanted[A]) continue;
        const Eigen::Index k = static_cast<Eigen::Index>(stencils_[A].size());
        Grip& g = out[A];
        g.weight.setZero(k), g.turning.setOnes(k), g.tangent.setZero();
        g.weight_gradient.setZero(gradients ? k : 0, 3 * k);
        for (auto& t : g.tangent_gradient) t.setZero(3, 3 * k);
        if (!sees(X, A)) continue;
        if (!pairs_.has_signs(held_.of(A).pair.number)) g.turning[3] = 0;
        const Meeting pair = meeting(X, A);
        g.weight = -pair.shares;
        Eigen::MatrixXd N;
        if (gradients) {
            const Meeting::Derivatives d = pair.derivatives();
            N = d.normal;
            g.weight_gradient = -d.shares;
        }
        const Vector3 edge = At(X + 3 * stencils_[A][1]) - At(X + 3 * stencils_[A][0]);
        set_tangents(skin_.dim, pair.normal, gradients ? &N : nullptr, edge, 0, 1, g);
    }
}

}  // namespace

std::unique_ptr<Gaps> make_sharp_gaps(Skin skin, SharpOptions options) {
    return std::make_unique<SharpGaps>(std::move(skin), std::move(options));
}

}  // namespace visviva
