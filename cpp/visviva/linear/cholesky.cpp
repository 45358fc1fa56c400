// Eigen's simplicial Cholesky factorisation L D L^T of positive definite matrices: always there, fast enough
// for small and two-dimensional problems.
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "visviva/linear/fill.hpp"
#include "visviva/linear/scaled.hpp"

namespace visviva {

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Permutation = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;

constexpr double smallest_pivot = 1e-13;  // of a matrix with unit diagonal

class Cholesky : public LinearSolver {
  public:
    explicit Cholesky(const LinearChoice& choice) : choice_(choice) {
        regularization = choice.regularization;
        report_.name = "simplicial Cholesky", report_.n_negative = 0;
    }

    void analyze(const Csr& pattern, const Blocks& blocks) override {
        matrix_.analyze(pattern, blocks, MatrixKind::definite);
        order();
        report_.memory = 24.0 * static_cast<double>(count_fill(permuted_));
        require_memory(report_.memory, choice_.memory_limit, matrix_.n());
        ldlt_.analyzePattern(permuted_);
        b_.resize(matrix_.n()), s_.resize(matrix_.n());
    }

    bool factor(const double* values, const Place&) override {
        report_.message.clear(), report_.singular_unknown = -1;
        if (!matrix_.fill(values, regularization)) return failed(matrix_.message());
        for (std::size_t k = 0; k < to_.size(); ++k) permuted_.valuePtr()[to_[k]] = matrix_.value()[k];
        ldlt_.factorize(permuted_);
        const auto pivots = ldlt_.vectorD();
        if (ldlt_.info() != Eigen::Success) {  // it stopped at the first that is zero
            const auto at = std::find(pivots.begin(), pivots.end(), 0.0) - pivots.begin();
            if (at < pivots.size()) name_pivot(at);
            return failed("the tangent has a zero pivot");
        }
        Eigen::Index at = 0;
        const double least = pivots.minCoeff(&at);
        if (least > smallest_pivot) return true;
        name_pivot(at);
        return failed(least < -smallest_pivot ? "the tangent is not positive definite"
                                              : "the tangent is singular");
    }

    bool solve(const double* r, const Place&, double* d, double) override {
        matrix_.right_hand_side(r, b_.data());
        const Eigen::VectorXd s = permutation_ * b_;
        s_ = inverse_ * ldlt_.solve(s).eval();
        matrix_.increment(s_.data(), d);
        return true;
    }

  private:
    bool failed(const std::string& why) { return report_.message = why, false; }
    void name_pivot(Eigen::Index at) { report_.singular_unknown = matrix_.unknown(inverse_.indices()[at]); }

    // Permutes the upper triangle by approximate minimum degree, and remembers where every entry went.
    void order() {
        const int n = matrix_.n();
        const auto &row = matrix_.row(), &col = matrix_.col();
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(col.size());
        for (int i = 0; i < n; ++i)
            for (int k = row[i]; k < row[i + 1]; ++k) entries.emplace_back(i, col[k], 1.0);
        Matrix upper(n, n);
        upper.setFromTriplets(entries.begin(), entries.end());
        Eigen::AMDOrdering<int>()(upper.selfadjointView<Eigen::Upper>(), inverse_);
        permutation_ = inverse_.inverse();
        const auto& p = permutation_.indices();
        for (auto& e : entries) {
            const auto [i, j] = std::minmax(p[e.row()], p[e.col()]);
            e = {i, j, 1.0};
        }
        permuted_.resize(n, n);
        permuted_.setFromTriplets(entries.begin(), entries.end());
        to_.resize(entries.size());
        for (std::size_t k = 0; k < entries.size(); ++k)
            to_[k] = &permuted_.coeffRef(entries[k].row(), entries[k].col()) - permuted_.valuePtr();
    }

    LinearChoice choice_;
    ScaledMatrix matrix_;
    Matrix permuted_;
    std::vector<std::ptrdiff_t> to_;
    Permutation permutation_, inverse_;
    Eigen::SimplicialLDLT<Matrix, Eigen::Upper, Eigen::NaturalOrdering<int>> ldlt_;
    Eigen::VectorXd b_, s_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_cholesky(const LinearChoice& choice) {
    return std::make_unique<Cholesky>(choice);
}

}  // namespace visviva
