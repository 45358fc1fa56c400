// The cycle runs in single precision, which is all a preconditioner needs and half the memory traffic.
#include "visviva/linear/krylov/multigrid.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "visviva/linear/krylov/aggregation.hpp"
#include "visviva/linear/krylov/smoother.hpp"

namespace visviva {

namespace {

using Vector = std::vector<float>;

constexpr double prolongation_weight = 4.0 / 3;  // over the largest eigenvalue
constexpr double singular_ratio = 1e-12;
constexpr std::size_t largest_coarsest = 4000;  // equations

// Without what couples nodes to constraints and pressures, which stand alone.
BlockRows<double> decoupled(const BlockRows<double>& a, const std::vector<char>& alone) {
    BlockRows<double> b;
    b.rows = a.rows, b.cols = a.cols;
    std::vector<std::int64_t> from;
    for (int i = 0; i < a.n(); ++i) {
        for (auto k = a.row[i]; k < a.row[i + 1]; ++k)
            if (a.col[k] == i || (!alone[i] && !alone[a.col[k]]))
                b.col.push_back(a.col[k]), from.push_back(k);
        b.row.push_back(static_cast<std::int64_t>(b.col.size()));
    }
    b.allocate();
    const int m = a.rows * a.cols;
    for (std::size_t k = 0; k < from.size(); ++k) std::copy_n(a.block(from[k]), m, b.block(k));
    for (int i = 0; i < b.n(); ++i)
        if (alone[i]) {
            double* own = b.block(b.row[i]);
            std::fill_n(own, m, 0.0);
            for (int r = 0; r < b.rows; ++r) own[r * b.rows + r] = 1;
        }
    return b;
}

double largest_of(const BlockReader& a) {
    double largest = 0;
    std::vector<double> room;
    for (int i = 0; i < a.pattern.n(); ++i) {
        const double* row = a.row(i, room);
        for (std::int64_t k = 0; k < a.size_of_row(i); ++k) largest = std::max(largest, std::abs(row[k]));
    }
    return largest;
}

struct Level {
    Smoother smoother;
    BlockRows<float> prolongation, restriction;
    Vector b, x, correction;
};

class Aggregated : public Grids {
  public:
    explicit Aggregated(const Aggregator& aggregator) : aggregator_(aggregator) {}

    bool build(const BlockReader& finest, const NearNull& near) override {
        outdated_ = false, usual_ = -1;
        levels_.clear();
        if (!aggregator_) return message = "multigrid needs PyAMG: pip install pyamg", false;
        if (!has_aggregates_) aggregates_ = aggregator_(finest.pattern, near.modes().data(), near.n);
        has_aggregates_ = true;
        const double largest = largest_of(finest);
        scale_ = largest > 0 ? 1 / largest : 1;
        BlockRows<double> coarse;
        for (const Aggregates& tentative : aggregates_)
            coarse = levels_.empty() ? add_level(finest, tentative) : add_level(coarse, tentative);
        return levels_.empty() ? factor_coarsest(finest) : factor_coarsest(coarse);
    }

    void apply(const double* r, double* z) override {
        Vector& b = levels_.empty() ? coarse_b_ : levels_[0].b;
        const std::size_t n = b.size();
        double largest = 0;
        for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(r[i]));
        if (largest == 0) return std::fill(z, z + n, 0.0);
        for (std::size_t i = 0; i < n; ++i) b[i] = static_cast<float>(r[i] / largest);
        cycle(0);
        const Vector& x = levels_.empty() ? coarse_x_ : levels_[0].x;
        for (std::size_t i = 0; i < n; ++i) z[i] = scale_ * largest * x[i];
    }

    void learn(int iterations) override {
        if (usual_ < 0) usual_ = iterations;
        outdated_ = iterations > usual_ + usual_ / 2 + 3;
    }
    bool serve() const override { return !levels_.empty() && !outdated_; }
    void forget() override { levels_.clear(), outdated_ = true; }
    double memory() const override {
        double bytes = 8.0 * static_cast<double>(dense_.size());
        for (const Level& l : levels_)
            bytes += l.smoother.memory() +
                     4.0 * static_cast<double>(l.prolongation.value.size() + l.restriction.value.size());
        return bytes;
    }

  private:
    // Returns the matrix of the next level.
    BlockRows<double> add_level(const BlockReader& a, const Aggregates& tentative) {
        Smoother smoother(a, scale_);
        smoother.damp_upper();
        Prolongation p =
            smoothed(a, smoother.inverse(), scale_ * prolongation_weight / smoother.upper(), tentative);
        BlockRows<double> coarse =
            coarse_matrix(a, p);  // before there are the ways up and down: it takes most
        const Vector room(smoother.size());
        BlockRows<float> down = p.down();
        levels_.push_back({std::move(smoother), std::move(p).up(), std::move(down), room, room, room});
        return coarse;
    }

    void cycle(std::size_t k) {
        if (k == levels_.size()) return solve_coarsest();
        Level& l = levels_[k];
        l.smoother.smooth(l.b, l.x, true);
        multiply(l.restriction, l.smoother.defect(l.b, l.x),
                 k + 1 < levels_.size() ? levels_[k + 1].b : coarse_b_);
        cycle(k + 1);
        multiply(l.prolongation, k + 1 < levels_.size() ? levels_[k + 1].x : coarse_x_, l.correction,
                 [&](std::size_t i) { l.x[i] += l.correction[i]; });
        l.smoother.smooth(l.b, l.x, false);
    }

    bool factor_coarsest(const BlockReader& matrix) {
        const BlockRows<double>& a = matrix.pattern;
        std::vector<double> room;
        if (a.size() > largest_coarsest) return message = "multigrid finds no coarser grid", false;
        const auto n = static_cast<Eigen::Index>(a.size());
        dense_.setZero(n, n);
        for (int i = 0; i < a.n(); ++i) {
            const double* value = matrix.row(i, room);
            for (auto k = a.row[i]; k < a.row[i + 1]; ++k)
                for (int c = 0; c < a.cols; ++c)
                    for (int r = 0; r < a.rows; ++r)
                        dense_(i * a.rows + r, a.col[k] * a.cols + c) = scale_ * *value++;
        }
        // Aggregates with fewer freedoms than there are modes leave empty rows.
        for (Eigen::Index i = 0; i < n; ++i)
            if (std::abs(dense_(i, i)) < 1e-30) dense_(i, i) = 1;
        Eigen::VectorXd d = dense_.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
        dense_ = d.asDiagonal() * dense_ * d.asDiagonal();
        coarse_scale_ = d;
        lu_.compute(dense_);
        coarse_b_.assign(a.size(), 0), coarse_x_.assign(a.size(), 0);
        const auto pivots = lu_.matrixLU().diagonal().cwiseAbs();
        if (pivots.minCoeff() > singular_ratio * pivots.maxCoeff()) return true;
        levels_.clear();
        return message =
                   "the tangent is singular: a motion that nothing resists, such as a rigid one of an "
                   "unsupported body",
               false;
    }

    void solve_coarsest() {
        const auto n = dense_.rows();
        const Eigen::VectorXd b = Eigen::Map<Eigen::VectorXf>(coarse_b_.data(), n).cast<double>();
        const Eigen::VectorXd s = lu_.solve(coarse_scale_.cwiseProduct(b));
        Eigen::Map<Eigen::VectorXf>(coarse_x_.data(), n) = coarse_scale_.cwiseProduct(s).cast<float>();
    }

    Aggregator aggregator_;
    std::vector<Aggregates> aggregates_;  // of the pattern, whatever the values
    bool has_aggregates_ = false;
    std::vector<Level> levels_;
    double scale_ = 1;
    Eigen::MatrixXd dense_;
    Eigen::PartialPivLU<Eigen::MatrixXd> lu_;
    Eigen::VectorXd coarse_scale_;
    Vector coarse_b_, coarse_x_;
    int usual_ = -1;
    bool outdated_ = false;
};

class Multigrid : public Preconditioning {
  public:
    explicit Multigrid(const LinearChoice& choice) : grids_(make_grids(choice.aggregator)) {}

    bool build(const NodeMatrix& matrix) override {
        if (grids_->serve()) return kept_ = true;
        kept_ = false;
        const auto& alone = matrix.algebraic();
        const bool mixed = std::find(alone.begin(), alone.end(), 1) != alone.end();
        const bool built =
            mixed ? build(decoupled(matrix.blocks(), alone), matrix) : build(matrix.reader(), matrix);
        if (!built) message = grids_->message;
        return built;
    }
    void apply(const double* r, double* z) override { grids_->apply(r, z); }
    void learn(int iterations) override { grids_->learn(iterations); }
    bool kept() const override { return kept_; }
    void forget() override { grids_->forget(); }
    const char* name() const override { return "algebraic multigrid"; }
    double memory() const override { return grids_->memory(); }

  private:
    bool build(const BlockReader& a, const NodeMatrix& matrix) {
        return grids_->build(a, {matrix.n_modes(), [&matrix] { return matrix.modes(); }});
    }

    std::unique_ptr<Grids> grids_;
    bool kept_ = false;
};

}  // namespace

std::unique_ptr<Grids> make_grids(const Aggregator& aggregator) {
    return std::make_unique<Aggregated>(aggregator);
}

std::unique_ptr<Preconditioning> make_multigrid(const LinearChoice& choice) {
    return std::make_unique<Multigrid>(choice);
}

}  // namespace visviva
