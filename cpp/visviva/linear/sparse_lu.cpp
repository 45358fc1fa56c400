// Eigen's SparseLU on the full saddle-point system, scaled so that neither the step size nor the units of
// mass and length spoil the pivots.
#include <Eigen/SparseLU>

#include "visviva/linear/scaled.hpp"

namespace visviva {

namespace {

class SparseLu : public LinearSolver {
  public:
    explicit SparseLu(bool careful) : careful_(careful) {
        report_.name = "sparse LU of the saddle-point system";
    }

    void analyze(const Csr& pattern, const Blocks& blocks) override {
        tested_ = false;
        scaled_.analyze(pattern, blocks, MatrixKind::general);
        const int n = pattern.n;
        const auto &row = scaled_.row(), &col = scaled_.col();
        std::vector<Eigen::Triplet<double>> entries;
        for (int i = 0; i < n; ++i)
            for (int k = row[i]; k < row[i + 1]; ++k) entries.emplace_back(i, col[k], 1.0);
        matrix_.resize(n, n);
        matrix_.setFromTriplets(entries.begin(), entries.end());
        to_.clear();
        for (const auto& e : entries) to_.push_back(&matrix_.coeffRef(e.row(), e.col()) - matrix_.valuePtr());
        lu_.analyzePattern(matrix_);
        right_.resize(n);
    }

    bool factor(const double* values, const Place&) override {
        report_.singular_unknown = -1;
        if (!scaled_.fill(values, regularization)) return false;
        for (std::size_t k = 0; k < to_.size(); ++k) matrix_.valuePtr()[to_[k]] = scaled_.value()[k];
        lu_.factorize(matrix_);
        if (lu_.info() != Eigen::Success) return locate(), false;
        if (!careful_ || tested_) return true;
        return tested_ = regular();
    }

    bool solve(const double* r, const Place&, double* d, double) override {
        scaled_.right_hand_side(r, right_.data());
        const Eigen::VectorXd s = lu_.solve(right_);
        scaled_.increment(s.data(), d);
        return true;
    }

    void forget() override { tested_ = false; }

  private:
    // Where a pivot vanishes: with the diagonal shifted by no more than rounding there are factors, whose
    // solutions grow where the matrix is singular.
    void locate() {
        constexpr double shift = 1e-14;
        for (int i = 0; i < scaled_.n(); ++i) matrix_.coeffRef(i, i) += shift;
        lu_.factorize(matrix_);
        if (lu_.info() == Eigen::Success) name_largest(lu_.solve(arbitrary()));
    }

    Eigen::VectorXd arbitrary() const {
        const std::vector<double> any = arbitrary_vector(scaled_.n());
        return Eigen::Map<const Eigen::VectorXd>(any.data(), scaled_.n());
    }

    bool regular() {
        const Eigen::VectorXd b = arbitrary(), s = lu_.solve(b);
        const double residual = (b - matrix_ * s).norm() / b.norm();
        if (!is_singular({s.data(), s.data() + s.size()}, residual, regularization)) return true;
        name_largest(s);
        return false;
    }

    void name_largest(const Eigen::VectorXd& s) {
        Eigen::Index at;
        s.cwiseAbs().maxCoeff(&at);
        report_.singular_unknown = scaled_.unknown(static_cast<int>(at));
    }

    using Matrix = Eigen::SparseMatrix<double>;
    ScaledMatrix scaled_;
    Matrix matrix_;
    Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>> lu_;
    std::vector<std::ptrdiff_t> to_;
    Eigen::VectorXd right_;
    bool careful_, tested_ = false;
};

}  // namespace

std::unique_ptr<LinearSolver> make_sparse_lu(bool careful) { return std::make_unique<SparseLu>(careful); }

}  // namespace visviva
