// Valleys: facets that lean together over a vertex hold it together, each by a copy of the vertex of its own.
// One alone would let it sink into the others, and the next step hold it by another one, deeper and deeper.
#include <algorithm>
#include <cmath>

#include "visviva/contact/node_to_segment.hpp"

namespace visviva::node_to_segment {

// What a vertex touches.
struct NodeToSegment::Touched {
    const Candidate* candidate;
    FacetShape facet;
    Foot foot;
    Vector3 place, normal;  // of the closest point; of the simplex
    double above = 0;
    bool leans_to(const Touched& o, double part) const {
        return lean_together(facet, foot.simplex, o.facet, o.foot.simplex, part);
    }
};

// Simplices that a ball touches from outside, or whose planes a point, which lies inside, is behind.
std::vector<NodeToSegment::Touched> NodeToSegment::touched(const double* X, int A) const {
    const At x(X + 3 * A);
    const double r = options_.radius, rounding = closed * options_.reach;
    std::vector<Touched> all;
    for (const Candidate& c : candidates_[A]) {
        const FacetShape facet = shape(X, c.facet);
        for (int s = 0; s < facet.n_simplices(); ++s) {
            Touched t{&c, facet, closest(facet, s, x), Vector3::Zero(), facet.normal(s)};
            if (t.normal.isZero() || t.foot.distance > options_.reach + r) continue;
            t.place = facet.place(t.foot);
            t.above = facet.height(s, x);
            const bool meets = t.foot.distance <= r + rounding;
            if (r > 0 ? t.above > 0 && meets : t.above <= rounding) all.push_back(t);
        }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](auto& a, auto& b) { return a.foot.distance < b.foot.distance; });
    return all;
}

// Of these, whether a point has come below them: what is nearest, what it lies straight below, and what goes
// on from there without an edge that is convex. Planes of others go on through the whole body.
std::vector<char> NodeToSegment::below(const std::vector<Touched>& all) const {
    std::vector<char> found(all.size(), 0);
    std::vector<std::size_t> next;
    const auto nearest = std::min_element(all.begin(), all.end(),
                                          [](auto& a, auto& b) { return a.foot.distance < b.foot.distance; });
    if (nearest != all.end()) next.push_back(nearest - all.begin());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double beside = all[i].foot.distance * all[i].foot.distance - all[i].above * all[i].above;
        if (beside <= std::pow(apart * all[i].facet.size(), 2)) next.push_back(i);
    }
    for (std::size_t k : next) found[k] = 1;
    while (!next.empty()) {
        const Touched& from = all[next.back()];
        next.pop_back();
        for (std::size_t i = 0; i < all.size(); ++i)
            if (!found[i] && from.leans_to(all[i], -apart) && goes_on(from, all[i]))
                found[i] = 1, next.push_back(i);
    }
    return found;
}

// Whether a simplex reaches the closest point of another one.
bool NodeToSegment::goes_on(const Touched& other, const Touched& t) {
    return closest(other.facet, other.foot.simplex, t.place).distance <= apart * t.facet.size();
}

// Of these, from the nearest on, those that each are a bottom of the distance, or that lean together.
std::vector<NodeToSegment::Touched> NodeToSegment::bottoms(const std::vector<Touched>& all) const {
    std::vector<Touched> kept;
    const bool is_ball = options_.radius > 0;
    const std::vector<char> is_below = is_ball ? std::vector<char>() : below(all);
    for (auto t = all.begin(); t != all.end(); ++t) {
        const bool new_one =
            is_ball ? std::none_of(all.begin(), t, [&](const Touched& near) { return goes_on(near, *t); })
                    : std::all_of(kept.begin(), kept.end(), [&](auto& k) { return k.leans_to(*t, apart); }) &&
                          (t == all.begin() || is_below[t - all.begin()]);
        if (new_one) kept.push_back(*t);
    }
    if (static_cast<int>(kept.size()) > options_.copies) spread(kept);
    return kept;
}

// Of more than there are copies the nearest and those that are turned farthest from each other: from all
// around they leave no way down.
void NodeToSegment::spread(std::vector<Touched>& kept) const {
    for (int n = 1; n < options_.copies; ++n) {
        auto agreement = [&](const Touched& t) {
            double most = -1;
            for (int k = 0; k < n; ++k) most = std::max(most, kept[k].normal.dot(t.normal));
            return most;
        };
        const auto next = std::min_element(kept.begin() + n, kept.end(),
                                           [&](auto& a, auto& b) { return agreement(a) < agreement(b); });
        std::rotate(kept.begin() + n, next, next + 1);
    }
    kept.erase(kept.begin() + options_.copies, kept.end());
}

// What the copies of a vertex hold in the step that begins. What touches a single facet may slide over its
// edges within the step.
void NodeToSegment::share_out(const double* X, int A) {
    Found nearest, own;
    if (locate_nearest(X, A, At(X + 3 * A), nearest) != Reach::near) return;
    // what hovers above the nearest one, however little, is not behind what lies beyond the body
    const bool is_ball = options_.radius > 0;
    const double least = is_ball ? same_place * nearest.facet.size() : closed * options_.reach;
    if ((nearest.value <= least) == is_ball) return;
    std::vector<Touched> all = touched(X, A);
    const bool is_near = locate(X, A, own) == Reach::near;
    auto is_own = [&](const Touched& t) {
        return is_near && t.candidate == own.candidate && t.foot.simplex == own.foot.simplex;
    };
    if (!is_ball) std::stable_partition(all.begin(), all.end(), is_own);
    std::vector<Touched> kept = bottoms(all);
    const bool is_open = is_near && own.value - options_.radius > closed * options_.reach;
    if (kept.empty() || (kept.size() == 1 && !is_open)) return;
    std::sort(kept.begin(), kept.end(), [](auto& a, auto& b) {
        return std::pair(a.candidate->facet, a.foot.simplex) < std::pair(b.candidate->facet, b.foot.simplex);
    });
    for (std::size_t k = 0; k < kept.size(); ++k) {
        const Touched& t = kept[k];
        Held& held = held_[A + static_cast<int>(k) * n_own()];
        held = {t.candidate->facet, t.foot.simplex, is_ball ? t.foot.n : t.facet.dim, {}};
        if (held.n < t.facet.dim) std::copy_n(t.foot.vertex, held.n, held.vertex);
    }
}

long NodeToSegment::place(int A) const {
    const Held& held = held_[A];
    long number = held.facet < 0 ? kept_[A].facet : held.facet;
    auto add = [&](int digit) { number = number * (FacetShape::centre + 1) + digit; };
    add(held.facet < 0 ? kept_[A].simplex : held.simplex);
    for (int i = 0; i < 2; ++i)
        add(held.facet < 0 || held.n == skin_.dim ? 0 : held.vertex[i < held.n ? i : 0]);
    return number;
}

PointGaps::Reach NodeToSegment::locate_held(const double* X, int A, Found& found) const {
    const Held& held = held_[A];
    const auto candidate = std::find_if(candidates_[A].begin(), candidates_[A].end(),
                                        [&](const Candidate& c) { return c.facet == held.facet; });
    if (candidate == candidates_[A].end()) return Reach::far;
    const At x(X + 3 * A);
    const int s = held.simplex;
    found = {&*candidate, shape(X, held.facet), {}, {}, Vector3::Zero()};
    const FacetShape& facet = found.facet;
    const int a = held.vertex[0], b = held.vertex[held.n - 1];
    if (held.n < facet.dim) found.foot = on_edge(facet, s, a, b, x);
    // a centre on the edge itself has no direction from there, and is pushed off the simplex
    if (held.n == facet.dim || found.foot.distance <= closed * options_.reach) {
        found.foot = whole(facet, s, x), found.normal = facet.normal(s);
        found.value = found.normal.dot(x - facet.corner[facet.vertex(s, 0)]);
        return Reach::near;
    }
    Vector3 w = x;
    for (int i = 0; i < found.foot.n; ++i) w -= found.foot.coordinate[i] * facet.corner[found.foot.vertex[i]];
    found.value = found.foot.distance, found.normal = w / found.value;
    return Reach::near;
}

}  // namespace visviva::node_to_segment
