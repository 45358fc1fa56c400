// Facets of mortar gaps that come near each other, and the vertices that gaps depend on.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "visviva/contact/mortar.hpp"

namespace visviva::mortar {

// Parts of the reach by which facets may be farther away to count as neighbours, and to be in stencils.
constexpr double found_margin = 0.9, narrow_margin = 0.125;

bool Mortar::search(const double* from, const double* to) {
    std::vector<Box> boxes;
    std::vector<double> centres;
    for (int f = skin_.second_begin; f < skin_.n_facets(); ++f) {
        boxes.push_back(swept(skin_, f, from, to, 0));
        for (int i = 0; i < 3; ++i) centres.push_back(0.5 * (boxes.back().low[i] + boxes.back().high[i]));
    }
    if (found_.empty()) tree_.build(centres);
    tree_.refit(boxes);
    std::vector<int> used(skin_.n_facets());
    std::iota(used.begin(), used.end(), 0);
    used_ = std::move(used);
    look(from, views_), look(to, views_after_);
    std::vector<Pair> found;
    std::vector<int> boxed;
    for (int f = 0; f < skin_.n_first; ++f) {
        tree_.query(swept(skin_, f, from, to, 2 * options_.reach), boxed);
        for (int k : boxed) {
            const int second = skin_.second_begin + k;
            const int *a = skin_.corners(f), *b = skin_.corners(second);
            const bool touching = std::any_of(a, a + facet_corners, [&](int v) {
                return v >= 0 && std::find(b, b + facet_corners, v) != b + facet_corners;
            });
            if (!touching && meets({f, second}, found_margin * options_.reach)) found.push_back({f, second});
        }
    }
    const bool same = found == found_;
    found_ = std::move(found);
    used_.clear();
    for (const Pair& p : found_) used_.push_back(p.first), used_.push_back(p.second);
    std::sort(used_.begin(), used_.end());
    used_.erase(std::unique(used_.begin(), used_.end()), used_.end());
    if (!same) gather_neighbours();
    narrow(from, to);
    return !same;
}

// Vertices on which the gaps of pairs can depend: corners, and those that make their normals.
void Mortar::gather_neighbours() {
    for (auto& list : neighbours_) list.clear();
    for (const Pair& p : found_) {
        const int* c = skin_.corners(p.first);
        for (int a = 0; a < skin_.n_corners(p.first); ++a)
            for (int f : {p.first, p.second})
                for (int k = 0; k < skin_.n_corners(f); ++k) neighbours_[c[a]].push_back(skin_.corners(f)[k]);
    }
    for (int A = 0; A < n_; ++A) {
        auto& list = neighbours_[A];
        if (list.empty()) continue;
        for (int k = normals_.start[A]; k < normals_.start[A + 1]; ++k)
            for (int v : {A, normals_.corners[k].next, normals_.corners[k].previous})
                if (v >= 0) list.push_back(v);
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
}

bool Mortar::narrow(const double* from, const double* to) {
    look(from, views_), look(to, views_after_);
    std::vector<Pair> pairs;
    for (const Pair& p : found_)
        if (meets(p, narrow_margin * options_.reach)) pairs.push_back(p);
    if (pairs == pairs_) return false;
    pairs_ = std::move(pairs);
    make_stencils();
    return true;
}

void Mortar::make_stencils() {
    slot_.assign(pairs_.size(), -1);
    for (int A = 0; A < n_; ++A) stencils_[A].clear(), shares_[A].clear(), ring_[A].clear();
    for (int p = 0; p < static_cast<int>(pairs_.size()); ++p) {
        const int* c = skin_.corners(pairs_[p].first);
        for (int a = 0; a < skin_.n_corners(pairs_[p].first); ++a) shares_[c[a]].push_back({p, a, {}});
    }
    std::vector<int> place(skin_.n_vertices(), -1);
    for (int A = 0; A < n_; ++A) {
        if (shares_[A].empty()) continue;
        auto& stencil = stencils_[A];
        auto at = [&](int v) {
            if (v < 0) return -1;
            if (place[v] < 0) place[v] = static_cast<int>(stencil.size()), stencil.push_back(v);
            return place[v];
        };
        at(A);
        for (int k = normals_.start[A]; k < normals_.start[A + 1]; ++k) {
            ring_[A].push_back(at(normals_.corners[k].next));
            ring_[A].push_back(at(normals_.corners[k].previous));
        }
        for (Share& s : shares_[A])
            for (int c = 0; c < segment_corners; ++c) {
                const int facet = c < facet_corners ? pairs_[s.pair].first : pairs_[s.pair].second;
                s.local[c] = at(skin_.corners(facet)[c % facet_corners]);
            }
        for (int v : stencil) place[v] = -1;
    }
}

Range Mortar::range(const Pair& p) const {
    if (skin_.behind.empty()) return {options_.reach};
    const double own = skin_.behind[p.first];  // beyond that it sees what is outside of its body
    return {options_.reach, std::min(own, deepest(own, skin_.behind[p.second])),
            std::min(skin_.ahead[p.first], skin_.ahead[p.second])};
}

// Approach of the facets along the first one's normal at both ends of the way.
double Mortar::nearing(const Pair& p, const double* from, const double* to) const {
    double way = 0;
    for (const Vector3& n : {views_[p.first].normal, views_after_[p.first].normal}) {
        double own = -HUGE_VAL, other = HUGE_VAL;
        auto moved = [&](int v) { return n.dot(At(to + 3 * v) - At(from + 3 * v)); };
        for (int a = 0; a < skin_.n_corners(p.first); ++a)
            own = std::max(own, moved(skin_.corners(p.first)[a]));
        for (int a = 0; a < skin_.n_corners(p.second); ++a)
            other = std::min(other, moved(skin_.corners(p.second)[a]));
        way = std::max(way, own - other);
    }
    return way;
}

void Mortar::approaches(const double* from, const double* to, std::vector<Approach>& out) const {
    std::vector<Approach> by_pair;
    for (const Pair& p : pairs_)
        by_pair.push_back({std::min(options_.reach, range(p).inside), nearing(p, from, to)});
    out.assign(n_, {});
    for (int A = 0; A < n_; ++A)
        for (const Share& s : shares_[A]) {
            const Approach& a = by_pair[s.pair];
            if (a.way * out[A].sight >= out[A].way * a.sight) out[A] = a;
        }
}

Mortar::View Mortar::view(const double* X, int facet) const {
    const int m = skin_.n_corners(facet);
    const int* c = skin_.corners(facet);
    auto x = [&](int a) -> Vector3 { return At(X + 3 * c[a]); };
    View v;
    v.normal = m == 2   ? Vector3((x(1) - x(0)).cross(Vector3::UnitZ()))
               : m == 3 ? Vector3((x(1) - x(0)).cross(x(2) - x(0)))
                        : Vector3((x(2) - x(0)).cross(x(3) - x(1)));
    if (!(v.normal.norm() > 0)) return v;
    v.normal.normalize();
    v.centre.setZero();
    for (int a = 0; a < m; ++a) v.centre += x(a) / m;
    for (int a = 0; a < m; ++a) v.radius = std::max(v.radius, (x(a) - v.centre).norm());
    return v;
}

void Mortar::look(const double* X, std::vector<View>& views) const {
    for (int f : used_) views[f] = view(X, f);
}

// Whether two facets look at each other and are within reach along the first one's normal.
bool Mortar::near(const View& a, const View& b, double margin) const {
    if (a.radius < 0 || b.radius < 0) return false;
    const Vector3 d = b.centre - a.centre;
    const double along = d.dot(a.normal), limit = a.radius + b.radius + margin;
    return std::abs(along) < options_.reach + margin && d.squaredNorm() - along * along < limit * limit &&
           a.normal.dot(b.normal) < facing_none + margin / options_.reach;
}

// Whether they come near each other between two configurations, or by the margin.
bool Mortar::meets(const Pair& p, double margin) const {
    const View &a = views_[p.first], &b = views_[p.second], &c = views_after_[p.first],
               &d = views_after_[p.second];
    const double moved = (d.centre - c.centre - b.centre + a.centre).norm();
    return near(a, b, margin + moved) || near(c, d, margin + moved);
}

}  // namespace visviva::mortar
