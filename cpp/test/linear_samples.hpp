// Matrices and choices that tests of linear solvers share.
#pragma once
#include "dense.hpp"
#include "visviva/linear/linear_choice.hpp"

namespace visviva {

inline Eigen::MatrixXd definite(Numbers& numbers, int n) {
    const Eigen::MatrixXd a = arbitrary_matrix(numbers, n, 2);
    return a * a.transpose();
}

inline LinearChoice choice(Backend backend, MatrixKind kind = MatrixKind::general) {
    LinearChoice c;
    c.backend = backend, c.kind = kind, c.library = TEST_MKL;
    return c;
}

/// Two chains, of which the second floats, in an arbitrary order. Whole numbers leave a pivot of zero, others
/// one of rounding.
struct Floating {
    static constexpr int n = 12, first = 7;
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order{n};
    Eigen::MatrixXd a = side_by_side(chain(first, true), chain(n - first, false));

    Floating(bool exact, unsigned seed) {
        Numbers numbers(seed);
        order.setIdentity();
        for (int k = n - 1; k > 0; --k) std::swap(order.indices()[k], order.indices()[numbers.below(k + 1)]);
        const Eigen::VectorXd units = Eigen::VectorXd::LinSpaced(n, 1.3, 4.7);
        if (!exact) a = units.asDiagonal() * a * units.asDiagonal();
        a = (order * a * order.transpose()).eval();
    }
    bool has(int unknown) const {
        for (int k = first; k < n; ++k)
            if (unknown == Problem::unknown(order.indices()[k])) return true;
        return false;
    }
};

}  // namespace visviva
