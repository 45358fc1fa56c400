// Sparse factorisations against dense ones: solutions, and what is singular and where.
#include <doctest/doctest.h>

#include <cmath>

#include "linear_samples.hpp"

using namespace visviva;
using Eigen::MatrixXd, Eigen::VectorXd;

// oneMKL keeps what it has allocated until the process ends.
extern "C" const char* __lsan_default_suppressions() { return "leak:libmkl"; }

namespace {

// Units that differ from equation to equation.
MatrixXd in_other_units(Numbers& numbers, const MatrixXd& a, double decades) {
    const VectorXd units =
        VectorXd::NullaryExpr(a.rows(), [&] { return std::pow(10.0, decades * numbers.one()); });
    return units.asDiagonal() * a * units.asDiagonal();
}

MatrixXd saddle(Numbers& numbers, int n, int m) {
    MatrixXd a = side_by_side(definite(numbers, n), MatrixXd::Zero(m, m));
    for (int i = 0; i < m; ++i)
        a(n + i, 2 * i) = a(2 * i, n + i) = 1, a(n + i, 2 * i + 1) = a(2 * i + 1, n + i) = 0.5;
    return a;
}

bool has_pardiso() { return missing_pardiso(TEST_MKL).empty(); }

// Relative to the solution in units in which the diagonal is one.
double error(LinearSolver& solver, const MatrixXd& a, const VectorXd& b) {
    return difference(a * Problem(a).solution(solver, b), b);
}

void check_singular(LinearSolver& solver, const std::vector<const char*>& messages = {}) {
    for (bool exact : {true, false})
        for (unsigned seed = 1; seed <= 8; ++seed) {
            const Floating two(exact, seed);
            const Problem problem(two.a);
            solver.analyze(problem.csr, problem.blocks);
            CHECK_FALSE(problem.factor(solver));
            CHECK(two.has(solver.report().singular_unknown));
            if (!messages.empty()) CHECK(solver.report().message == messages[exact ? 0 : 1]);
        }
}

}  // namespace

TEST_CASE("sparse LU: solutions are those of the dense matrix, in whatever units") {
    Numbers numbers(11);
    for (int n : {1, 5, 40}) {
        const MatrixXd a = arbitrary_matrix(numbers, n, std::min(4, n - 1));
        const VectorXd b = numbers.vector(n);
        const auto solver = make_sparse_lu(true);
        const VectorXd x = Problem(a).solution(*solver, b);
        CHECK(difference(x, a.fullPivLu().solve(b)) < 1e-13);
    }
    const MatrixXd a = in_other_units(numbers, arbitrary_matrix(numbers, 40), 6);
    CHECK(error(*make_sparse_lu(true), a, a * numbers.vector(40)) < 1e-12);
}

TEST_CASE("sparse LU: saddle points, and values anew on the same pattern") {
    Numbers numbers(12);
    const MatrixXd a = saddle(numbers, 12, 4);
    Problem problem(a);
    problem.blocks.algebraic.assign(16, 0);
    std::fill(problem.blocks.algebraic.begin() + 12, problem.blocks.algebraic.end(), 1);
    const auto solver = make_sparse_lu(true);
    const VectorXd b = numbers.vector(16);
    CHECK(difference(problem.solution(*solver, b), a.fullPivLu().solve(b)) < 1e-12);
    problem.take(-3 * a);
    REQUIRE(problem.factor(*solver));
    CHECK(difference(-3 * problem.solve(*solver, b), a.fullPivLu().solve(b)) < 1e-12);
}

TEST_CASE("sparse LU: redundant constraints are regularised, or named") {
    Numbers numbers(13);
    MatrixXd a = side_by_side(definite(numbers, 6), MatrixXd::Zero(2, 2));
    for (int i : {6, 7}) a(0, i) = a(i, 0) = a(1, i) = a(i, 1) = 1;
    Problem problem(a);
    problem.blocks.multiplier = problem.by_unknown<char>({0, 0, 0, 0, 0, 0, 1, 1}, 0);
    const auto solver = make_sparse_lu(true);
    solver->analyze(problem.csr, problem.blocks);
    CHECK_FALSE(problem.factor(*solver));
    CHECK(solver->report().singular_unknown >= Problem::unknown(6));
    solver->regularization = 1e-10;
    REQUIRE(problem.factor(*solver));
    VectorXd b = numbers.vector(8);
    b[7] = b[6];  // both constraints say the same
    const VectorXd x = problem.solve(*solver, b);
    const MatrixXd once = a.topLeftCorner(7, 7);
    CHECK(difference(x.head(6), once.fullPivLu().solve(b.head(7)).head(6)) < 1e-8);
    CHECK(x[6] == doctest::Approx(x[7]).epsilon(1e-5));
}

TEST_CASE("sparse LU and Cholesky: a part that nothing holds is named") {
    check_singular(*make_sparse_lu(true));
    check_singular(*make_cholesky(choice(Backend::cholesky)),
                   {"the tangent has a zero pivot", "the tangent is singular"});
}

TEST_CASE("Cholesky: definite matrices, and why others are refused") {
    Numbers numbers(14);
    for (int n : {1, 6, 50}) {
        const MatrixXd a = in_other_units(numbers, definite(numbers, n), 5);
        CHECK(error(*make_cholesky(choice(Backend::cholesky)), a, a * numbers.vector(n)) < 1e-11);
    }
    MatrixXd a = definite(numbers, 9);
    const auto solver = make_cholesky(choice(Backend::cholesky));
    a(4, 4) = -1;
    CHECK_FALSE(solved(Problem(a).solution(*solver, numbers.vector(9))));
    CHECK(solver->report().message == "the tangent is not positive definite");
    a = definite(numbers, 9);
    a(3, 4) += 0.1, a(4, 3) -= 0.1;
    CHECK_FALSE(solved(Problem(a).solution(*solver, numbers.vector(9))));
    CHECK(solver->report().message.find("not symmetric") != std::string::npos);
    a = definite(numbers, 9), a(2, 2) = NAN;
    CHECK_FALSE(solved(Problem(a).solution(*solver, numbers.vector(9))));
    CHECK(solver->report().message.find("not finite") != std::string::npos);
}

TEST_CASE("Cholesky: factors beyond the limit of memory are refused before they are made") {
    // An arrow factors without fill: as many entries as its lower triangle, of 24 bytes each.
    const int n = 30;
    MatrixXd a = 10.0 * n * MatrixXd::Identity(n, n);
    a.row(0).setOnes(), a.col(0).setOnes(), a(0, 0) = 10.0 * n;
    const Problem problem(a);
    LinearChoice c = choice(Backend::cholesky);
    c.memory_limit = 24 * (2 * n - 1);
    const auto solver = make_cholesky(c);
    CHECK_NOTHROW(solver->analyze(problem.csr, problem.blocks));
    CHECK(solver->report().memory == c.memory_limit);
    c.memory_limit -= 1;
    CHECK_THROWS_AS(make_cholesky(c)->analyze(problem.csr, problem.blocks), MemoryShortage);
}

TEST_CASE("PARDISO: every kind of matrix, eigenvalues' signs, and what is singular") {
    if (!has_pardiso()) {
        MESSAGE("no oneMKL here: not tested");
        return;
    }
    Numbers numbers(15);
    const VectorXd b = numbers.vector(40);
    CHECK(error(*make_pardiso(choice(Backend::pardiso)), arbitrary_matrix(numbers, 40), b) < 1e-12);
    const auto cholesky = make_pardiso(choice(Backend::pardiso, MatrixKind::definite));
    CHECK(error(*cholesky, definite(numbers, 40), b) < 1e-12);
    const MatrixXd a = saddle(numbers, 30, 10);
    const auto symmetric = make_pardiso(choice(Backend::pardiso, MatrixKind::symmetric));
    CHECK(error(*symmetric, a, b) < 1e-12);
    const auto eigenvalues = Eigen::SelfAdjointEigenSolver<MatrixXd>(a).eigenvalues();
    CHECK(symmetric->report().n_negative == (eigenvalues.array() < 0).count());
    CHECK(symmetric->report().n_negative == 10);
    for (MatrixKind kind : {MatrixKind::definite, MatrixKind::symmetric, MatrixKind::general})
        check_singular(*make_pardiso(choice(Backend::pardiso, kind)));
    MatrixXd indefinite = definite(numbers, 9);
    indefinite(4, 4) = -1;
    CHECK_FALSE(solved(Problem(indefinite).solution(*cholesky, numbers.vector(9))));
    CHECK(cholesky->report().message == "the tangent is not positive definite");
}

TEST_CASE("PARDISO: values that turn the pivots of the first ones to zero") {
    if (!has_pardiso()) return;
    Numbers numbers(16);
    const MatrixXd mask = (arbitrary_matrix(numbers, 30).array() != 0).cast<double>();
    Problem problem(mask);
    const auto solver = make_pardiso(choice(Backend::pardiso));
    MatrixXd a = mask.cwiseProduct(numbers.matrix(30, 30));
    a.diagonal().setConstant(5);
    solver->analyze(problem.csr, problem.blocks);
    problem.take(a);
    REQUIRE(problem.factor(*solver));
    for (int k = 0; k < 10; ++k) {  // regular though the diagonal vanishes at places
        MatrixXd other = mask.cwiseProduct(numbers.matrix(30, 30));
        for (int i = 0; i < 30; i += 3) other(i, i) = 0;
        if (std::abs(other.fullPivLu().determinant()) < 1e-8) continue;
        problem.take(other);
        REQUIRE(problem.factor(*solver));
        const VectorXd b = numbers.vector(30);
        CHECK(difference(other * problem.solve(*solver, b), b) < 1e-8);
    }
}
