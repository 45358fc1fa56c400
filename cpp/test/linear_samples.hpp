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

/// Two chains, of which one floats, the first or the second. Whole numbers leave a pivot of zero, others one
/// of rounding.
struct Floating {
    Eigen::MatrixXd a;
    int begin, end;  // unknowns of the one that floats

    Floating(bool exact, bool second)
        : a(second ? side_by_side(chain(7, true), chain(5, false))
                   : side_by_side(chain(5, false), chain(7, true))),
          begin(second ? Problem::unknown(7) : 0),
          end(second ? Problem::unknown(12) : Problem::unknown(5)) {
        const Eigen::VectorXd units = Eigen::VectorXd::LinSpaced(12, 1.3, 4.7);
        if (!exact) a = units.asDiagonal() * a * units.asDiagonal();
    }
    bool has(int unknown) const { return unknown >= begin && unknown < end; }
};

}  // namespace visviva
