// Eigen's SparseLU on the full saddle-point system, scaled so that neither the step size nor the units of
// mass and length spoil the pivots.
#include <Eigen/SparseLU>

#include "visviva/linear/fill.hpp"
#include "visviva/linear/linear_choice.hpp"
#include "visviva/linear/scaled.hpp"

namespace visviva {

namespace {

constexpr int few = 3000;     // unknowns whose factors fit anywhere
constexpr double bytes = 12;  // of an entry of the factors

class SparseLu : public LinearSolver {
  public:
    SparseLu(bool careful, double memory_limit) : careful_(careful), memory_limit_(memory_limit) {
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
        if (n > few) {
            report_.memory = bytes * static_cast<double>(count_entries());
            require_memory(report_.memory, memory_limit_, n);
        }
        lu_.analyzePattern(matrix_);
        right_.resize(n);
    }

    bool factor(const double* values, const Place&) override {
        report_.singular_unknown = -1;
        if (!scaled_.fill(values, regularization)) return false;
        for (std::size_t k = 0; k < to_.size(); ++k) matrix_.valuePtr()[to_[k]] = scaled_.value()[k];
        lu_.factorize(matrix_);
        if (lu_.info() != Eigen::Success) return locate(), false;
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
    // Of the factors of the symmetrised pattern in the order of least degree: 0.8 to 1.1 of what pivots make
    // of solids, 0.4 to 0.8 of flows in the plane.
    std::int64_t count_entries() const {
        const Matrix both = Matrix(matrix_.transpose()) + matrix_;
        Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> inverse;
        Eigen::AMDOrdering<int>()(both, inverse);
        Matrix upper(both.rows(), both.cols());
        upper.selfadjointView<Eigen::Upper>() =
            both.selfadjointView<Eigen::Upper>().twistedBy(inverse.inverse());
        return 2 * count_fill(upper);
    }

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
    double memory_limit_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_sparse_lu(bool careful, double memory_limit) {
    return std::make_unique<SparseLu>(careful, memory_limit);
}

}  // namespace visviva
