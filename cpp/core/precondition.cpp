#include "precondition.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "dispatch.hpp"

namespace visviva {

namespace {

using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
using Block = Eigen::Map<Eigen::MatrixXd>;

std::int64_t diagonal_of(const BlockRows<double>& a, int i) {
    return std::lower_bound(a.col.begin() + a.row[i], a.col.begin() + a.row[i + 1], i) - a.col.begin();
}

bool invert(Dense& block) {
    if (block.rows() == 3) {  // nodes in space: no pivoting needed to tell a singular block
        const Eigen::Matrix3d small = block;
        const double determinant = small.determinant(), size = small.cwiseAbs().maxCoeff();
        if (!(std::abs(determinant) > 1e-12 * size * size * size)) return false;
        block = small.inverse();
        return true;
    }
    const Eigen::FullPivLU<Dense> lu(block);
    if (!lu.isInvertible()) return false;
    block = lu.inverse();
    return true;
}

Dense inverse_of(Dense block, bool diagonal_alone) {
    for (Eigen::Index r = 0; r < block.rows(); ++r)
        if (block(r, r) == 0) block(r, r) = 1;
    Dense diagonal = block.diagonal().asDiagonal();
    if (!diagonal_alone && invert(block)) return block;
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
    void apply(const double* r, double* z) override {
        kernels().block_multiply(inverse_.view(), r, z, 0, inverse_.n());
    }
    double memory() const override { return 8.0 * static_cast<double>(inverse_.value.size()); }
    const char* name() const override { return diagonal_alone_ ? "diagonal" : "block diagonal"; }

  private:
    bool diagonal_alone_;
    BlockRows<double> inverse_;
};

// Incomplete block LU on the pattern of the matrix: L (unit diagonal) and U in the place of A, with inverted
// diagonal blocks.
class Incomplete : public Preconditioning {
  public:
    bool build(const NodeMatrix& matrix) override {
        a_ = matrix.blocks();
        diagonal_.resize(a_.n());
        for (int i = 0; i < a_.n(); ++i) diagonal_[i] = diagonal_of(a_, i);
        std::vector<std::int64_t> place(a_.n(), -1);  // of block (i, j) in row i
        for (int i = 0; i < a_.n(); ++i) {
            for (auto k = a_.row[i]; k < a_.row[i + 1]; ++k) place[a_.col[k]] = k;
            for (auto k = a_.row[i]; k < diagonal_[i]; ++k) eliminate(k, place);
            Dense d = block(diagonal_[i]);
            if (!invert(d)) return message = "incomplete LU met a zero pivot", false;
            block(diagonal_[i]) = d;
            for (auto k = a_.row[i]; k < a_.row[i + 1]; ++k) place[a_.col[k]] = -1;
        }
        return true;
    }

    void apply(const double* r, double* z) override {
        for (int i = 0; i < a_.n(); ++i) {
            double* zi = z + static_cast<std::size_t>(i) * a_.rows;
            std::copy_n(r + static_cast<std::size_t>(i) * a_.rows, a_.rows, zi);
            for (auto k = a_.row[i]; k < diagonal_[i]; ++k) subtract(k, z, zi);
        }
        double s[6];
        for (int i = a_.n() - 1; i >= 0; --i) {
            double* zi = z + static_cast<std::size_t>(i) * a_.rows;
            for (auto k = diagonal_[i] + 1; k < a_.row[i + 1]; ++k) subtract(k, z, zi);
            std::copy_n(zi, a_.rows, s);
            std::fill_n(zi, a_.rows, 0.0);
            const double* p = a_.block(diagonal_[i]);
            for (int c = 0; c < a_.cols; ++c)
                for (int q = 0; q < a_.rows; ++q) zi[q] += p[c * a_.rows + q] * s[c];
        }
    }

    double memory() const override { return 8.0 * static_cast<double>(a_.value.size()); }
    const char* name() const override { return "incomplete LU"; }

  private:
    Block block(std::int64_t k) { return Block(a_.block(k), a_.rows, a_.cols); }

    void eliminate(std::int64_t k, const std::vector<std::int64_t>& place) {
        const int j = a_.col[k];
        const Dense l = block(k) * block(diagonal_[j]);
        block(k) = l;
        for (auto u = diagonal_[j] + 1; u < a_.row[j + 1]; ++u)
            if (const auto to = place[a_.col[u]]; to >= 0) block(to) -= l.lazyProduct(block(u));
    }

    void subtract(std::int64_t k, const double* z, double* zi) const {
        const double* p = a_.block(k);
        const double* zk = z + static_cast<std::size_t>(a_.col[k]) * a_.rows;
        for (int c = 0; c < a_.cols; ++c)
            for (int q = 0; q < a_.rows; ++q) zi[q] -= p[c * a_.rows + q] * zk[c];
    }

    BlockRows<double> a_;
    std::vector<std::int64_t> diagonal_;
};

}  // namespace

template <class T>
BlockRows<T> inverse_diagonal(const BlockRows<double>& a, bool diagonal_alone) {
    BlockRows<T> inverse;
    inverse.rows = inverse.cols = a.rows;
    for (int i = 0; i < a.n(); ++i) inverse.col.push_back(i), inverse.row.push_back(i + 1);
    inverse.allocate();
    for (int i = 0; i < a.n(); ++i) {
        const auto k = diagonal_of(a, i);
        const Dense block = k < a.row[i + 1] && a.col[k] == i
                                ? Dense(Eigen::Map<const Eigen::MatrixXd>(a.block(k), a.rows, a.cols))
                                : Dense(Dense::Zero(a.rows, a.rows));
        const Dense d = inverse_of(block, diagonal_alone);
        std::transform(d.data(), d.data() + d.size(), inverse.block(i),
                       [](double value) { return static_cast<T>(value); });
    }
    return inverse;
}
template BlockRows<double> inverse_diagonal(const BlockRows<double>&, bool);
template BlockRows<float> inverse_diagonal(const BlockRows<double>&, bool);

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
        case Preconditioner::multigrid:
            break;
    }
    return make_multigrid(choice);
}

}  // namespace visviva
