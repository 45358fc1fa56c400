// How unsymmetric matrices are, against closed forms.
#include <doctest/doctest.h>

#include <cmath>

#include "linear_samples.hpp"
#include "visviva/linear/asymmetry.hpp"

using namespace visviva;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

Asymmetry of(const MatrixXd& a) {
    std::vector<std::int64_t> row{0};
    std::vector<int> col;
    std::vector<double> value;
    for (int i = 0; i < a.rows(); ++i) {
        for (int j = 0; j < a.cols(); ++j)
            if (a(i, j) != 0) col.push_back(j), value.push_back(a(i, j));
        row.push_back(static_cast<std::int64_t>(col.size()));
    }
    return asymmetry(row, col, value);
}

}  // namespace

TEST_CASE("asymmetry is relative to the diagonal, whatever the units") {
    MatrixXd a(3, 3);
    a << 4, 0.6, 0, 0, 9, 1, 0, 1, 1;
    const Asymmetry found = of(a);
    CHECK(found.size == doctest::Approx(0.6 / std::sqrt(4.0 * 9)).epsilon(1e-15));
    CHECK(found.row == 0);
    const VectorXd units = (VectorXd(3) << 1e-9, 1e5, 3).finished();
    CHECK(of(units.asDiagonal() * a * units.asDiagonal()).size == doctest::Approx(found.size).epsilon(1e-14));
}

TEST_CASE("rows without a diagonal are measured by their largest entry") {
    MatrixXd a(2, 2);
    a << 1, 5, 4, 0;  // a constraint: first 1 / 4, which leaves 5 / 4 in the other row; four rounds of roots
    CHECK(of(a).size == doctest::Approx(0.25 * std::pow(1.25, -15.0 / 16)).epsilon(1e-14));
}

TEST_CASE("symmetric matrices have none, nor have empty ones, nor what cancels below any inverse") {
    Numbers numbers(3);
    CHECK(of(definite(numbers, 8)).size < 1e-15);
    CHECK(of(MatrixXd::Zero(0, 0)).row == -1);
    MatrixXd a = MatrixXd::Identity(2, 2);
    a(1, 1) = 1e-170;
    CHECK(of(a).size == 0);
}
