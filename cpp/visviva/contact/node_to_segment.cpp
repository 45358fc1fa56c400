#include "visviva/contact/node_to_segment.hpp"

#include <algorithm>
#include <cmath>

#include "visviva/base/parallel.hpp"

namespace visviva {

namespace node_to_segment {

NodeToSegment::NodeToSegment(Skin skin, PointOptions options, OwnSurface own)
    : PointGaps(std::move(skin), std::move(options)), own_(std::move(own)), candidates_(n_) {
    normals_.build(skin_);
    make_topology();
    kept_.resize(n_), held_.resize(n_);
}

// --- which facets there are --------------------------------------------------------------------------------
void NodeToSegment::make_topology() {
    struct Edge {
        int a, b, facet, corner;
    };
    std::vector<Edge> edges;
    std::vector<std::vector<int>> of(skin_.n_vertices());
    for (int f = 0; f < skin_.n_facets(); ++f)
        for (int i = 0, n = skin_.n_corners(f); i < n; ++i) {
            const int a = skin_.corners(f)[i], b = skin_.corners(f)[(i + 1) % n];
            of[a].push_back(f);
            if (n > 2) edges.push_back({std::min(a, b), std::max(a, b), f, i});
        }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& p, const Edge& q) { return p.a != q.a ? p.a < q.a : p.b < q.b; });
    across_.assign(facet_corners * skin_.n_facets(), -1), border_.assign(skin_.n_vertices(), 0);
    for (std::size_t k = 0; k < edges.size(); ++k) {
        const Edge& e = edges[k];
        if (k + 1 < edges.size() && edges[k + 1].a == e.a && edges[k + 1].b == e.b) {
            const Edge& o = edges[++k];
            across_[facet_corners * e.facet + e.corner] = o.facet;
            across_[facet_corners * o.facet + o.corner] = e.facet;
        } else {
            border_[e.a] = border_[e.b] = 1;
        }
    }
    if (skin_.dim == 2)
        for (int v = 0; v < skin_.n_vertices(); ++v) border_[v] = of[v].size() == 1;
    if (!touches_itself()) return;
    near_.resize(n_), sharp_.resize(n_);
    for (int A = 0; A < n_; ++A) {
        Vector3 sum = Vector3::Zero();
        for (int f : of[A]) sum += shape(own_.places.data(), f).normal(0);
        sharp_[A] = border_[A] || sum.norm() < smooth * static_cast<double>(of[A].size());
        for (int f : of[A])
            for (int i = 0; i < skin_.n_corners(f); ++i) {
                const auto& more = of[skin_.corners(f)[i]];
                near_[A].insert(near_[A].end(), more.begin(), more.end());
            }
    }
}

// A facet that bounds the same piece of the body from the other side lies behind the vertex from the start.
bool NodeToSegment::is_other_side(int A, int f) const {
    const FacetShape facet = shape(own_.places.data(), f);
    const At x(&own_.places[3 * A]);
    for (int s = 0; s < facet.n_simplices(); ++s)
        if (closest(facet, s, x).distance < 2 * options_.reach &&
            (x - facet.corner[facet.vertex(s, 0)]).dot(facet.normal(s)) < 0)
            return true;
    return false;
}

// Where a mouth closes, as at the tip of a slot, its sides are neighbours: all facets about the vertex face
// them.
bool NodeToSegment::faces_at_rest(int A, int f) const {
    const Vector3 normal = shape(own_.places.data(), f).normal(0);
    return std::all_of(near_[A].begin(), near_[A].end(), [&](int g) {
        const int *corners = skin_.corners(g), *end = corners + skin_.n_corners(g);
        return std::find(corners, end, A) == end ||
               shape(own_.places.data(), g).normal(0).dot(normal) < facing;
    });
}

// Parts that meet hold each other from one side alone, but what is sharp holds itself where the other part
// has no vertex like that: it would sink in between two of them.
bool NodeToSegment::holds(int A, int f) const {
    if (!touches_itself() || own_.starts[A] < own_.ends[f]) return true;
    const int* corners = skin_.corners(f);
    return sharp_[A] && std::none_of(corners, corners + skin_.n_corners(f), [&](int v) { return sharp_[v]; });
}

bool NodeToSegment::excluded(int A, int f) const {
    if (!touches_itself()) return false;
    if (is_other_side(A, f)) return true;
    return std::find(near_[A].begin(), near_[A].end(), f) != near_[A].end() && !faces_at_rest(A, f);
}

bool NodeToSegment::search(const double* from, const double* to) {
    const int begin = touches_itself() ? 0 : skin_.second_begin;
    const double margin = 2 * options_.reach + options_.radius;
    return near_facets_.find(skin_, begin, n_, from, to, margin, [&](int A, std::vector<int>& found) {
        std::erase_if(found, [&](int f) { return excluded(A, f); });
        const auto& old = candidates_[A];
        if (std::equal(old.begin(), old.end(), found.begin(), found.end(),
                       [](const Candidate& c, int f) { return c.facet == f; }))
            return false;
        make_stencil(A, found);
        return true;
    });
}

void NodeToSegment::make_stencil(int A, const std::vector<int>& facets) {
    auto& stencil = stencils_[A];
    stencil.assign(1, A), candidates_[A].clear();
    if (options_.rubs && skin_.dim == 3 && has_facets())
        stencil.push_back(edge_end(A));  // whose direction tractions turn with
    for (int k = 0; turns() && k < 4; ++k) stencil.push_back(options_.turning[A] + k);
    for (int f : facets) {
        Candidate c{f, {}};
        for (int i = 0; i < skin_.n_corners(f); ++i) {
            const int v = skin_.corners(f)[i];
            const auto at = std::find(stencil.begin(), stencil.end(), v);
            c.local[i] = static_cast<int>(at - stencil.begin());
            if (at == stencil.end()) stencil.push_back(v);
        }
        candidates_[A].push_back(c);
    }
    if (facets.empty()) stencil.clear();
}

FacetShape NodeToSegment::shape(const double* X, int f) const {
    FacetShape s;
    s.n = skin_.n_corners(f), s.dim = skin_.dim;
    s.corner[FacetShape::centre].setZero();
    for (int i = 0; i < s.n; ++i) {
        s.corner[i] = At(X + 3 * skin_.corners(f)[i]);
        s.corner[FacetShape::centre] += s.corner[i] / s.n;
    }
    return s;
}

// Facets that meet above an edge or a vertex have normals of their own, and which of them is closest changes
// with rounding there: within a step a vertex stays above the one that it was above as long as it hardly
// leaves that.
bool NodeToSegment::settle(const double* X) {
    const std::vector<Kept> last = kept_;
    for (Kept& kept : kept_) kept.touches = false;  // the step has ended
    const bool changed = PointGaps::settle(X);
    find_over(X);
    std::vector<Kept> fresh(n_);
    const std::vector<Held> held = std::exchange(held_, std::vector<Held>(n_));
    kept_.assign(n_, {});
    parallel_for(n_own(), [&](int A) {
        Found found;
        if (locate(X, A, found) == Reach::near)
            fresh[A] = {found.candidate->facet, found.foot.simplex,
                        found.value - options_.radius <= closed * options_.reach};
        if (options_.copies > 1) share_out(X, A);
    });
    kept_.swap(fresh);
    return changed || kept_ != last || held_ != held;
}

bool NodeToSegment::roams(const double* X, int A) const {
    Found found;
    if (kept_[A].facet < 0 || locate(X, A, found) != Reach::near) return false;
    return !kept_[A].is(found.candidate->facet, found.foot.simplex);
}

std::vector<int> NodeToSegment::others(int A) const {
    std::vector<int> corners;
    for (const Candidate& c : candidates_[A])
        corners.insert(corners.end(), skin_.corners(c.facet),
                       skin_.corners(c.facet) + skin_.n_corners(c.facet));
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    return corners;
}

double NodeToSegment::way(const double* from, const double* to, int A) const {
    double farthest = 0;
    const Vector3 own = At(to + 3 * A) - At(from + 3 * A);
    for (const Candidate& c : candidates_[A])
        for (int i = 0; i < skin_.n_corners(c.facet); ++i) {
            const int v = skin_.corners(c.facet)[i];
            farthest = std::max(farthest, (own - At(to + 3 * v) + At(from + 3 * v)).norm());
        }
    return farthest;
}

double NodeToSegment::sight(int A, int facet) const {
    const double there = skin_.behind.empty() ? HUGE_VAL : skin_.behind[facet];
    return std::min(options_.reach + options_.radius, deepest(options_.behind[A], there));
}

// What is thinner than the vertex sees is left on its other side.
double NodeToSegment::seen_inside(int A, int facet) const {
    const double there = skin_.behind.empty() ? HUGE_VAL : skin_.behind[facet];
    return std::min(sight(A, facet), there + options_.radius);
}

void NodeToSegment::approaches(const double* from, const double* to, std::vector<Approach>& out) const {
    out.assign(n_, {});
    for (int A = 0; A < n_; ++A)
        for (const Candidate& c : candidates_[A]) {
            Approach a{seen_inside(A, c.facet), 0};
            for (const double* X : {from, to}) {
                const Vector3 n = shape(X, c.facet).normal(0);
                Vector3 own;
                if (normals_.normal(X, A, own.data()) && own.dot(n) >= facing) continue;
                for (int i = 0; i < skin_.n_corners(c.facet); ++i) {
                    const int v = skin_.corners(c.facet)[i];
                    const Vector3 moved =
                        At(to + 3 * v) - At(from + 3 * v) - At(to + 3 * A) + At(from + 3 * A);
                    a.way = std::max(a.way, n.dot(moved));
                }
            }
            if (a.way * out[A].sight >= out[A].way * a.sight) out[A] = a;
        }
}

// Derivatives of the signed distance by the vertex and the facet's corners.
void NodeToSegment::differentiated(const double* X, int A, const Found& found, Eigen::VectorXd& g,
                                   Eigen::MatrixXd* H) const {
    if (found.rim.n == 0) return differentiate(found.facet, found.foot, found.normal, found.value, g, H);
    Expansion gap = beyond_border(found.facet, found.rim, roundness, At(X + 3 * A));
    g = std::move(gap.gradient);
    if (H) *H = std::move(gap.hessian);
}

PointGaps::Reach NodeToSegment::distance(const double* X, int A, int derivatives, Distance& out) const {
    const int size = 3 * static_cast<int>(stencils_[A].size());
    if (derivatives > 0) out.gradient.setZero(size);
    if (derivatives > 1) out.hessian.setZero(size, size);
    Found found;
    const Reach reach = locate(X, A, found);
    if (reach != Reach::near) return reach;
    out.value = found.value, out.beyond = found.rim.n > 0;
    const FacetShape& facet = found.facet;
    if (derivatives == 0) return Reach::near;
    Eigen::VectorXd g;
    Eigen::MatrixXd H;
    differentiated(X, A, found, g, derivatives > 1 ? &H : nullptr);
    auto place = [&](int c) { return c == 0 ? 0 : 3 * found.candidate->local[c - 1]; };
    for (int c = 0; c <= facet.n; ++c) out.gradient.segment<3>(place(c)) += g.segment<3>(3 * c);
    for (int c = 0; c <= facet.n && derivatives > 1; ++c)
        for (int d = 0; d <= facet.n; ++d)
            out.hessian.block<3, 3>(place(c), place(d)) += H.block<3, 3>(3 * c, 3 * d);
    return Reach::near;
}

// Of all that the search has found near, those that touch: others come and go as boxes about them do, which
// are along the axes of space.
void NodeToSegment::set_parts(const Found& found, Eigen::VectorXd& masses) {
    masses[0] = 1;
    for (int c = 0; c < found.facet.n; ++c) masses[found.candidate->local[c]] = 1;
}

void NodeToSegment::masses(const double* X, const std::vector<char>& wanted, bool, std::vector<Grip>& out) {
    find_middles({X, start()});
    parallel_for(n_, [&](int A) {
        if (!wanted[A]) return;
        out[A].weight.setZero(static_cast<Eigen::Index>(stencils_[A].size()));
        out[A].weight_gradient.resize(0, 0);
        Found found;
        if (locate(X, A, found) == Reach::near) set_parts(found, out[A].weight);
    });
}

// The vertex, or the point of the ball that is nearest, against the closest point. Tractions turn with an
// edge of the first surface, or of the facet where that is but points. What friction does not feel is the
// motion of the facet alone: what comes at its plane from above would seem to turn both, and to slip.
void NodeToSegment::grip(const double* X, int A, bool gradients, Grip& out) const {
    Found found;
    if (locate(X, A, found) != Reach::near) return;
    const FacetShape& facet = found.facet;
    const Foot& foot = found.foot;
    auto place = [&](int c) { return c == 0 ? 0 : found.candidate->local[c - 1]; };
    Eigen::VectorXd g;
    Eigen::MatrixXd H, N, coordinates;
    if (gradients) {
        const Vector3 plane = found.rim.n ? facet.normal(foot.simplex) : found.normal;
        const double above = plane.dot(At(X + 3 * A) - facet.corner[foot.vertex[0]]);
        differentiated(X, A, found, g, &H);
        coordinates = coordinate_gradients(facet, foot, plane, found.rim.n ? above : found.value);
        N.setZero(3, 3 * static_cast<Eigen::Index>(stencils_[A].size()));
        for (int c = 0; c <= facet.n; ++c) N.middleCols<3>(3 * place(c)) += H.block<3, 3>(0, 3 * c);
    }
    const Vector3 x = At(X + 3 * A);
    if (turns()) {
        turn_with_frame(1, out.turning);
        Eigen::MatrixXd C;
        if (gradients) C = -options_.radius * N, C.leftCols<3>() += Eigen::Matrix3d::Identity();
        const double* frame = X + 3 * options_.turning[A];
        add_weights(frame, options_.axis, x - options_.radius * found.normal, C, 1, -1, out);
    } else {
        set_parts(found, out.turning);
        out.turning[0] = 0, out.weight[0] = -1;
    }
    for (int c = 0; c < facet.n; ++c)
        for (int i = 0; i < foot.n; ++i) {
            const double share = facet.share(foot.vertex[i], c);
            out.weight[place(c + 1)] += share * foot.coordinate[i];
            for (int d = 0; gradients && d <= facet.n; ++d)
                out.weight_gradient.block<1, 3>(place(c + 1), 3 * place(d)) +=
                    share * coordinates.block<1, 3>(i, 3 * d);
        }
    const int tail = has_facets() ? 0 : place(1), head = has_facets() ? (skin_.dim == 3 ? 1 : 0) : place(2);
    const Vector3 edge = At(X + 3 * stencils_[A][head]) - At(X + 3 * stencils_[A][tail]);
    set_tangents(skin_.dim, found.normal, gradients ? &N : nullptr, edge, tail, head, out);
}

}  // namespace node_to_segment

std::unique_ptr<Gaps> make_node_to_segment(Skin skin, PointOptions options) {
    return std::make_unique<node_to_segment::NodeToSegment>(std::move(skin), std::move(options),
                                                            OwnSurface());
}

std::unique_ptr<Gaps> make_self_contact(Skin skin, PointOptions options, OwnSurface own) {
    return std::make_unique<node_to_segment::NodeToSegment>(std::move(skin), std::move(options),
                                                            std::move(own));
}

}  // namespace visviva
