// References of tests: dense matrices, arbitrary numbers, differences.
#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "visviva/linear/linear.hpp"

namespace visviva {

class Numbers {
  public:
    explicit Numbers(unsigned seed) : generator_(seed) {}
    /// In (-1, 1), the same on every machine.
    double one() { return 2.0 * generator_() / 4294967296.0 - 1; }
    int below(int n) { return static_cast<int>(generator_() % static_cast<unsigned>(n)); }
    Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index cols) {
        return Eigen::MatrixXd::NullaryExpr(rows, cols, [this] { return one(); });
    }
    Eigen::VectorXd vector(Eigen::Index n) { return matrix(n, 1); }
    Eigen::Matrix3d rotation() {
        return Eigen::Quaterniond(one(), one(), one(), one()).normalized().toRotationMatrix();
    }

  private:
    std::mt19937 generator_;
};

/// |a - b| over |b|, or |a| where b vanishes.
inline double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    const double size = b.norm();
    return (a - b).norm() / (size > 0 ? size : 1);
}

/// df/dx by central differences of fourth order, one column per variable.
template <class F>
Eigen::MatrixXd by_differences(F f, const Eigen::VectorXd& x, double h) {
    Eigen::MatrixXd J;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        auto at = [&](double factor) -> Eigen::VectorXd {
            Eigen::VectorXd y = x;
            y[i] += factor * h;
            return f(y);
        };
        const Eigen::VectorXd column = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h);
        if (i == 0) J.resize(column.size(), x.size());
        J.col(i) = column;
    }
    return J;
}

/// A dense matrix as solvers get it: compressed rows of what `coupled` says (the matrix itself unless given),
/// with a fixed unknown between the free ones, so that equations and unknowns differ.
struct Problem {
    static constexpr int fixed = 2;
    Csr csr;
    Blocks blocks;
    std::vector<double> values;

    static int unknown(int equation) { return equation < fixed ? equation : equation + 1; }

    explicit Problem(const Eigen::MatrixXd& a) : Problem(a, a) {}
    Problem(const Eigen::MatrixXd& a, const Eigen::MatrixXd& coupled) {
        csr.n = static_cast<int>(a.rows());
        csr.equation.assign(csr.n + 1, -1);
        blocks.multiplier.assign(csr.n + 1, 0);
        csr.row.push_back(0);
        for (int i = 0; i < csr.n; ++i) {
            csr.unknown.push_back(unknown(i)), csr.equation[unknown(i)] = i;
            for (int j = 0; j < csr.n; ++j)
                if (i == j || coupled(i, j) != 0 || coupled(j, i) != 0) csr.col.push_back(j);
            csr.row.push_back(static_cast<std::int64_t>(csr.col.size()));
        }
        take(a);
    }
    void take(const Eigen::MatrixXd& a) {
        values.clear();
        for (int i = 0; i < csr.n; ++i)
            for (auto k = csr.row[i]; k < csr.row[i + 1]; ++k) values.push_back(a(i, csr.col[k]));
    }
    /// One number per unknown from one per equation.
    template <class T>
    std::vector<T> by_unknown(const std::vector<T>& by_equation, T other) const {
        std::vector<T> all(csr.equation.size(), other);
        for (int i = 0; i < csr.n; ++i) all[unknown(i)] = by_equation[i];
        return all;
    }
    bool factor(LinearSolver& solver) const { return solver.factor(values.data(), {}); }
    /// x of A x = b; not a number: not solved.
    Eigen::VectorXd solve(LinearSolver& solver, const Eigen::VectorXd& b, double tolerance = 0) const {
        std::vector<double> r(csr.equation.size(), 0.0), d(csr.equation.size(), 0.0);
        for (int i = 0; i < csr.n; ++i) r[unknown(i)] = -b[i];
        if (!solver.solve(r.data(), {}, d.data(), tolerance)) return Eigen::VectorXd::Constant(csr.n, NAN);
        Eigen::VectorXd x(csr.n);
        for (int i = 0; i < csr.n; ++i) x[i] = d[unknown(i)];
        return x;
    }
    /// Analysis, factorisation and solution; not a number: one of them failed.
    Eigen::VectorXd solution(LinearSolver& solver, const Eigen::VectorXd& b) const {
        solver.analyze(csr, blocks);
        if (!factor(solver)) return Eigen::VectorXd::Constant(csr.n, NAN);
        return solve(solver, b);
    }
};

inline bool solved(const Eigen::VectorXd& x) { return x.allFinite(); }

/// Sparse, far from singular and not symmetric.
inline Eigen::MatrixXd arbitrary_matrix(Numbers& numbers, int n, int per_row = 4) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
        a(i, i) = per_row + 1 + numbers.one();
        for (int k = 0; k < per_row; ++k) {
            const int j = numbers.below(n);
            if (j != i) a(i, j) = numbers.one();
        }
    }
    return a;
}

/// Springs of a chain, the first held to the ground or none.
inline Eigen::MatrixXd chain(int n, bool held) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i + 1 < n; ++i) {
        a(i, i) += 1, a(i + 1, i + 1) += 1;
        a(i, i + 1) -= 1, a(i + 1, i) -= 1;
    }
    if (held) a(0, 0) += 1;
    return a;
}

/// Matrices along the diagonal.
inline Eigen::MatrixXd side_by_side(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(a.rows() + b.rows(), a.cols() + b.cols());
    c.topLeftCorner(a.rows(), a.cols()) = a;
    c.bottomRightCorner(b.rows(), b.cols()) = b;
    return c;
}

}  // namespace visviva
