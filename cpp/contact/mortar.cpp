// Mortar gaps: Phi_A = n_A . integral of N_A (x2 - x1) over the first surface where it faces the second, with
// the averaged normal n_A at vertex A (Puso & Laursen 2004; paper refs. [10][13]).
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/parallel.hpp"
#include "gaps.hpp"
#include "search.hpp"
#include "skew.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using At = Eigen::Map<const Vector3>;

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

struct Pair {
    int first, second;  // facets
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
        stencils_.resize(n_), shares_.resize(n_), ring_.resize(n_);
    }

    bool search(const double* from, const double* to) override;
    void values(const double* X, double* gap, double* area) override;
    void gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) override;
    void seconds(const double* X, const std::vector<double>& S, const double* direction,
                 std::vector<Gap>& out) override;
    void grips(const double* X, const std::vector<char>& wanted, bool gradients,
               std::vector<Grip>& out) override;

  private:
    bool near(const double* X, const Pair& pair) const;
    FacetPair corners(const double* X, const Pair& pair) const;
    void make_stencils();
    template <class F>
    void each_segment(const double* X, const std::vector<char>* wanted, F f);
    Vector3 moment(int A, double* area = nullptr) const;
    Normal normal(const double* X, int A) const;
    std::vector<Matrix3> moment_gradient(int A) const;
    std::vector<Matrix3> normal_gradient(const double* X, int A) const;
    void add_normal_curvature(int A, const Vector3& g, Eigen::MatrixXd& H) const;
    void second(const double* X, int A, double S, const double* direction, Gap& out) const;
    void set_weights(int A, bool gradients, Grip& out) const;
    void set_tangents(const double* X, int A, bool gradients, Grip& out) const;

    MortarOptions options_;
    NormalField normals_;
    BoxTree tree_;
    std::vector<Pair> pairs_;
    std::vector<std::vector<Share>> shares_;
    std::vector<std::vector<int>> ring_;  // per vertex and corner of its normal: places of next and previous
    std::vector<Segment> segments_;
    std::vector<SegmentWeights> weights_;
    std::vector<SegmentWeightGradients> weight_gradients_;
    std::vector<int> owner_;  // per pair: the vertex whose share of second derivatives is the pair's
};

bool Mortar::search(const double* from, const double* to) {
    std::vector<Box> boxes;
    std::vector<double> centres;
    for (int f = skin_.second_begin; f < skin_.n_facets(); ++f) {
        boxes.push_back(swept(skin_, f, from, to, 0));
        for (int i = 0; i < 3; ++i) centres.push_back(0.5 * (boxes.back().low[i] + boxes.back().high[i]));
    }
    if (pairs_.empty()) tree_.build(centres);
    tree_.refit(boxes);
    std::vector<Pair> pairs;
    std::vector<int> found;
    for (int f = 0; f < skin_.n_first; ++f) {
        tree_.query(swept(skin_, f, from, to, 2 * options_.reach), found);
        for (int k : found) {
            const int second = skin_.second_begin + k;
            const int *a = skin_.corners(f), *b = skin_.corners(second);
            const bool touching = std::any_of(a, a + facet_corners, [&](int v) {
                return v >= 0 && std::find(b, b + facet_corners, v) != b + facet_corners;
            });
            if (!touching) pairs.push_back({f, second});
        }
    }
    const bool same =
        pairs.size() == pairs_.size() &&
        std::equal(pairs.begin(), pairs.end(), pairs_.begin(),
                   [](const Pair& p, const Pair& q) { return p.first == q.first && p.second == q.second; });
    if (same) return false;
    pairs_ = std::move(pairs);
    make_stencils();
    return true;
}

void Mortar::make_stencils() {
    segments_.resize(pairs_.size());
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
    p.reach = options_.reach;
    for (int c = 0; c < segment_corners; ++c) {
        const int v = skin_.corners(c < facet_corners ? pair.first : pair.second)[c % facet_corners];
        for (int i = 0; v >= 0 && i < 3; ++i) p.x[c][i] = X[3 * v + i];
    }
    return p;
}

// Whether two facets look at each other and are within reach along the first one's normal.
bool Mortar::near(const double* X, const Pair& pair) const {
    Vector3 n[2], centre[2];
    double radius[2] = {};
    for (int s = 0; s < 2; ++s) {
        const int facet = s == 0 ? pair.first : pair.second, m = skin_.n_corners(facet);
        const int* c = skin_.corners(facet);
        auto x = [&](int a) -> Vector3 { return At(X + 3 * c[a]); };
        n[s] = m == 2   ? Vector3((x(1) - x(0)).cross(Vector3::UnitZ()))
               : m == 3 ? Vector3((x(1) - x(0)).cross(x(2) - x(0)))
                        : Vector3((x(2) - x(0)).cross(x(3) - x(1)));
        if (!(n[s].norm() > 0)) return false;
        n[s].normalize();
        centre[s].setZero();
        for (int a = 0; a < m; ++a) centre[s] += x(a) / m;
        for (int a = 0; a < m; ++a) radius[s] = std::max(radius[s], (x(a) - centre[s]).norm());
    }
    const Vector3 d = centre[1] - centre[0];
    const double along = d.dot(n[0]);
    return n[0].dot(n[1]) < facing_none && std::abs(along) < options_.reach &&
           (d - n[0] * along).norm() < radius[0] + radius[1];
}

template <class F>
void Mortar::each_segment(const double* X, const std::vector<char>* wanted, F f) {
    constexpr int together = 16;
    const int n = static_cast<int>(pairs_.size());
    parallel_for((n + together - 1) / together, [&](int task) {
        for (int p = task * together; p < std::min(n, (task + 1) * together); ++p) {
            const int* c = skin_.corners(pairs_[p].first);
            const bool asked = !wanted || std::any_of(c, c + skin_.n_corners(pairs_[p].first),
                                                      [&](int A) { return (*wanted)[A] != 0; });
            segments_[p].any = false;
            if (asked && near(X, pairs_[p])) f(corners(X, pairs_[p]), pairs_[p], segments_[p]);
        }
    });
}

Vector3 Mortar::moment(int A, double* area) const {
    Vector3 V = Vector3::Zero();
    for (const Share& s : shares_[A])
        if (const Segment& g = segments_[s.pair]; g.any) {
            V += At(g.V[s.corner]);
            if (area) *area += g.area[s.corner];
        }
    return V;
}

Normal Mortar::normal(const double* X, int A) const {
    Vector3 m;
    normals_.sum(X, A, m.data());
    return Normal(m);
}

void Mortar::values(const double* X, double* gap, double* area) {
    each_segment(X, nullptr,
                 [](const FacetPair& x, const Pair&, Segment& s) { segment_kernels().value(x, s); });
    for (int A = 0; A < n_; ++A) {
        gap[A] = area[A] = 0;
        if (!shares_[A].empty()) gap[A] = moment(A, &area[A]).dot(normal(X, A).n);
    }
}

// dV/dx by vertices of the stencil.
std::vector<Matrix3> Mortar::moment_gradient(int A) const {
    std::vector<Matrix3> G(stencils_[A].size(), Matrix3::Zero());
    for (const Share& s : shares_[A]) {
        const Segment& segment = segments_[s.pair];
        for (int c = 0; segment.any && c < segment_corners; ++c)
            for (int i = 0; s.local[c] >= 0 && i < 3; ++i)
                for (int j = 0; j < 3; ++j) G[s.local[c]](i, j) += segment.J[s.corner][i][3 * c + j];
    }
    return G;
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
void Mortar::add_normal_curvature(int A, const Vector3& g, Eigen::MatrixXd& H) const {
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

void Mortar::gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) {
    each_segment(X, &wanted,
                 [](const FacetPair& x, const Pair&, Segment& s) { segment_kernels().gradient(x, s); });
    parallel_for(n_, [&](int A) {
        if (!wanted[A]) return;
        const Normal n = normal(X, A);
        const Vector3 by_sum = n.gradient(moment(A));
        const auto G = moment_gradient(A), M = normal_gradient(X, A);
        out[A].gradient.resize(3 * G.size());
        for (std::size_t v = 0; v < G.size(); ++v)
            Eigen::Map<Vector3>(&out[A].gradient[3 * v]) = G[v].transpose() * n.n + M[v].transpose() * by_sum;
    });
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
    each_segment(X, &wanted, [&](const FacetPair& x, const Pair& pair, Segment& s) {
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

// Of one gap; the segments' common second derivatives go to the first wanted vertex of their first facet.
void Mortar::second(const double* X, int A, double S, const double* direction, Gap& out) const {
    const Normal n = normal(X, A);
    const Vector3 V = moment(A), by_sum = n.gradient(V);
    const auto G = moment_gradient(A), M = normal_gradient(X, A);
    const int k = static_cast<int>(G.size());
    Eigen::MatrixXd GG(3, 3 * k), MM(3, 3 * k);
    for (int v = 0; v < k; ++v) GG.middleCols<3>(3 * v) = G[v], MM.middleCols<3>(3 * v) = M[v];
    const Eigen::MatrixXd NN = n.derivative() * MM;
    Eigen::MatrixXd H = NN.transpose() * GG + GG.transpose() * NN + MM.transpose() * n.hessian(V) * MM;
    add_normal_curvature(A, by_sum, H);
    Eigen::VectorXd g = GG.transpose() * n.n + MM.transpose() * by_sum;
    out.gradient.assign(g.data(), g.data() + 3 * k);
    if (direction) {
        Eigen::VectorXd D(3 * k);
        for (int v = 0; v < k; ++v) D.segment<3>(3 * v) = At(direction + 3 * stencils_[A][v]);
        Eigen::VectorXd HD = H * D;
        for (const Share& s : shares_[A])
            for (int c = 0; segments_[s.pair].any && c < segment_corners; ++c)
                for (int i = 0; s.local[c] >= 0 && i < 3; ++i)
                    HD[3 * s.local[c] + i] += segments_[s.pair].HD[s.corner][3 * c + i];
        out.along.assign(HD.data(), HD.data() + 3 * k);
    }
    H *= S;
    for (const Share& s : shares_[A]) {
        const Segment& segment = segments_[s.pair];
        if (!segment.any || owner_[s.pair] != A) continue;
        for (int c = 0; c < segment_corners; ++c)
            for (int d = 0; s.local[c] >= 0 && d < segment_corners; ++d)
                for (int i = 0; s.local[d] >= 0 && i < 3; ++i)
                    for (int j = 0; j < 3; ++j)
                        H(3 * s.local[c] + i, 3 * s.local[d] + j) += segment.H[3 * c + i][3 * d + j];
    }
    out.hessian.assign(H.data(), H.data() + H.size());
}

// --- friction
// ----------------------------------------------------------------------------------------------
void Mortar::grips(const double* X, const std::vector<char>& wanted, bool gradients, std::vector<Grip>& out) {
    weights_.resize(pairs_.size());
    if (gradients) weight_gradients_.resize(pairs_.size());
    each_segment(X, &wanted, [&](const FacetPair& x, const Pair&, Segment& s) {
        const auto p = &s - segments_.data();
        if (gradients)
            segment_kernels().weight_gradients(x, weights_[p], weight_gradients_[p]);
        else
            segment_kernels().weights(x, weights_[p]);
        s.any = weights_[p].any;
    });
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
        if (!segments_[s.pair].any) continue;
        for (int c = 0; c < segment_corners; ++c) {
            if (s.local[c] < 0) continue;
            const int b = c % facet_corners;
            const double sign = c < facet_corners ? -1 : 1;
            const SegmentWeights& w = weights_[s.pair];
            out.weight[s.local[c]] += sign * (c < facet_corners ? w.first : w.second)[s.corner][b];
            if (!gradients) continue;
            const SegmentWeightGradients& g = weight_gradients_[s.pair];
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
    out.tangent.setZero();
    if (skin_.dim == 2) {
        const Matrix3 turn = skew(Vector3::UnitZ());
        out.tangent.col(0) = turn * n;
        if (gradients) out.tangent_gradient[0] = turn * N, out.tangent_gradient[1].setZero(3, 3 * k);
        return;
    }
    const int b = ring_[A][0];
    const Vector3 edge = At(X + 3 * stencils_[A][b]) - At(X + 3 * stencils_[A][0]);
    const Vector3 along = edge - n * n.dot(edge), t = along.normalized();
    out.tangent.col(0) = t, out.tangent.col(1) = n.cross(t);
    if (!gradients) return;
    const Matrix3 onto = Matrix3::Identity() - n * n.transpose(),
                  across = Matrix3::Identity() - t * t.transpose();
    Eigen::MatrixXd& first = out.tangent_gradient[0];
    first = -(n * (edge.transpose() * N) + n.dot(edge) * N);
    first.middleCols<3>(3 * b) += onto, first.leftCols<3>() -= onto;
    first = (across / along.norm() * first).eval();
    out.tangent_gradient[1] = skew(n) * first - skew(t) * N;
}

}  // namespace

std::unique_ptr<Gaps> make_mortar(Skin skin, const MortarOptions& options) {
    return std::make_unique<Mortar>(std::move(skin), options);
}

}  // namespace visviva
