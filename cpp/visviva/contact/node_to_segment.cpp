// Node-to-segment gaps: the signed distance of a vertex to the closest point of facets, be it inside a facet,
// on an edge or at a vertex, which is continuous wherever the vertex slides (paper section 4.2, ref. [14]).
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

constexpr double facing = -0.1;      // least opposition of a vertex' and a facet's normal, as for mortar
constexpr double same_place = 1e-6;  // so close beside a facet, by its size, a point counts as above it
constexpr double same_side = 0.5;    // least agreement of normals of one side of a body
constexpr double between = 1e-10;    // so far beside a facet what comes in between two of them still meets it
constexpr double on_border = 1e-9;   // and so close to a border as not beyond it
// Radius, by a facet's size, with which bodies are rounded off beyond the borders of their surfaces: what
// slides off is let go without a jump. From a sharp corner it would snap off.
constexpr double roundness = 0.5;

struct Candidate {
    int facet;
    int local[facet_corners];  // places of its corners in the stencil
};

struct Found {
    const Candidate* candidate = nullptr;
    FacetShape facet;
    Foot foot;
    Foot rim;        // on the border of the surface, if there are any vertices
    Vector3 normal;  // of the simplex, later gradient of the signed distance
    double value = 0;
    bool faces = true;
};

class NodeToSegment : public PointGaps {
  public:
    NodeToSegment(Skin skin, PointOptions options, std::vector<double> rest);
    bool search(const double* from, const double* to) override;
    bool settle(const double* X) override;
    void approaches(const double* from, const double* to, std::vector<Approach>& out) const override;

  protected:
    Reach distance(const double* X, int vertex, int derivatives, Distance& out) const override;
    void grip(const double* X, int vertex, bool gradients, Grip& out) const override;
    double way(const double* from, const double* to, int vertex) const override;
    bool is_inside(const double* X, int vertex) const override;
    int nearest_side(const double* X, int vertex) const override;
    int entrance(const double* from, const double* to, int vertex) const override;
    double depth(const double* X, int vertex, int side) const override;
    bool are_same(const double* X, int side, int other) const override;

  private:
    Reach locate(const double* X, int A, Found& found) const;
    bool has_facets() const { return skin_.n_first > 0 || touches_itself(); }
    bool turns() const { return options_.axis > 0; }  // balls that rub
    int edge_end(int A) const { return normals_.corners[normals_.start[A]].next; }
    bool touches_itself() const { return !rest_.empty(); }
    bool excluded(int vertex, int facet) const;
    bool is_other_side(int vertex, int facet) const;
    void make_stencil(int A, const std::vector<int>& facets);
    FacetShape shape(const double* X, int facet) const;
    double sight(int A, int facet) const;
    double seen_inside(int A, int facet) const;
    Found pick(const double* X, int A, bool only_facing, int side) const;
    Reach locate_nearest(const double* X, int A, Found& found) const;
    Found plane_of(const double* X, int A, int side) const;
    bool leaves(const double* X, int A, const Found& found, int side) const;
    Reach sign(const double* X, int A, Found& found) const;
    void make_topology();
    Vector3 outwards(const double* X, const Found& found, bool& border) const;
    void differentiated(const double* X, int A, const Found& found, Eigen::VectorXd& g,
                        Eigen::MatrixXd* H) const;
    Vector3 at_vertex(const double* X, int vertex) const;

    // The simplex that a vertex was above where the step began.
    struct Kept {
        int facet = -1, simplex = 0;
        bool operator==(const Kept&) const = default;
    };
    std::vector<Kept> kept_;
    std::vector<double> rest_;  // places, if the surface may touch itself
    NormalField normals_;
    BoxTree tree_;
    bool built_ = false;
    std::vector<std::vector<Candidate>> candidates_;
    std::vector<int> across_;   // [facet][corner]: the facet beyond the edge to the next corner, or -1
    std::vector<char> border_;  // of vertices
    std::vector<std::vector<int>> near_;  // facets that a vertex shares with itself and its neighbours
};

NodeToSegment::NodeToSegment(Skin skin, PointOptions options, std::vector<double> rest)
    : PointGaps(std::move(skin), std::move(options)), rest_(std::move(rest)), candidates_(n_) {
    normals_.build(skin_);
    make_topology();
    kept_.resize(n_);
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
    near_.resize(n_);
    for (int A = 0; A < n_; ++A)
        for (int f : of[A])
            for (int i = 0; i < skin_.n_corners(f); ++i) {
                const auto& more = of[skin_.corners(f)[i]];
                near_[A].insert(near_[A].end(), more.begin(), more.end());
            }
}

// A facet that bounds the same piece of the body from the other side lies behind the vertex from the start.
bool NodeToSegment::is_other_side(int A, int f) const {
    const FacetShape facet = shape(rest_.data(), f);
    const At x(&rest_[3 * A]);
    for (int s = 0; s < facet.n_simplices(); ++s)
        if (closest(facet, s, x).distance < 2 * options_.reach &&
            (x - facet.corner[facet.vertex(s, 0)]).dot(facet.normal(s)) < 0)
            return true;
    return false;
}

bool NodeToSegment::excluded(int A, int f) const {
    if (!touches_itself()) return false;
    return std::find(near_[A].begin(), near_[A].end(), f) != near_[A].end() || is_other_side(A, f);
}

bool NodeToSegment::search(const double* from, const double* to) {
    const int begin = touches_itself() ? 0 : skin_.second_begin;
    std::vector<Box> boxes;
    std::vector<double> centres;
    for (int f = begin; f < skin_.n_facets(); ++f) {
        boxes.push_back(swept(skin_, f, from, to, 0));
        for (int i = 0; i < 3; ++i) centres.push_back(0.5 * (boxes.back().low[i] + boxes.back().high[i]));
    }
    if (!built_) tree_.build(centres);
    tree_.refit(boxes);
    bool changed = !built_;
    built_ = true;
    const double margin = 2 * options_.reach + options_.radius;
    std::vector<int> found;
    for (int A = 0; A < n_; ++A) {
        Box box;
        for (int i = 0; i < 3; ++i) {
            box.low[i] = std::min(from[3 * A + i], to[3 * A + i]) - margin;
            box.high[i] = std::max(from[3 * A + i], to[3 * A + i]) + margin;
        }
        tree_.query(box, found);
        for (int& f : found) f += begin;
        found.erase(std::remove_if(found.begin(), found.end(), [&](int f) { return excluded(A, f); }),
                    found.end());
        const auto& old = candidates_[A];
        if (std::equal(old.begin(), old.end(), found.begin(), found.end(),
                       [](const Candidate& c, int f) { return c.facet == f; }))
            continue;
        changed = true;
        make_stencil(A, found);
    }
    return changed;
}

void NodeToSegment::make_stencil(int A, const std::vector<int>& facets) {
    auto& stencil = stencils_[A];
    stencil.assign(1, A), candidates_[A].clear();
    if (options_.rubs && skin_.dim == 3 && has_facets())
        stencil.push_back(edge_end(A));  // whose direction tractions turn with
    for (int k = turns() ? 4 : 0; k > 0; --k) stencil.push_back(skin_.n_vertices() - k);
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

// --- the closest point -------------------------------------------------------------------------------------
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

double size(const FacetShape& facet) { return (facet.corner[1] - facet.corner[0]).norm(); }

// How far x lies from its foot in the direction of the simplex' middle.
double towards(const FacetShape& facet, const Foot& foot, const Vector3& x) {
    Vector3 y = Vector3::Zero(), middle = Vector3::Zero();
    for (int i = 0; i < foot.n; ++i) y += foot.coordinate[i] * facet.corner[foot.vertex[i]];
    for (int i = 0; i < facet.dim; ++i) middle += facet.corner[facet.vertex(foot.simplex, i)] / facet.dim;
    return (x - y).dot((middle - y).normalized());
}

// How far a point lies beside a simplex, by the length of its first edge.
double beside(const Found& found, const Vector3& x) {
    const FacetShape& facet = found.facet;
    const Vector3 &a = facet.corner[facet.vertex(found.foot.simplex, 0)],
                  &b = facet.corner[facet.vertex(found.foot.simplex, 1)];
    Vector3 w = x;
    for (int i = 0; i < found.foot.n; ++i) w -= found.foot.coordinate[i] * facet.corner[found.foot.vertex[i]];
    return (w - found.normal.dot(x - a) * found.normal).norm() / (b - a).norm();
}

// The closest simplex of all, or of those that face the vertex; where several meet at the closest point, the
// one on whose side of it the vertex lies. Where the vertex belongs to a side, of what looks there.
Found NodeToSegment::pick(const double* X, int A, bool only_facing, int side) const {
    Found found;
    Vector3 own;
    if (!normals_.normal(X, A, own.data())) own.setZero();
    constexpr double same = 1e-12;  // relative
    const Vector3 outside = side >= 0 ? shape(X, side).normal(0) : Vector3::Zero();
    const Kept& before = kept_[A];
    Found kept;
    double kept_aside = 0;  // beside the simplex, by its size
    double least = options_.reach + options_.radius, aside = -HUGE_VAL;
    for (const Candidate& c : candidates_[A]) {
        const FacetShape facet = shape(X, c.facet);
        for (int s = 0; s < facet.n_simplices(); ++s) {
            const Vector3 n = facet.normal(s);
            const bool faces = own.isZero() || own.dot(n) < facing;
            if (n.isZero() || (only_facing && !faces)) continue;
            if (side >= 0 && n.dot(outside) <= same_side) continue;
            const Foot foot = closest(facet, s, At(X + 3 * A));
            if (before == Kept{c.facet, s}) {
                kept = {&c, facet, foot, {}, n, 0, faces};
                kept_aside = beside(kept, At(X + 3 * A));
            }
            if (foot.distance > (1 + same) * least) continue;
            const double side = towards(facet, foot, At(X + 3 * A));
            if (foot.distance >= (1 - same) * least && side <= aside) continue;
            least = foot.distance, aside = side;
            found = {&c, facet, foot, {}, n, 0, faces};
        }
    }
    return kept.candidate && kept_aside <= same_place ? kept : found;
}

// Facets that meet above an edge or a vertex have normals of their own, and which of them is closest changes
// with rounding there: within a step a vertex stays above the one that it was above as long as it hardly
// leaves that.
bool NodeToSegment::settle(const double* X) {
    const bool changed = PointGaps::settle(X);
    std::vector<Kept> last(n_), fresh(n_);
    kept_.swap(last);
    parallel_for(n_, [&](int A) {
        Found found;
        if (locate(X, A, found) == Reach::near) fresh[A] = {found.candidate->facet, found.foot.simplex};
    });
    kept_.swap(fresh);
    return changed || kept_ != last;
}

// Sum of the normals around a vertex, weighted by angles: it tells inside from outside (Baerentzen & Aanaes
// 2005).
Vector3 NodeToSegment::at_vertex(const double* X, int vertex) const {
    Vector3 sum = Vector3::Zero();
    const At a(X + 3 * vertex);
    for (int k = normals_.start[vertex]; k < normals_.start[vertex + 1]; ++k) {
        const Corner& corner = normals_.corners[k];
        Vector3 m;
        double angle = 1;
        if (skin_.dim == 2) {
            const Vector3 e =
                corner.next >= 0 ? At(X + 3 * corner.next) - a : a - At(X + 3 * corner.previous);
            m = e.cross(Vector3::UnitZ());
        } else {
            const Vector3 u = At(X + 3 * corner.next) - a, w = At(X + 3 * corner.previous) - a;
            m = u.cross(w), angle = std::atan2(m.norm(), u.dot(w));
        }
        if (m.norm() > 0) sum += angle * m.normalized();
    }
    return sum;
}

// A direction that points out of the body where the closest point is on an edge or at a vertex.
Vector3 NodeToSegment::outwards(const double* X, const Found& found, bool& border) const {
    const Foot& foot = found.foot;
    const int f = found.candidate->facet, n = found.facet.n;
    border = false;
    if (std::find(foot.vertex, foot.vertex + foot.n, FacetShape::centre) != foot.vertex + foot.n) {
        Vector3 sum = Vector3::Zero();
        for (int s = 0; s < found.facet.n_simplices(); ++s) sum += found.facet.normal(s);
        return sum;
    }
    if (foot.n == 1) {
        const int v = skin_.corners(f)[foot.vertex[0]];
        border = border_[v];
        return at_vertex(X, v);
    }
    const int corner = (foot.vertex[0] + 1) % n == foot.vertex[1] ? foot.vertex[0] : foot.vertex[1];
    const int other = across_[facet_corners * f + corner];
    border = other < 0;
    if (border) return found.normal;
    const FacetShape beyond = shape(X, other);
    for (int s = 0; s < beyond.n_simplices(); ++s) {
        const int v = skin_.corners(other)[beyond.vertex(s, 0)],
                  w = skin_.corners(other)[beyond.vertex(s, 1)];
        const int a = skin_.corners(f)[foot.vertex[0]], b = skin_.corners(f)[foot.vertex[1]];
        if (beyond.n == 3 || (v == a && w == b) || (v == b && w == a)) return found.normal + beyond.normal(s);
    }
    return found.normal;
}

// The signed distance and its gradient.
PointGaps::Reach NodeToSegment::sign(const double* X, int A, Found& found) const {
    if (!found.candidate) return Reach::far;
    const At x(X + 3 * A);
    const FacetShape& facet = found.facet;
    const Vector3& a = facet.corner[facet.vertex(found.foot.simplex, 0)];
    const double above = found.normal.dot(x - a), d = found.foot.distance;
    found.value = above;
    if (found.foot.n == facet.dim) return Reach::near;
    bool border;
    const Vector3 out = outwards(X, found, border);
    Vector3 w = x;
    for (int i = 0; i < found.foot.n; ++i) w -= found.foot.coordinate[i] * facet.corner[found.foot.vertex[i]];
    const double aside = beside(found, x);
    const bool rolls = options_.radius > 0;  // off an edge, as balls are round themselves
    if ((border && !rolls) || aside <= same_place) {
        if (border && !rolls && aside > on_border) {
            found.rim = found.foot;
            const Jet gap = beyond_border(facet, found.rim, roundness, x);
            found.value = gap.value, found.normal = gap.gradient.head<3>();
        }
        found.foot = whole(facet, found.foot.simplex, x);
        return Reach::near;
    }
    found.value = w.dot(out) < 0 && !border ? -d : d;
    found.normal = w / found.value;
    return Reach::near;
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

// Whether it lies behind what is nearest, or by rounding before it.
bool NodeToSegment::is_inside(const double* X, int A) const {
    Found found;
    return locate_nearest(X, A, found) == Reach::near && found.value < same_place * size(found.facet);
}

int NodeToSegment::nearest_side(const double* X, int A) const {
    Found found;
    return locate_nearest(X, A, found) == Reach::near ? found.candidate->facet : Sides::nearest;
}

// Whether what is found is beyond a side: of another one, or on what that shares with another one.
bool NodeToSegment::leaves(const double* X, int A, const Found& found, int side) const {
    const Foot& foot = found.foot;
    if (!are_same(X, found.candidate->facet, side)) return true;
    if (foot.n == found.facet.dim) return false;
    const int* own = skin_.corners(found.candidate->facet);
    return std::any_of(candidates_[A].begin(), candidates_[A].end(), [&](const Candidate& c) {
        const int *corners = skin_.corners(c.facet), *end = corners + skin_.n_corners(c.facet);
        const bool shares = std::all_of(foot.vertex, foot.vertex + foot.n, [&](int v) {
            return v != FacetShape::centre && std::find(corners, end, own[v]) != end;
        });
        return shares && !are_same(X, c.facet, side);
    });
}

bool NodeToSegment::are_same(const double* X, int side, int other) const {
    return shape(X, side).normal(0).dot(shape(X, other).normal(0)) > same_side;
}

// The facet that the vertex passes last from before it to behind it, as both move straight.
int NodeToSegment::entrance(const double* from, const double* to, int A) const {
    const Vector3 start = nudged(from, A), end = nudged(to, A);
    Vector3 own;
    if (!normals_.normal(to, A, own.data())) own.setZero();
    double latest = -1;
    int side = Sides::nearest;
    for (const Candidate& c : candidates_[A]) {
        const FacetShape one = shape(from, c.facet), two = shape(to, c.facet);
        for (int s = 0; s < one.n_simplices(); ++s) {
            const Vector3 n = two.normal(s);
            const int first = one.vertex(s, 0);
            const double before = one.normal(s).dot(start - one.corner[first]),
                         after = n.dot(end - two.corner[first]);
            if (!(before >= 0 && after < 0) || (!own.isZero() && own.dot(n) >= facing)) continue;
            const double t = before / (before - after);
            FacetShape there = two;
            for (int i = 0; i <= FacetShape::centre; ++i)
                there.corner[i] = one.corner[i] + t * (two.corner[i] - one.corner[i]);
            const Foot foot = whole(there, s, start + t * (end - start));
            const bool meets = std::all_of(foot.coordinate, foot.coordinate + there.dim,
                                           [](double share) { return share > -between; });
            if (meets && t > latest) latest = t, side = c.facet;
        }
    }
    return side;
}

// What lies outside is free. What lies inside is pushed back to where it faces, not out of the other side of
// a thin body.
PointGaps::Reach NodeToSegment::locate_nearest(const double* X, int A, Found& found) const {
    found = pick(X, A, false, Sides::nearest);
    const Reach reach = sign(X, A, found);
    if (found.faces || found.value >= 0) return reach;
    found = pick(X, A, true, Sides::nearest);
    return sign(X, A, found);
}

// What is nearest of a side, as if it went on.
Found NodeToSegment::plane_of(const double* X, int A, int side) const {
    Found found = pick(X, A, false, side);
    if (found.candidate) found.foot = whole(found.facet, found.foot.simplex, At(X + 3 * A));
    return found;
}

double NodeToSegment::depth(const double* X, int A, int side) const {
    Found found = plane_of(X, A, side);
    return sign(X, A, found) == Reach::near ? -found.value : HUGE_VAL;
}

// What lies inside beside an edge is pushed back to where it came in.
PointGaps::Reach NodeToSegment::locate(const double* X, int A, Found& found) const {
    Reach reach = locate_nearest(X, A, found);
    const int came = reach == Reach::near ? side(X, A) : Sides::nearest;
    if (came >= 0 && leaves(X, A, found, came)) {
        found = plane_of(X, A, came);
        reach = sign(X, A, found);
    }
    const bool deep =
        reach == Reach::near && options_.radius - found.value > sight(A, found.candidate->facet);
    return deep ? Reach::far : reach;
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
    Jet gap = beyond_border(found.facet, found.rim, roundness, At(X + 3 * A));
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
    out.value = found.value;
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

// The vertex, or the point of the ball that is nearest, against the closest point. Tractions turn with an
// edge of the first surface, or of the facet where that is but points.
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
        Eigen::MatrixXd C;
        if (gradients) C = -options_.radius * N, C.leftCols<3>() += Eigen::Matrix3d::Identity();
        const double* frame = X + 3 * (skin_.n_vertices() - 4);
        add_weights(frame, options_.axis, x - options_.radius * found.normal, C, 1, -1, out);
    } else {
        out.weight[0] = -1;
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

}  // namespace

std::unique_ptr<Gaps> make_node_to_segment(Skin skin, PointOptions options) {
    return std::make_unique<NodeToSegment>(std::move(skin), std::move(options), std::vector<double>());
}

std::unique_ptr<Gaps> make_self_contact(Skin skin, PointOptions options, std::vector<double> places) {
    return std::make_unique<NodeToSegment>(std::move(skin), std::move(options), std::move(places));
}

}  // namespace visviva
