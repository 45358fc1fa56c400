// Preconditioners of saddle points [K B; C E], by the diagonal blocks D of the nodes of what moves and the
// Schur complement S = E - C D^-1 B, which is factored. Saddle: [D B; C E]. Where steps are short D is close
// to K, and a few iterations do. Augmented: [K B; 0 S] with multigrid for K. Pressures of contact augment K
// in statics, and then D^-1 is as good as K^-1 between their columns, whatever the mesh (Benzi, Golub &
// Liesen 2005).
#include <Eigen/SparseLU>
#include <algorithm>

#include "visviva/linear/krylov/precondition.hpp"

namespace visviva {

namespace {

class Saddle : public Preconditioning {
  public:
    bool build(const NodeMatrix& matrix) override {
        a_ = &matrix.blocks();
        number(matrix.algebraic());
        inverse_ = inverse_diagonal<double>(*a_, false);
        for (int k : algebraic_) std::fill_n(inverse_.block(k), a_->rows * a_->cols, 0.0);
        gather();
        return factor();
    }

    // z = D^-1 r, lambda = S^-1 (r - C z), z -= D^-1 B lambda
    void apply(const double* r, double* z) override {
        multiply(inverse_, r, z);
        const int m = a_->rows;
        Eigen::VectorXd s(static_cast<Eigen::Index>(algebraic_.size()));
        for (std::size_t i = 0; i < algebraic_.size(); ++i) {
            s[i] = r[slot(algebraic_[i])];
            for (auto k = start_[i]; k < start_[i + 1]; ++k)
                for (int c = 0; c < m; ++c) s[i] -= row_[k * m + c] * z[slot(node_[k]) + c];
        }
        if (!algebraic_.empty()) s = lu_.solve(s).eval();
        for (std::size_t i = 0; i < algebraic_.size(); ++i)
            for (auto k = start_[i]; k < start_[i + 1]; ++k)
                for (int c = 0; c < m; ++c) z[slot(node_[k]) + c] -= solved_[k * m + c] * s[i];
        for (std::size_t i = 0; i < algebraic_.size(); ++i) {
            std::copy_n(r + slot(algebraic_[i]), m, z + slot(algebraic_[i]));  // padding
            z[slot(algebraic_[i])] = s[i];
        }
    }

    // s = S^-1 of what r says of constraints and pressures
    Eigen::VectorXd solved(const double* r) const {
        Eigen::VectorXd s(static_cast<Eigen::Index>(algebraic_.size()));
        for (std::size_t i = 0; i < algebraic_.size(); ++i) s[i] = r[slot(algebraic_[i])];
        return algebraic_.empty() ? s : Eigen::VectorXd(lu_.solve(s));
    }

    bool starts_exact() const override { return true; }
    double memory() const override { return 16.0 * static_cast<double>(row_.size() + inverse_.value.size()); }
    const char* name() const override { return "block diagonal with exact constraints"; }

  protected:
    std::size_t slot(int node) const { return static_cast<std::size_t>(node) * a_->rows; }

    void number(const std::vector<char>& algebraic) {
        algebraic_.clear();
        is_algebraic_ = algebraic;
        for (int i = 0; i < a_->n(); ++i)
            if (algebraic[i]) algebraic_.push_back(i);
    }

    const double* block(int i, int j) const {
        const auto begin = a_->col.begin() + a_->row[i], end = a_->col.begin() + a_->row[i + 1];
        const auto at = std::lower_bound(begin, end, j);
        return at != end && *at == j ? a_->block(at - a_->col.begin()) : nullptr;
    }

    // Per constraint: the nodes that it touches, its row C, its column B, and D^-1 B.
    void gather() {
        const int m = a_->rows;
        start_.assign(1, 0), node_.clear(), row_.clear(), column_.clear(), solved_.clear();
        for (int i : algebraic_) {
            for (auto k = a_->row[i]; k < a_->row[i + 1]; ++k) {
                const int j = a_->col[k];
                const double* column = is_algebraic_[j] ? nullptr : block(j, i);
                if (!column) continue;
                double row[6] = {}, solved[6] = {};
                bool any = false;
                for (int c = 0; c < m; ++c)
                    row[c] = a_->block(k)[c * m], any = any || row[c] != 0 || column[c] != 0;
                if (!any) continue;
                for (int c = 0; c < m; ++c)
                    for (int q = 0; q < m; ++q) solved[q] += inverse_.block(j)[c * m + q] * column[c];
                node_.push_back(j);
                column_.insert(column_.end(), column, column + m);
                row_.insert(row_.end(), row, row + m), solved_.insert(solved_.end(), solved, solved + m);
            }
            start_.push_back(static_cast<std::int64_t>(node_.size()));
        }
    }

    bool factor() {
        const int n = static_cast<int>(algebraic_.size()), m = a_->rows;
        if (n == 0) return true;
        std::vector<std::vector<std::pair<int, std::int64_t>>> at(
            a_->n());  // per node: constraints and places
        for (int i = 0; i < n; ++i)
            for (auto k = start_[i]; k < start_[i + 1]; ++k) at[node_[k]].push_back({i, k});
        std::vector<Eigen::Triplet<double>> entries;
        for (int i = 0; i < n; ++i) {
            for (auto k = a_->row[algebraic_[i]]; k < a_->row[algebraic_[i] + 1]; ++k)
                if (is_algebraic_[a_->col[k]]) {
                    const auto j = std::lower_bound(algebraic_.begin(), algebraic_.end(), a_->col[k]);
                    entries.emplace_back(i, static_cast<int>(j - algebraic_.begin()), a_->block(k)[0]);
                }
            for (auto k = start_[i]; k < start_[i + 1]; ++k)
                for (const auto& [j, place] : at[node_[k]]) {
                    double sum = 0;
                    for (int c = 0; c < m; ++c) sum += row_[k * m + c] * solved_[place * m + c];
                    entries.emplace_back(i, j, -sum);
                }
        }
        Eigen::SparseMatrix<double> S(n, n);
        S.setFromTriplets(entries.begin(), entries.end());
        lu_.compute(S);
        if (lu_.info() == Eigen::Success) return true;
        return message = "the constraints depend on each other", false;
    }

    const BlockRows<double>* a_ = nullptr;
    BlockRows<double> inverse_;
    std::vector<char> is_algebraic_;
    std::vector<int> algebraic_, node_;
    std::vector<std::int64_t> start_;
    std::vector<double> row_, column_, solved_;
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu_;
};

class Augmented : public Saddle {
  public:
    explicit Augmented(const LinearChoice& choice) : inner_(make_multigrid(choice)) {}

    bool build(const NodeMatrix& matrix) override {
        if (!inner_->build(matrix)) return message = inner_->message, false;
        return Saddle::build(matrix);
    }

    // lambda = S^-1 r, z = K^-1 (r - B lambda)
    void apply(const double* r, double* z) override {
        const int m = a_->rows;
        const Eigen::VectorXd s = solved(r);
        rest_.assign(r, r + a_->size());
        for (std::size_t i = 0; i < algebraic_.size(); ++i) {
            for (auto k = start_[i]; k < start_[i + 1]; ++k)
                for (int c = 0; c < m; ++c) rest_[slot(node_[k]) + c] -= column_[k * m + c] * s[i];
            std::fill_n(rest_.data() + slot(algebraic_[i]), m, 0.0);
        }
        inner_->apply(rest_.data(), z);
        for (std::size_t i = 0; i < algebraic_.size(); ++i) {
            std::copy_n(r + slot(algebraic_[i]), m, z + slot(algebraic_[i]));  // padding
            z[slot(algebraic_[i])] = s[i];
        }
    }

    void learn(int iterations) override { inner_->learn(iterations); }
    bool kept() const override { return inner_->kept(); }
    void forget() override { inner_->forget(); }
    bool starts_exact() const override { return false; }
    double memory() const override { return Saddle::memory() + inner_->memory(); }
    const char* name() const override { return "algebraic multigrid with pressures by their complement"; }

  private:
    std::unique_ptr<Preconditioning> inner_;
    std::vector<double> rest_;
};

}  // namespace

std::unique_ptr<Preconditioning> make_augmented(const LinearChoice& choice) {
    return std::make_unique<Augmented>(choice);
}
std::unique_ptr<Preconditioning> make_saddle() { return std::make_unique<Saddle>(); }

}  // namespace visviva
