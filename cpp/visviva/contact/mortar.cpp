// Mortar gaps: Phi_A = n_A . integral of N_A (x2 - x1) over the first surface where it faces the second, with
// the averaged normal n_A at vertex A (Puso & Laursen 2004; paper refs. [10][13]).
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "visviva/base/parallel.hpp"
#include "visviva/contact/gaps.hpp"
#include "visviva/contact/search.hpp"
#include "visviva/contact/skew.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using At = Eigen::Map<const Vector3>;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// V . n with n = m / |m|, and its derivatives by m.
struct Normal {
    Vector3 n;
    double size;
    explicit Normal(const Vector3& m) : n(m.normalized()), size(m.norm()) {}
    Vector3 gradient(const Vector3& V) const { return (V - n * n.dot(V)) / size; }
    Matrix3 hessian(const Vector3& V) const {
        const Vector3 g = gradient(V);
        return -(g * n.transpose() + n * g.transpose()) / size -
               n.dot(V) / (size * size) * (Matrix3::Identity() - n * n.transpose());
    }
    Matrix3 derivative() const { return (Matrix3::Identity() - n * n.transpose()) / size; }
};

// Parts of the reach by which facets may be farther away to count as neighbours, and to be in stencils.
constexpr double found_margin = 0.9, narrow_margin = 0.125;

struct Pair {
    int first, second;  // facets
    bool operator==(const Pair&) const = default;
};

// A vertex's share in a pair of facets: which corner it is, and where the pair's corners are in its stencil.
struct Share {
    int pair, corner;
    int local[segment_corners];
};

class Mortar : public Gaps {
  public:
    Mortar(Skin skin, const MortarOptions& options) : Gaps(std::move(skin)), options_(options) {
        normals_.build(skin_);
        for (int f = 0; f < skin_.n_first; ++f)
            for (int a = 0; a < skin_.n_corners(f); ++a) n_ = std::max(n_, skin_.corners(f)[a] + 1);
        stencils_.resize(n_), neighbours_.resize(n_), shares_.resize(n_), ring_.resize(n_);
        views_.resize(skin_.n_facets()), views_after_.resize(skin_.n_facets());
        if (options_.dual) dual_.assign(skin_.n_first, Functions::Identity());
    }

    bool search(const double* from, const double* to) override;
    const std::vector<int>& neighbours(int gap) const override { return neighbours_[gap]; }
    bool narrow(const double* from, const double* to) override;
    bool settle(const double* X) override;
    void approaches(const double* from, const double* to, std::vector<Approach>& out) const override;
    double resolution() const override { return along_each_other; }
    void values(const double* X, double* gap, double* area) override;
    void gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) override;
    void seconds(const double* X, const std::vector<double>& S, const double* direction,
                 std::vector<Gap>& out) override;
    void grips(const double* X, const std::vector<char>& wanted, bool gradients,
               std::vector<Grip>& out) override;
    void masses(const double* X, const std::vector<char>& wanted, bool gradients,
                std::vector<Grip>& out) override;
    int n_turning(int A) const override { return static_cast<int>(ring_size(A)); }

  private:
    // Dual functions of a facet's corners by their shapes.
    using Functions = Eigen::Matrix<double, facet_corners, facet_corners, Eigen::RowMajor>;
    Functions dual_functions(int n, const SegmentWeights& covered) const;
    // A facet as the search for neighbours sees it.
    struct View {
        Vector3 normal, centre;
        double radius = -1;  // -1: it is degenerate
    };
    View view(const double* X, int facet) const;
    void look(const double* X, std::vector<View>& views) const;
    bool near(const View& a, const View& b, double margin) const;
    bool meets(const Pair& pair, double margin) const;
    void find_near(const double* X, const std::vector<char>* wanted);
    // Of a pair at the last configuration; null where its facets do not face each other.
    const Segment* segment(int pair) const {
        return slot_[pair] >= 0 && segments_[slot_[pair]].any ? &segments_[slot_[pair]] : nullptr;
    }
    FacetPair corners(const double* X, const Pair& pair) const;
    Range range(const Pair& pair) const;
    double nearing(const Pair& pair, const double* from, const double* to) const;
    void gather_neighbours();
    void make_stencils();
    template <class F>
    void each_near(const double* X, F f);
    Vector3 moment(int A, double* area = nullptr) const;
    Normal normal(const double* X, int A) const;
    void add_normal_gradient(const double* X, int A, const Vector3& u, double* g) const;
    Eigen::MatrixXd moment_gradient(int A) const;
    Eigen::Index ring_size(int A) const;
    std::vector<Matrix3> normal_gradient(const double* X, int A) const;
    void add_normal_curvature(int A, const Vector3& g, Eigen::Ref<RowMatrix> H) const;
    void second(const double* X, int A, double S, const double* direction, Gap& out) const;
    void find_weights(const double* X, const std::vector<char>& wanted, bool gradients);
    void set_weights(int A, bool gradients, Grip& out) const;
    void set_tangents(const double* X, int A, bool gradients, Grip& out) const;

    MortarOptions options_;
    NormalField normals_;
    BoxTree tree_;
    std::vector<Pair> found_;  // by the last search
    std::vector<Pair> pairs_;  // those that stencils are made of
    std::vector<std::vector<int>> neighbours_;
    std::vector<std::vector<Share>> shares_;
    std::vector<std::vector<int>> ring_;  // per vertex and corner of its normal: places of next and previous
    std::vector<int> used_;               // facets in pairs
    std::vector<View> views_, views_after_;  // of all facets, up to date for those
    std::vector<int> near_;                  // pairs that are near at the last configuration
    std::vector<int> slot_;                  // pair -> place in near_, or -1
    std::vector<Segment> segments_;          // of the pairs in near_
    std::vector<SegmentWeights> weights_;
    std::vector<SegmentWeightGradients> weight_gradients_;
    std::vector<Functions> dual_;  // per facet of the first surface; empty: shapes are taken
    std::vector<int> owner_;       // per pair: the vertex whose share of second derivatives is the pair's
};

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

// What the gaps of the vertices of pairs can depend on: corners, and what their normals are made of.
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

FacetPair Mortar::corners(const double* X, const Pair& pair) const {
    FacetPair p{};
    p.n_first = skin_.n_corners(pair.first), p.n_second = skin_.n_corners(pair.second);
    p.range = range(pair), p.axisymmetric = options_.axisymmetric;
    if (options_.dual) p.dual = reinterpret_cast<const double (*)[facet_corners]>(dual_[pair.first].data());
    for (int c = 0; c < segment_corners; ++c) {
        const int v = skin_.corners(c < facet_corners ? pair.first : pair.second)[c % facet_corners];
        for (int i = 0; v >= 0 && i < 3; ++i) p.x[c][i] = X[3 * v + i];
    }
    return p;
}

Range Mortar::range(const Pair& p) const {
    if (skin_.behind.empty()) return {options_.reach};
    return {options_.reach, deepest(skin_.behind[p.first], skin_.behind[p.second]),
            std::min(skin_.ahead[p.first], skin_.ahead[p.second])};
}

// How much nearer the facets come along the first one's normal at both ends of the way.
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

void Mortar::find_near(const double* X, const std::vector<char>* wanted) {
    look(X, views_);
    near_.clear();
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        const int* c = skin_.corners(pairs_[p].first);
        const bool asked = !wanted || std::any_of(c, c + skin_.n_corners(pairs_[p].first),
                                                  [&](int A) { return (*wanted)[A] != 0; });
        const bool counts = asked && near(views_[pairs_[p].first], views_[pairs_[p].second], 0);
        slot_[p] = counts ? static_cast<int>(near_.size()) : -1;
        if (counts) near_.push_back(static_cast<int>(p));
    }
    if (segments_.size() < near_.size()) segments_.resize(near_.size());
}

// With D the integrals of shapes and M those of their products over what is covered, D M^-1 are functions
// with the same integrals and sum, each of which sees its own corner alone (Wohlmuth 2000). Where a corner's
// part is hardly covered, or nothing yet, they are the shapes themselves.
Mortar::Functions Mortar::dual_functions(int n, const SegmentWeights& covered) const {
    constexpr double least = 0.05;
    Functions a = Functions::Identity();
    const double *begin = covered.area, *end = begin + n;
    if (!(*std::min_element(begin, end) > least * *std::max_element(begin, end))) return a;
    Eigen::MatrixXd M(n, n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) M(i, j) = covered.first[i][j];
    const Eigen::MatrixXd inverse = M.inverse();
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) a(i, j) = covered.area[i] * inverse(i, j);
    return a;
}

bool Mortar::settle(const double* X) {
    if (!options_.dual) return false;
    find_near(X, nullptr);
    weights_.resize(near_.size());
    each_near(X, [&](const FacetPair& x, int, Segment& s) {
        segment_kernels().weights(x, weights_[&s - segments_.data()]);
    });
    std::vector<SegmentWeights> covered(skin_.n_first, SegmentWeights{});
    for (std::size_t k = 0; k < near_.size(); ++k) {
        SegmentWeights& sum = covered[pairs_[near_[k]].first];
        for (int a = 0; weights_[k].any && a < facet_corners; ++a) {
            sum.area[a] += weights_[k].area[a];
            for (int b = 0; b < facet_corners; ++b) sum.first[a][b] += weights_[k].first[a][b];
        }
    }
    std::vector<Functions> functions;
    for (int f = 0; f < skin_.n_first; ++f)
        functions.push_back(dual_functions(skin_.n_corners(f), covered[f]));
    dual_.swap(functions);
    return dual_ != functions;
}

template <class F>
void Mortar::each_near(const double* X, F f) {
    constexpr int together = 8;
    const int n = static_cast<int>(near_.size());
    parallel_for((n + together - 1) / together, [&](int task) {
        for (int k = task * together; k < std::min(n, (task + 1) * together); ++k)
            f(corners(X, pairs_[near_[k]]), near_[k], segments_[k]);
    });
}

Vector3 Mortar::moment(int A, double* area) const {
    Vector3 V = Vector3::Zero();
    for (const Share& s : shares_[A])
        if (const Segment* g = segment(s.pair)) {
            V += At(g->V[s.corner]);
            if (area) *area += g->area[s.corner];
        }
    return V;
}

Normal Mortar::normal(const double* X, int A) const {
    Vector3 m;
    normals_.sum(X, A, m.data());
    return Normal(m);
}

void Mortar::values(const double* X, double* gap, double* area) {
    find_near(X, nullptr);
    each_near(X, [](const FacetPair& x, int, Segment& s) { segment_kernels().value(x, s); });
    for (int A = 0; A < n_; ++A) {
        gap[A] = area[A] = 0;
        if (!shares_[A].empty()) gap[A] = moment(A, &area[A]).dot(normal(X, A).n);
    }
}

// dV/dx by vertices of the stencil.
Eigen::MatrixXd Mortar::moment_gradient(int A) const {
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(3, 3 * stencils_[A].size());
    for (const Share& s : shares_[A]) {
        const Segment* g = segment(s.pair);
        for (int c = 0; g && c < segment_corners; ++c)
            for (int j = 0; s.local[c] >= 0 && j < 3; ++j)
                for (int i = 0; i < 3; ++i) G(i, 3 * s.local[c] + j) += g->J[s.corner][i][3 * c + j];
    }
    return G;
}

// So many vertices at the beginning of the stencil make the normal.
Eigen::Index Mortar::ring_size(int A) const {
    return 1 + std::max(0, *std::max_element(ring_[A].begin(), ring_[A].end()));
}

// dm/dx of the sum of normals m, by vertices of the stencil.
std::vector<Matrix3> Mortar::normal_gradient(const double* X, int A) const {
    std::vector<Matrix3> M(stencils_[A].size(), Matrix3::Zero());
    const auto& ring = ring_[A];
    auto x = [&](int local) { return At(X + 3 * stencils_[A][local]); };
    for (std::size_t k = 0; k < ring.size(); k += 2) {
        const int b = ring[k], c = ring[k + 1];
        if (skin_.dim == 2) {
            const Matrix3 turn = -skew(Vector3::UnitZ());
            M[b >= 0 ? b : 0] += turn, M[b >= 0 ? 0 : c] -= turn;
            continue;
        }
        M[0] += skew(x(c) - x(b)), M[b] += skew(x(0) - x(c)), M[c] += skew(x(b) - x(0));
    }
    return M;
}

// g . d2m/dx2
void Mortar::add_normal_curvature(int A, const Vector3& g, Eigen::Ref<RowMatrix> H) const {
    if (skin_.dim == 2) return;
    const auto& ring = ring_[A];
    const Matrix3 E = -skew(g);
    auto add = [&](int a, int b) {
        H.block<3, 3>(3 * a, 3 * b) += E;
        H.block<3, 3>(3 * b, 3 * a) += E.transpose();
    };
    for (std::size_t k = 0; k < ring.size(); k += 2)
        add(0, ring[k]), add(ring[k], ring[k + 1]), add(ring[k + 1], 0);
}

// g += (dm/dx)^T u
void Mortar::add_normal_gradient(const double* X, int A, const Vector3& u, double* g) const {
    const auto& ring = ring_[A];
    auto x = [&](int local) { return At(X + 3 * stencils_[A][local]); };
    auto add = [&](int local, const Vector3& v) { Eigen::Map<Vector3>(g + 3 * local) += v; };
    for (std::size_t k = 0; k < ring.size(); k += 2) {
        const int b = ring[k], c = ring[k + 1];
        if (skin_.dim == 2) {
            const Vector3 turned = Vector3::UnitZ().cross(u);
            add(b >= 0 ? b : 0, turned), add(b >= 0 ? 0 : c, -turned);
            continue;
        }
        add(0, u.cross(x(c) - x(b))), add(b, u.cross(x(0) - x(c))), add(c, u.cross(x(b) - x(0)));
    }
}

void Mortar::gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) {
    std::vector<Vector3> n(n_, Vector3::Zero());
    for (int A = 0; A < n_; ++A)
        if (wanted[A]) n[A] = normal(X, A).n;
    find_near(X, &wanted);
    each_near(X, [&](const FacetPair& x, int pair, Segment& s) {
        double normals[facet_corners][3] = {};
        for (int a = 0; a < x.n_first; ++a)
            Vector3::Map(normals[a]) = n[skin_.corners(pairs_[pair].first)[a]];
        segment_kernels().gradient(x, normals, s);
    });
    for (int A = 0; A < n_; ++A) {
        if (!wanted[A]) continue;
        std::vector<double>& g = out[A].gradient;
        g.assign(3 * stencils_[A].size(), 0.0);
        for (const Share& s : shares_[A])
            if (const Segment* segment = this->segment(s.pair))
                for (int c = 0; c < segment_corners; ++c)
                    for (int i = 0; s.local[c] >= 0 && i < 3; ++i)
                        g[3 * s.local[c] + i] += segment->g[s.corner][3 * c + i];
        add_normal_gradient(X, A, normal(X, A).gradient(moment(A)), g.data());
    }
}

void Mortar::seconds(const double* X, const std::vector<double>& S, const double* direction,
                     std::vector<Gap>& out) {
    std::vector<char> wanted(n_);
    std::vector<Vector3> n(n_, Vector3::Zero());
    for (int A = 0; A < n_; ++A)
        if ((wanted[A] = S[A] != 0)) n[A] = normal(X, A).n;
    owner_.assign(pairs_.size(), -1);
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        const int* c = skin_.corners(pairs_[p].first);
        for (int a = 0; a < skin_.n_corners(pairs_[p].first) && owner_[p] < 0; ++a)
            if (wanted[c[a]]) owner_[p] = c[a];
    }
    find_near(X, &wanted);
    each_near(X, [&](const FacetPair& x, int number, Segment& s) {
        const Pair& pair = pairs_[number];
        double u[facet_corners][3] = {}, normals[facet_corners][3] = {}, along[segment_size] = {};
        for (int a = 0; a < x.n_first; ++a) {
            const int A = skin_.corners(pair.first)[a];
            for (int i = 0; i < 3; ++i) normals[a][i] = n[A][i], u[a][i] = S[A] * n[A][i];
        }
        for (int c = 0; direction && c < segment_corners; ++c) {
            const int v = skin_.corners(c < facet_corners ? pair.first : pair.second)[c % facet_corners];
            for (int i = 0; v >= 0 && i < 3; ++i) along[3 * c + i] = direction[3 * v + i];
        }
        segment_kernels().second(x, u, normals, direction ? along : nullptr, s);
    });
    parallel_for(n_, [&](int A) {
        if (wanted[A]) second(X, A, S[A], direction, out[A]);
    });
}

// Of one gap; the segments' common second derivatives go to the first wanted vertex of their first facet. The
// normal depends on its ring alone, which comes first in the stencil.
void Mortar::second(const double* X, int A, double S, const double* direction, Gap& out) const {
    const Normal n = normal(X, A);
    const Vector3 V = moment(A), by_sum = n.gradient(V);
    const auto M = normal_gradient(X, A);
    const Eigen::Index k = 3 * static_cast<Eigen::Index>(stencils_[A].size()), r = 3 * ring_size(A);
    Eigen::MatrixXd MM(3, r);
    for (Eigen::Index v = 0; 3 * v < r; ++v) MM.middleCols<3>(3 * v) = M[v];
    const Eigen::MatrixXd GG = moment_gradient(A), NN = n.derivative() * MM;
    out.hessian.assign(k * k, 0.0);
    Eigen::Map<RowMatrix> H(out.hessian.data(), k, k);
    const Eigen::MatrixXd mixed = S * NN.transpose() * GG;
    H.topRows(r) += mixed;
    H.leftCols(r) += mixed.transpose();
    H.topLeftCorner(r, r) += S * MM.transpose() * n.hessian(V) * MM;
    add_normal_curvature(A, S * by_sum, H);
    Eigen::VectorXd g = GG.transpose() * n.n;
    g.head(r) += MM.transpose() * by_sum;
    out.gradient.assign(g.data(), g.data() + k);
    if (direction) {
        Eigen::VectorXd D(k);
        for (Eigen::Index v = 0; 3 * v < k; ++v) D.segment<3>(3 * v) = At(direction + 3 * stencils_[A][v]);
        Eigen::VectorXd HD = H * D / S;
        for (const Share& s : shares_[A])
            for (int c = 0; segment(s.pair) && c < segment_corners; ++c)
                for (int i = 0; s.local[c] >= 0 && i < 3; ++i)
                    HD[3 * s.local[c] + i] += segment(s.pair)->HD[s.corner][3 * c + i];
        out.along.assign(HD.data(), HD.data() + k);
    }
    for (const Share& s : shares_[A]) {
        const Segment* segment = this->segment(s.pair);
        if (!segment || owner_[s.pair] != A) continue;
        for (int c = 0; c < segment_corners; ++c)
            for (int i = 0; s.local[c] >= 0 && i < 3; ++i) {
                double* row = out.hessian.data() + k * (3 * s.local[c] + i);
                for (int d = 0; d < segment_corners; ++d)
                    for (int j = 0; s.local[d] >= 0 && j < 3; ++j)
                        row[3 * s.local[d] + j] += segment->H[3 * c + i][3 * d + j];
            }
    }
}

// --- friction ----------------------------------------------------------------------------------------------
void Mortar::find_weights(const double* X, const std::vector<char>& wanted, bool gradients) {
    find_near(X, &wanted);
    weights_.resize(near_.size());
    if (gradients) weight_gradients_.resize(near_.size());
    each_near(X, [&](const FacetPair& x, int, Segment& s) {
        const auto k = &s - segments_.data();
        if (gradients)
            segment_kernels().weight_gradients(x, weights_[k], weight_gradients_[k]);
        else
            segment_kernels().weights(x, weights_[k]);
        s.any = weights_[k].any;
    });
}

// What a vertex has of the integrals of the gap, which fades out where stencils end.
void Mortar::masses(const double* X, const std::vector<char>& wanted, bool gradients,
                    std::vector<Grip>& out) {
    find_weights(X, wanted, gradients);
    parallel_for(n_, [&](int A) {
        if (!wanted[A]) return;
        set_weights(A, gradients, out[A]);
        for (Eigen::Index v = 0; gradients && v < out[A].weight.size(); ++v)
            if (out[A].weight[v] < 0) out[A].weight_gradient.row(v) *= -1;
        out[A].weight = out[A].weight.cwiseAbs().eval();
    });
}

void Mortar::grips(const double* X, const std::vector<char>& wanted, bool gradients, std::vector<Grip>& out) {
    find_weights(X, wanted, gradients);
    parallel_for(n_, [&](int A) {
        if (!wanted[A]) return;
        set_weights(A, gradients, out[A]);
        set_tangents(X, A, gradients, out[A]);
    });
}

// Integrals of N_A times the shapes of the second surface, minus those of the first.
void Mortar::set_weights(int A, bool gradients, Grip& out) const {
    const Eigen::Index k = stencils_[A].size();
    out.weight.setZero(k);
    if (gradients) out.weight_gradient.setZero(k, 3 * k);
    for (const Share& s : shares_[A]) {
        if (!segment(s.pair)) continue;
        const SegmentWeights& w = weights_[slot_[s.pair]];
        for (int c = 0; c < segment_corners; ++c) {
            if (s.local[c] < 0) continue;
            const int b = c % facet_corners;
            const double sign = c < facet_corners ? -1 : 1;
            out.weight[s.local[c]] += sign * (c < facet_corners ? w.first : w.second)[s.corner][b];
            if (!gradients) continue;
            const SegmentWeightGradients& g = weight_gradients_[slot_[s.pair]];
            const double* d = (c < facet_corners ? g.first : g.second)[s.corner][b];
            for (int e = 0; e < segment_corners; ++e)
                for (int i = 0; s.local[e] >= 0 && i < 3; ++i)
                    out.weight_gradient(s.local[c], 3 * s.local[e] + i) += sign * d[3 * e + i];
        }
    }
}

// The first direction is that of the first edge at the vertex, seen in the tangent plane.
void Mortar::set_tangents(const double* X, int A, bool gradients, Grip& out) const {
    const Eigen::Index k = stencils_[A].size();
    const Normal normal = this->normal(X, A);
    const Vector3& n = normal.n;
    Eigen::MatrixXd N;  // dn/dx
    if (gradients) {
        N.resize(3, 3 * k);
        const auto M = normal_gradient(X, A);
        for (Eigen::Index v = 0; v < k; ++v) N.middleCols<3>(3 * v) = normal.derivative() * M[v];
    }
    const int b = skin_.dim == 2 ? 0 : ring_[A][0];
    const Vector3 edge = At(X + 3 * stencils_[A][b]) - At(X + 3 * stencils_[A][0]);
    visviva::set_tangents(skin_.dim, n, gradients ? &N : nullptr, edge, 0, b, out);
}

}  // namespace

std::unique_ptr<Gaps> make_mortar(Skin skin, const MortarOptions& options) {
    return std::make_unique<Mortar>(std::move(skin), options);
}

}  // namespace visviva
