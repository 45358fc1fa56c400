// Eigen's SparseLU on the full saddle-point system, equilibrated so that neither the step size nor the units
// of mass and length spoil the pivots (this contains the h-scaling of the multipliers of Bottasso, Bauchau &
// Cardona 2007).
#include <Eigen/SparseLU>
#include <cmath>

#include "scaled.hpp"

namespace visviva {

namespace {

class SparseLu : public LinearSolver {
  public:
    explicit SparseLu(bool careful) : careful_(careful) {}

    void analyze(const Csr& pattern, const Blocks& blocks) override {
        csr_ = &pattern, blocks_ = &blocks, tested_ = false;
        const int n = pattern.n;
        std::vector<Eigen::Triplet<double>> entries;
        for (int i = 0; i < n; ++i) {
            entries.emplace_back(i, i, 1.0);
            for (auto k = pattern.row[i]; k < pattern.row[i + 1]; ++k)
                entries.emplace_back(i, pattern.col[k], 1.0);
        }
        matrix_.resize(n, n);
        matrix_.setFromTriplets(entries.begin(), entries.end());
        to_.resize(pattern.col.size());
        for (int i = 0; i < n; ++i)
            for (auto k = pattern.row[i]; k < pattern.row[i + 1]; ++k)
                to_[k] = &matrix_.coeffRef(i, pattern.col[k]) - matrix_.valuePtr();
        diagonal_.resize(n);
        for (int i = 0; i < n; ++i) diagonal_[i] = &matrix_.coeffRef(i, i) - matrix_.valuePtr();
        lu_.analyzePattern(matrix_);
        row_.resize(n), col_.resize(n), right_.resize(n);
    }

    bool factor(const double* values, const Place&) override {
        double* a = matrix_.valuePtr();
        std::fill(a, a + matrix_.nonZeros(), 0.0);
        for (std::size_t k = 0; k < to_.size(); ++k) a[to_[k]] += values[k];
        equilibrate();
        if (regularization > 0)
            for (int i = 0; i < csr_->n; ++i)
                if (blocks_->multiplier[csr_->unknown[i]]) a[diagonal_[i]] -= regularization;
        lu_.factorize(matrix_);
        singular_ = -1;
        if (lu_.info() != Eigen::Success) return false;
        if (!careful_ || tested_) return true;
        return tested_ = regular();
    }

    bool solve(const double* r, const Place&, double* d) override {
        for (int i = 0; i < csr_->n; ++i) right_[i] = -r[csr_->unknown[i]] * row_[i];
        const Eigen::VectorXd s = lu_.solve(right_);
        for (int i = 0; i < csr_->n; ++i) d[csr_->unknown[i]] = s[i] * col_[i];
        return true;
    }

    void forget() override { tested_ = false; }
    int singular_unknown() const override { return singular_ < 0 ? -1 : csr_->unknown[singular_]; }
    std::string name() const override { return "sparse LU of the saddle-point system"; }

  private:
    bool regular() {
        const std::vector<double> any = arbitrary_vector(csr_->n);
        const Eigen::Map<const Eigen::VectorXd> b(any.data(), csr_->n);
        const Eigen::VectorXd s = lu_.solve(b);
        const double residual = (b - matrix_ * s).norm() / b.norm();
        if (!is_singular({s.data(), s.data() + s.size()}, residual, regularization)) return true;
        s.cwiseAbs().maxCoeff(&singular_);
        return false;
    }

    // Ruiz scaling: rows and columns to unit largest entry.
    void equilibrate() {
        const int n = csr_->n;
        row_.setOnes(), col_.setOnes();
        Eigen::VectorXd r(n), c(n);
        for (int sweep = 0; sweep < 3; ++sweep) {
            r.setZero(), c.setZero();
            for_each([&](int i, int j, double& a) {
                r[i] = std::max(r[i], std::abs(a));
                c[j] = std::max(c[j], std::abs(a));
            });
            for (int i = 0; i < n; ++i) {
                r[i] = r[i] > 0 ? 1 / std::sqrt(r[i]) : 1;
                c[i] = c[i] > 0 ? 1 / std::sqrt(c[i]) : 1;
            }
            for_each([&](int i, int j, double& a) { a *= r[i] * c[j]; });
            row_ = row_.cwiseProduct(r), col_ = col_.cwiseProduct(c);
        }
    }

    template <class F>
    void for_each(F f) {
        for (int j = 0; j < matrix_.outerSize(); ++j)
            for (Matrix::InnerIterator it(matrix_, j); it; ++it)
                f(static_cast<int>(it.row()), j, it.valueRef());
    }

    using Matrix = Eigen::SparseMatrix<double>;
    const Csr* csr_ = nullptr;
    const Blocks* blocks_ = nullptr;
    Matrix matrix_;
    Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>> lu_;
    std::vector<std::ptrdiff_t> to_, diagonal_;
    Eigen::VectorXd row_, col_, right_;
    bool careful_, tested_ = false;
    Eigen::Index singular_ = -1;
};

}  // namespace

std::unique_ptr<LinearSolver> make_sparse_lu(bool careful) { return std::make_unique<SparseLu>(careful); }

}  // namespace visviva
