// The matrix of a direct solver: rows and columns brought to unit size, so that neither the step size nor the
// units of mass and length spoil the pivots; every diagonal entry present; of a symmetric matrix the upper
// triangle alone.
#pragma once
#include "visviva/linear/linear_choice.hpp"

namespace visviva {

class ScaledMatrix {
  public:
    void analyze(const Csr& pattern, const Blocks& blocks, MatrixKind kind);
    // Takes new values; the diagonal of redundant constraints is lowered by `regularization`. False: some
    // value is not finite, or the matrix was said to be symmetric and is not.
    bool fill(const double* values, double regularization);
    const std::string& message() const { return message_; }

    // The right-hand side -r of the scaled system, and the increment from its solution.
    void right_hand_side(const double* r, double* b) const;
    void increment(const double* s, double* d) const;
    // |b - A s| / |b|
    double residual(const double* b, const double* s) const;

    int n() const { return n_; }
    int unknown(int equation) const { return csr_->unknown[equation]; }
    bool symmetric() const { return kind_ != MatrixKind::general; }
    const std::vector<int>& row() const { return row_; }
    const std::vector<int>& col() const { return col_; }
    const std::vector<double>& value() const { return value_; }

  private:
    bool copy(const double* values);
    void scale_by_diagonal();
    void scale_by_largest();
    void scale_by_units();
    std::vector<double> typical_energies() const;
    void find_parts();
    double scale(int equation) const { return blocks_->scale.empty() ? 1 : blocks_->scale[equation]; }
    void apply(const std::vector<double>& left, const std::vector<double>& right);
    template <class F>
    void for_each(F f) const;

    int n_ = 0;
    MatrixKind kind_ = MatrixKind::general;
    const Csr* csr_ = nullptr;
    const Blocks* blocks_ = nullptr;
    std::vector<int> row_, col_;
    std::vector<std::size_t> diagonal_;
    std::vector<int> part_;  // of each equation, coupled to no others
    int n_parts_ = 0;
    std::vector<double> value_, left_, right_;
    std::vector<double> probe_;  // any vector, to tell a symmetric matrix from another
    std::string message_;
};

// Pseudo-random numbers in (-1, 1), the same in every run.
std::vector<double> arbitrary_vector(int n);

// Whether the solution to an arbitrary right-hand side, and its relative residual, show a matrix (with
// entries of unit size) that is singular to working precision.
bool is_singular(const std::vector<double>& solution, double residual, double regularization);

}  // namespace visviva
