#include "visviva/linear/krylov/precondition.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "visviva/linear/krylov/incomplete.hpp"

namespace visviva {

namespace {

using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

std::int64_t diagonal_of(const BlockRows<double>& a, int i) {
    return std::lower_bound(a.col.begin() + a.row[i], a.col.begin() + a.row[i + 1], i) - a.col.begin();
}

Dense inverse_of(Dense block, bool diagonal_alone) {
    for (Eigen::Index r = 0; r < block.rows(); ++r)
        if (block(r, r) == 0) block(r, r) = 1;
    Dense diagonal = block.diagonal().asDiagonal();
    if (!diagonal_alone && invert_block(block.data(), static_cast<int>(block.rows()))) return block;
    for (Eigen::Index r = 0; r < block.rows(); ++r) diagonal(r, r) = 1 / diagonal(r, r);
    return diagonal;
}

class Nothing : public Preconditioning {
  public:
    bool build(const NodeMatrix& matrix) override { return n_ = matrix.size(), true; }
    void apply(const double* r, double* z) override { std::copy(r, r + n_, z); }
    const char* name() const override { return "no preconditioner"; }

  private:
    std::size_t n_ = 0;
};

class BlockDiagonal : public Preconditioning {
  public:
    explicit BlockDiagonal(bool diagonal_alone) : diagonal_alone_(diagonal_alone) {}
    bool build(const NodeMatrix& matrix) override {
        inverse_ = inverse_diagonal<double>(matrix.blocks(), diagonal_alone_);
        return true;
    }
    void apply(const double* r, double* z) override { multiply(inverse_, r, z); }
    double memory() const override { return 8.0 * static_cast<double>(inverse_.value.size()); }
    const char* name() const override { return diagonal_alone_ ? "diagonal" : "block diagonal"; }

  private:
    bool diagonal_alone_;
    BlockRows<double> inverse_;
};

class Incomplete : public Preconditioning {
  public:
    bool build(const NodeMatrix& matrix) override {
        if (factors_.build(matrix.blocks())) return true;
        return message = "incomplete LU met a zero pivot", false;
    }
    void apply(const double* r, double* z) override { factors_.apply(r, z); }
    double memory() const override { return factors_.memory(); }
    const char* name() const override { return "incomplete LU"; }

  private:
    IncompleteFactors factors_;
};

}  // namespace

template <class T>
BlockRows<T> inverse_diagonal(const BlockReader& matrix, bool diagonal_alone) {
    const BlockRows<double>& a = matrix.pattern;
    BlockRows<T> inverse;
    std::vector<double> room;
    inverse.rows = inverse.cols = a.rows;
    for (int i = 0; i < a.n(); ++i) inverse.col.push_back(i), inverse.row.push_back(i + 1);
    inverse.allocate();
    for (int i = 0; i < a.n(); ++i) {
        const auto k = diagonal_of(a, i);
        const Dense block = k < a.row[i + 1] && a.col[k] == i
                                ? Dense(Eigen::Map<const Eigen::MatrixXd>(
                                      matrix.row(i, room) + (k - a.row[i]) * a.rows * a.cols, a.rows, a.cols))
                                : Dense(Dense::Zero(a.rows, a.rows));
        const Dense d = inverse_of(block, diagonal_alone);
        std::transform(d.data(), d.data() + d.size(), inverse.block(i),
                       [](double value) { return static_cast<T>(value); });
    }
    return inverse;
}
template BlockRows<double> inverse_diagonal(const BlockReader&, bool);
template BlockRows<float> inverse_diagonal(const BlockReader&, bool);

std::unique_ptr<Preconditioning> make_preconditioning(const LinearChoice& choice) {
    switch (choice.preconditioner) {
        case Preconditioner::none:
            return std::make_unique<Nothing>();
        case Preconditioner::diagonal:
            return std::make_unique<BlockDiagonal>(true);
        case Preconditioner::block:
            return std::make_unique<BlockDiagonal>(false);
        case Preconditioner::incomplete:
            return std::make_unique<Incomplete>();
        case Preconditioner::saddle:
            return make_saddle();
        case Preconditioner::augmented:
            return make_augmented(choice);
        case Preconditioner::commutator:
            return make_commutator(choice);
        case Preconditioner::mixture:
            return make_mixture(choice);
        case Preconditioner::multigrid:
            break;
    }
    return make_multigrid(choice);
}

}  // namespace visviva
