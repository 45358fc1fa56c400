// Mortar gaps: Phi_A = n_A . integral of N_A (x2 - x1) over the first surface where it faces the second, with
// the averaged normal n_A at vertex A (Puso & Laursen 2004; paper refs. [10][13]).
#pragma once
#include <Eigen/Dense>
#include <vector>

#include "visviva/base/parallel.hpp"
#include "visviva/contact/gaps.hpp"
#include "visviva/contact/search.hpp"

namespace visviva::mortar {

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

template <class F>
void Mortar::each_near(const double* X, F f) {
    constexpr int together = 8;
    const int n = static_cast<int>(near_.size());
    parallel_for((n + together - 1) / together, [&](int task) {
        for (int k = task * together; k < std::min(n, (task + 1) * together); ++k)
            f(corners(X, pairs_[near_[k]]), near_[k], segments_[k]);
    });
}

}  // namespace visviva::mortar
