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

/// Two chains, of which the second floats: unknowns from `first` on. Whole numbers leave a pivot of zero,
/// others one of rounding.
struct Floating {
    Eigen::MatrixXd a = side_by_side(chain(7, true), chain(5, false));
    int first = Problem::unknown(7);

    explicit Floating(bool exact) {
        const Eigen::VectorXd units = Eigen::VectorXd::LinSpaced(12, 1.3, 4.7);
        if (!exact) a = units.asDiagonal() * a * units.asDiagonal();
    }
};

}  // namespace visviva
