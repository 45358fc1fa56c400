// Values and derivatives of mortar gaps.
#include "visviva/contact/mortar.hpp"

#include <algorithm>

#include "visviva/contact/skew.hpp"

namespace visviva {

namespace mortar {

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

}  // namespace mortar

std::unique_ptr<Gaps> make_mortar(Skin skin, const MortarOptions& options) {
    return std::make_unique<mortar::Mortar>(std::move(skin), options);
}

}  // namespace visviva
