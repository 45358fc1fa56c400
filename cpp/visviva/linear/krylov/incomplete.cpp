#include "visviva/linear/krylov/incomplete.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace visviva {

namespace {

// c -= a b
template <int M>
inline void subtract_product(double* c, const double* a, const double* b, int rows) {
    const int m = M > 0 ? M : rows;
    for (int j = 0; j < m; ++j)
        for (int k = 0; k < m; ++k)
            for (int i = 0; i < m; ++i) c[j * m + i] -= a[k * m + i] * b[j * m + k];
}

// y -= a x
template <int M>
inline void subtract(double* y, const float* a, const double* x, int rows) {
    const int m = M > 0 ? M : rows;
    for (int j = 0; j < m; ++j)
        for (int i = 0; i < m; ++i) y[i] -= static_cast<double>(a[j * m + i]) * x[j];
}

}  // namespace

bool invert_block(double* block, int m) {
    if (m == 1) {
        if (block[0] == 0) return false;
        block[0] = 1 / block[0];
        return true;
    }
    if (m == 3) {  // nodes in space: no pivoting needed to tell a singular block
        const Eigen::Matrix3d a = Eigen::Map<Eigen::Matrix3d>(block);
        const double determinant = a.determinant(), size = a.cwiseAbs().maxCoeff();
        if (!(std::abs(determinant) > 1e-12 * size * size * size)) return false;
        Eigen::Map<Eigen::Matrix3d>{block} = a.inverse();
        return true;
    }
    using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
    Eigen::Map<Eigen::MatrixXd> a(block, m, m);
    const Eigen::FullPivLU<Dense> lu{Dense(a)};
    if (!lu.isInvertible()) return false;
    a = lu.inverse();
    return true;
}

bool IncompleteFactors::build(BlockRows<double> a) {
    diagonal_.resize(a.n());
    for (int i = 0; i < a.n(); ++i)
        diagonal_[i] =
            std::lower_bound(a.col.begin() + a.row[i], a.col.begin() + a.row[i + 1], i) - a.col.begin();
    const bool regular = a.rows == 1   ? eliminate<1>(a)
                         : a.rows == 2 ? eliminate<2>(a)
                         : a.rows == 3 ? eliminate<3>(a)
                                       : eliminate<0>(a);
    if (!regular) return false;
    factors_.rows = a.rows, factors_.cols = a.cols;
    factors_.value.assign(a.value.begin(), a.value.end());
    factors_.row = std::move(a.row), factors_.col = std::move(a.col);
    return true;
}

template <int M>
bool IncompleteFactors::eliminate(BlockRows<double>& a) {
    const int m = M > 0 ? M : a.rows;
    std::vector<std::int64_t> place(a.n(), -1);  // of block (i, j) in row i
    for (int i = 0; i < a.n(); ++i) {
        for (auto k = a.row[i]; k < a.row[i + 1]; ++k) place[a.col[k]] = k;
        for (auto k = a.row[i]; k < diagonal_[i]; ++k) {
            const int j = a.col[k];
            double l[36] = {};
            subtract_product<M>(l, a.block(k), a.block(diagonal_[j]), m);
            std::transform(l, l + m * m, a.block(k), [](double v) { return -v; });
            for (auto u = diagonal_[j] + 1; u < a.row[j + 1]; ++u)
                if (const auto to = place[a.col[u]]; to >= 0)
                    subtract_product<M>(a.block(to), a.block(k), a.block(u), m);
        }
        if (!invert_block(a.block(diagonal_[i]), m)) return false;
        for (auto k = a.row[i]; k < a.row[i + 1]; ++k) place[a.col[k]] = -1;
    }
    return true;
}

void IncompleteFactors::apply(const double* r, double* z) const {
    factors_.rows == 1   ? substitute<1>(r, z)
    : factors_.rows == 2 ? substitute<2>(r, z)
    : factors_.rows == 3 ? substitute<3>(r, z)
                         : substitute<0>(r, z);
}

template <int M>
void IncompleteFactors::substitute(const double* r, double* z) const {
    const BlockRows<float>& a = factors_;
    const int m = M > 0 ? M : a.rows;
    for (int i = 0; i < a.n(); ++i) {
        double s[6];
        std::copy_n(r + static_cast<std::ptrdiff_t>(i) * m, m, s);
        for (auto k = a.row[i]; k < diagonal_[i]; ++k)
            subtract<M>(s, a.block(k), z + static_cast<std::ptrdiff_t>(a.col[k]) * m, m);
        std::copy_n(s, m, z + static_cast<std::ptrdiff_t>(i) * m);
    }
    for (int i = a.n() - 1; i >= 0; --i) {
        double* zi = z + static_cast<std::ptrdiff_t>(i) * m;
        double s[6], solved[6] = {};
        std::copy_n(zi, m, s);
        for (auto k = diagonal_[i] + 1; k < a.row[i + 1]; ++k)
            subtract<M>(s, a.block(k), z + static_cast<std::ptrdiff_t>(a.col[k]) * m, m);
        subtract<M>(solved, a.block(diagonal_[i]), s, m);
        for (int c = 0; c < m; ++c) zi[c] = -solved[c];
    }
}

}  // namespace visviva
