// Krylov's methods and their preconditioners against dense solutions, and what these are known to do exactly.
#include <doctest/doctest.h>

#include "dense.hpp"
#include "visviva/linear/krylov/aggregation.hpp"
#include "visviva/linear/krylov/incomplete.hpp"
#include "visviva/linear/krylov/precondition.hpp"
#include "visviva/linear/linear_choice.hpp"

using namespace visviva;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

// Springs between the nodes of a grid with `dofs` unknowns each, coupled among each other, held a little;
// `wind` makes it unsymmetric.
MatrixXd grid(Numbers& numbers, int nx, int ny, int dofs, double wind) {
    const int n = nx * ny;
    MatrixXd a = 0.05 * MatrixXd::Identity(n * dofs, n * dofs);
    const auto spring = [&](int i, int j) {
        const MatrixXd r = numbers.matrix(dofs, dofs);
        const MatrixXd k = MatrixXd::Identity(dofs, dofs) + 0.5 * r * r.transpose();
        const int at[2] = {i * dofs, j * dofs};
        for (int p = 0; p < 2; ++p)
            for (int q = 0; q < 2; ++q) a.block(at[p], at[q], dofs, dofs) += (p == q ? 1 : -1) * k;
        for (int c = 0; c < dofs; ++c) a(at[0] + c, at[1] + c) += wind, a(at[1] + c, at[0] + c) -= wind;
    };
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) {
            if (x + 1 < nx) spring(y * nx + x, y * nx + x + 1);
            if (y + 1 < ny) spring(y * nx + x, (y + 1) * nx + x);
        }
    return a;
}

Problem by_nodes(const MatrixXd& a, int dofs) {
    Problem problem(a);
    for (int i = 0; i <= a.rows(); i += dofs) problem.blocks.node.push_back(i);
    return problem;
}

LinearChoice choice(KrylovMethod method, Preconditioner preconditioner, double tolerance = 1e-11) {
    LinearChoice c;
    c.backend = Backend::krylov, c.method = method, c.preconditioner = preconditioner;
    c.tolerance = tolerance;
    return c;
}

// Three neighbours along a line of block rows are one aggregate, which moves as one.
Aggregates thirds(int n, int dofs) {
    Aggregates a;
    a.n = (n + 2) / 3, a.cols = dofs;
    for (int i = 0; i < n; ++i) {
        a.of.push_back(i / 3);
        for (int r = 0; r < dofs; ++r)
            for (int c = 0; c < dofs; ++c) a.block.push_back(r == c ? 1 : 0);
    }
    return a;
}

std::vector<Aggregates> down_to_few(const BlockRows<double>& a, const double*, int) {
    std::vector<Aggregates> levels;
    for (int n = a.n(); n > 12; n = (n + 2) / 3) levels.push_back(thirds(n, a.rows));
    return levels;
}

MatrixXd dense(const BlockRows<double>& a, int n_cols) {
    MatrixXd m = MatrixXd::Zero(static_cast<Eigen::Index>(a.size()), n_cols * a.cols);
    for (int i = 0; i < a.n(); ++i)
        for (auto k = a.row[i]; k < a.row[i + 1]; ++k)
            m.block(i * a.rows, a.col[k] * a.cols, a.rows, a.cols) =
                Eigen::Map<const MatrixXd>(a.block(k), a.rows, a.cols);
    return m;
}

NodeMatrix node_matrix(const Problem& problem, int borrow_from = NodeMatrix::never, bool single = false) {
    NodeMatrix matrix(single, false, borrow_from);
    matrix.analyze(problem.csr, problem.blocks);
    REQUIRE(matrix.fill(problem.values.data()));
    return matrix;
}

}  // namespace

TEST_CASE("Krylov: every method with every preconditioner for plain matrices arrives at the solution") {
    Numbers numbers(51);
    for (int dofs : {1, 2, 3, 5})
        for (double wind : {0.0, 0.4}) {
            const MatrixXd a = grid(numbers, 6, 5, dofs, wind);
            const VectorXd b = numbers.vector(a.rows()), x = a.fullPivLu().solve(b);
            const Problem problem = by_nodes(a, dofs);
            for (KrylovMethod method : {KrylovMethod::cg, KrylovMethod::gmres, KrylovMethod::bicgstab})
                for (Preconditioner preconditioner : {Preconditioner::none, Preconditioner::diagonal,
                                                      Preconditioner::block, Preconditioner::incomplete}) {
                    // incomplete factors are in single precision, and so hardly symmetric
                    const bool symmetric = wind == 0 && preconditioner != Preconditioner::incomplete;
                    if (method == KrylovMethod::cg && !symmetric) continue;
                    const auto solver = make_krylov(choice(method, preconditioner));
                    CAPTURE(solver->report().name);
                    const VectorXd got = problem.solution(*solver, b);
                    CHECK_MESSAGE(solved(got), solver->report().message);
                    if (solved(got)) CHECK(difference(a * got, b) < 1e-11);
                    if (solved(got)) CHECK(difference(got, x) < 1e-8);
                    CHECK(solver->report().n_iterations > 0);
                }
        }
}

TEST_CASE("Krylov: as many iterations as there are different eigenvalues") {
    Numbers numbers(52);
    const MatrixXd q = Eigen::HouseholderQR<MatrixXd>(numbers.matrix(20, 20)).householderQ();
    VectorXd eigenvalues(20);
    for (int i = 0; i < 20; ++i) eigenvalues[i] = 1 + 2 * (i % 4);
    const MatrixXd a = q * eigenvalues.asDiagonal() * q.transpose();
    const VectorXd b = numbers.vector(20);
    for (KrylovMethod method : {KrylovMethod::cg, KrylovMethod::gmres}) {
        const auto solver = make_krylov(choice(method, Preconditioner::none, 1e-9));
        const VectorXd x = Problem(a).solution(*solver, b);
        REQUIRE(solved(x));
        CHECK(difference(a * x, b) < 1e-9);
        CHECK(solver->report().n_iterations == 4);
    }
}

TEST_CASE("Krylov: restarts go on where the last cycle ended; what does not arrive says so") {
    Numbers numbers(53);
    const MatrixXd a = grid(numbers, 8, 6, 1, 0.2);
    const VectorXd b = numbers.vector(a.rows());
    LinearChoice c = choice(KrylovMethod::gmres, Preconditioner::diagonal, 1e-9);
    c.restart = 7;
    auto solver = make_krylov(c);
    const VectorXd x = Problem(a).solution(*solver, b);
    REQUIRE(solved(x));
    CHECK(difference(a * x, b) < 1e-9);
    CHECK(solver->report().n_iterations > 2 * c.restart);
    c.max_iterations = 9;
    solver = make_krylov(c);
    CHECK_FALSE(solved(Problem(a).solution(*solver, b)));
    CHECK(solver->report().message.find("no convergence after 9 iterations") != std::string::npos);
}

TEST_CASE("Krylov: the tolerance of one solution holds for that alone") {
    Numbers numbers(54);
    const MatrixXd a = grid(numbers, 8, 6, 2, 0);
    const VectorXd b = numbers.vector(a.rows());
    const Problem problem = by_nodes(a, 2);
    const auto solver = make_krylov(choice(KrylovMethod::cg, Preconditioner::block));
    solver->analyze(problem.csr, problem.blocks);
    REQUIRE(problem.factor(*solver));
    const double rough = difference(a * problem.solve(*solver, b, 1e-3), b);
    CHECK(rough < 1e-3);
    CHECK(rough > 1e-8);
    CHECK(difference(a * problem.solve(*solver, b), b) < 1e-11);
}

TEST_CASE("Krylov: matrices and right-hand sides that a method cannot take are refused") {
    Numbers numbers(55);
    MatrixXd a = grid(numbers, 4, 3, 1, 0);
    const VectorXd b = numbers.vector(12);
    const auto solver = make_krylov(choice(KrylovMethod::cg, Preconditioner::none));
    CHECK_FALSE(solved(Problem(-a).solution(*solver, b)));
    CHECK(solver->report().message.find("the tangent is not positive definite") != std::string::npos);
    VectorXd bad = b;
    bad[4] = NAN;
    CHECK_FALSE(solved(Problem(a).solution(*solver, bad)));
    CHECK(solver->report().message == "the right-hand side is not finite");
    a(3, 3) = INFINITY;
    CHECK_FALSE(solved(Problem(a).solution(*solver, b)));
    CHECK(solver->report().message == "the tangent holds values that are not finite");
    CHECK(Problem(MatrixXd::Identity(3, 3)).solution(*solver, VectorXd::Zero(3)).norm() == 0);
}

TEST_CASE("saddle points: with exact constraints they are kept by every iterate") {
    Numbers numbers(56);
    const int n = 60, m = 5;
    MatrixXd a = side_by_side(grid(numbers, 6, 5, 2, 0), MatrixXd::Zero(m, m));
    for (int k = 0; k < m; ++k)
        for (int j = 0; j < 4; ++j) a(n + k, 11 * k + 3 * j) = a(11 * k + 3 * j, n + k) = numbers.one();
    Problem problem(a);
    for (int i = 0; i < n; i += 2) problem.blocks.node.push_back(i);
    for (int k = 0; k <= m; ++k) problem.blocks.node.push_back(n + k);
    problem.blocks.algebraic.assign(n + m, 0);
    std::fill_n(problem.blocks.algebraic.begin() + n, m, 1);
    const VectorXd b = numbers.vector(n + m);
    const auto exact = a.fullPivLu();
    const auto solver = make_krylov(choice(KrylovMethod::gmres, Preconditioner::saddle, 1e-10));
    const VectorXd x = problem.solution(*solver, b);
    REQUIRE(solved(x));
    CHECK(difference(x, exact.solve(b)) < 1e-7);
    const VectorXd rough = problem.solve(*solver, b, 1e-2);
    REQUIRE(solved(rough));
    CHECK(difference(a * rough, b) > 1e-9);
    CHECK((a * rough - b).tail(m).norm() < 1e-12);

    LinearChoice c = choice(KrylovMethod::gmres, Preconditioner::augmented, 1e-10);
    c.aggregator = down_to_few;
    const auto augmented = make_krylov(c);
    const VectorXd y = problem.solution(*augmented, b);
    CHECK_MESSAGE(solved(y), augmented->report().message);
    if (solved(y)) CHECK(difference(y, exact.solve(b)) < 1e-7);
}

TEST_CASE("incomplete factors: exact where nothing is dropped") {
    Numbers numbers(57);
    for (int dofs : {1, 2, 3, 4, 6}) {
        const MatrixXd a = grid(numbers, 9, 1, dofs, 0.3);  // tridiagonal by blocks
        const NodeMatrix matrix = node_matrix(by_nodes(a, dofs));
        REQUIRE(matrix.blocks().rows == dofs);
        IncompleteFactors factors;
        REQUIRE(factors.build(matrix.blocks()));
        const VectorXd b = numbers.vector(a.rows());
        VectorXd x(a.rows());
        factors.apply(b.data(), x.data());
        CHECK(difference(x, a.fullPivLu().solve(b)) < 1e-5);  // kept in single precision
    }
    const NodeMatrix singular = node_matrix(Problem(chain(5, false)));
    IncompleteFactors factors;
    CHECK_FALSE(factors.build(singular.blocks()));
}

TEST_CASE("blocks: products, and inverses of what is on the diagonal") {
    Numbers numbers(58);
    for (int dofs : {1, 2, 3, 4, 5, 6}) {
        const MatrixXd a = grid(numbers, 5, 4, dofs, 0.3);
        const NodeMatrix matrix = node_matrix(by_nodes(a, dofs));
        REQUIRE(matrix.blocks().rows == dofs);
        const VectorXd x = numbers.vector(a.rows());
        VectorXd y(a.rows());
        matrix.multiply(x.data(), y.data());
        CHECK(difference(y, a * x) < 1e-14);
        CHECK(dense(matrix.blocks(), 20) == a);
        for (bool alone : {true, false}) {
            const MatrixXd inverse = dense(inverse_diagonal<double>(matrix.blocks(), alone), 20);
            for (int i = 0; i < 20; ++i) {
                MatrixXd block = a.block(dofs * i, dofs * i, dofs, dofs);
                if (alone) block = MatrixXd(block.diagonal().asDiagonal());
                CHECK(difference(inverse.block(dofs * i, dofs * i, dofs, dofs), block.inverse()) < 1e-12);
            }
        }
    }
}

TEST_CASE("blocks: nodes that differ in size are filled up with equations of nothing") {
    Numbers numbers(59);
    const MatrixXd a = grid(numbers, 4, 1, 3, 0);
    Problem problem(a.topLeftCorner(11, 11));  // the last node has two unknowns
    problem.blocks.node = {0, 3, 6, 9, 11};
    const NodeMatrix matrix = node_matrix(problem);
    REQUIRE(matrix.size() == 12);
    MatrixXd whole = MatrixXd::Zero(12, 12);
    whole.topLeftCorner(11, 11) = a.topLeftCorner(11, 11), whole(11, 11) = 1;
    CHECK(dense(matrix.blocks(), 4) == whole);
}

TEST_CASE("blocks: values that are borrowed make the same rows and products") {
    Numbers numbers(62);
    const MatrixXd a = grid(numbers, 5, 3, 3, 0.2);
    Problem by_size(a.topLeftCorner(44, 44));  // the last node has two unknowns
    for (int i = 0; i < 44; i += 3) by_size.blocks.node.push_back(i);
    by_size.blocks.node.push_back(44);
    Problem by_place(a);  // every third equation stands elsewhere
    for (int i = 0; i < 45; ++i) by_place.blocks.place.push_back((i % 15) * 3 + i / 15);
    for (const Problem& problem : {by_nodes(a, 3), by_size, by_place}) {
        for (bool single : {false, true}) {
            const NodeMatrix own = node_matrix(problem, NodeMatrix::never, single),
                             borrowed = node_matrix(problem, problem.csr.n, single);
            REQUIRE((borrowed.borrows() && borrowed.blocks().value.empty() && !own.borrows()));
            std::vector<double> room;
            for (int b = 0; b < own.blocks().n(); ++b) {
                const double *row = own.blocks().block(own.blocks().row[b]),
                             *made = borrowed.reader().row(b, room);
                CHECK(std::equal(row, row + borrowed.reader().size_of_row(b), made));
            }
            const VectorXd x = numbers.vector(static_cast<int>(own.size()));
            VectorXd y(own.size()), z(own.size());
            own.multiply_double(x.data(), y.data()), borrowed.multiply_double(x.data(), z.data());
            CHECK(difference(z, y) < 1e-14);
            own.multiply(x.data(), y.data()), borrowed.multiply(x.data(), z.data());
            CHECK(difference(z, y) < 1e-14);
        }
    }
    Problem mixed = by_nodes(a, 3);
    mixed.blocks.algebraic.assign(45, 0), mixed.blocks.algebraic[7] = 1;
    CHECK_FALSE(node_matrix(mixed, 0).borrows());
}

TEST_CASE("blocks: nodes of several fields at one place are one, wherever their equations are") {
    Numbers numbers(61);
    const int n = 4;  // places, each of three unknowns and of one more, n rows behind
    const MatrixXd a = grid(numbers, n, 1, 4, 0);
    std::vector<int> by_field;  // equations of `a` in the order of the problem
    for (int k = 0; k < n; ++k)
        for (int c = 0; c < 3; ++c) by_field.push_back(4 * k + c);
    for (int k = 0; k < n; ++k) by_field.push_back(4 * k + 3);
    MatrixXd mixed(4 * n, 4 * n);
    for (int i = 0; i < 4 * n; ++i)
        for (int j = 0; j < 4 * n; ++j) mixed(i, j) = a(by_field[i], by_field[j]);
    Problem problem(mixed);
    for (int k = 0; k < n; ++k) problem.blocks.node.push_back(3 * k);
    for (int k = 0; k <= n; ++k) problem.blocks.node.push_back(3 * n + k);
    for (int i : by_field) problem.blocks.place.push_back(i / 4);
    CHECK(dense(node_matrix(problem).blocks(), n) == a);
}

TEST_CASE("aggregation: smoothed prolongation and the coarser matrix are the products they stand for") {
    Numbers numbers(60);
    const int dofs = 2, n = 12;
    const MatrixXd a = grid(numbers, 4, 3, dofs, 0);
    const NodeMatrix matrix = node_matrix(by_nodes(a, dofs));
    Aggregates tentative = thirds(n, dofs);
    for (float& v : tentative.block) v = static_cast<float>(numbers.one());
    tentative.of[4] = -1;  // of none
    MatrixXd T = MatrixXd::Zero(n * dofs, tentative.n * dofs);
    for (int i = 0; i < n; ++i)
        for (int r = 0; r < dofs; ++r)
            for (int c = 0; c < dofs && tentative.of[i] >= 0; ++c)
                T(i * dofs + r, tentative.of[i] * dofs + c) = tentative.block[(i * dofs + r) * dofs + c];
    const auto inverse = inverse_diagonal<float>(matrix.blocks(), false);
    const Prolongation p = smoothed(matrix.blocks(), inverse, 0.6, tentative);
    MatrixXd P = MatrixXd::Zero(n * dofs, tentative.n * dofs);
    for (int i = 0; i < p.n(); ++i)
        for (auto k = p.row[i]; k < p.row[i + 1]; ++k)
            for (int r = 0; r < dofs; ++r)
                for (int c = 0; c < dofs; ++c) P(i * dofs + r, p.col[k] * dofs + c) = p.at(k)[r * dofs + c];
    MatrixXd D = MatrixXd::Zero(n * dofs, n * dofs);
    for (int i = 0; i < n * dofs; i += dofs) D.block(i, i, dofs, dofs) = a.block(i, i, dofs, dofs).inverse();
    CHECK(difference(P, T - 0.6 * D * a * T) < 1e-6);  // D is in single precision
    CHECK(difference(dense(coarse_matrix(matrix.blocks(), p), tentative.n), P.transpose() * a * P) < 1e-13);
    const Problem problem = by_nodes(a, dofs);
    const NodeMatrix borrowed = node_matrix(problem, 0);
    CHECK(coarse_matrix(borrowed.reader(), p).value == coarse_matrix(matrix.blocks(), p).value);
    CHECK(smoothed(borrowed.reader(), inverse, 0.6, tentative).block == p.block);
}

TEST_CASE("multigrid: converges to the dense solution, in iterations that hardly grow with the mesh") {
    Numbers numbers(61);
    for (int dofs : {1, 2}) {
        std::vector<int> iterations;
        for (int n : {40, 160, 480}) {
            const MatrixXd a = grid(numbers, n, 1, dofs, 0) - 0.0499 * MatrixXd::Identity(n * dofs, n * dofs);
            const VectorXd b = numbers.vector(a.rows());
            LinearChoice c = choice(KrylovMethod::cg, Preconditioner::multigrid, 1e-9);
            c.aggregator = down_to_few;
            const auto solver = make_krylov(c);
            const VectorXd x = by_nodes(a, dofs).solution(*solver, b);
            CHECK_MESSAGE(solved(x), solver->report().message);
            if (solved(x)) CHECK(difference(x, a.llt().solve(b)) < 1e-5);
            iterations.push_back(solver->report().n_iterations);
            const auto plain = make_krylov(choice(KrylovMethod::cg, Preconditioner::block, 1e-9));
            by_nodes(a, dofs).solution(*plain, b);
            CHECK(plain->report().n_iterations > n / 2);
        }
        CAPTURE(iterations[0]);
        CAPTURE(iterations[2]);
        CHECK(iterations[2] <= 2 * iterations[0]);
    }
}

TEST_CASE("multigrid: what nothing holds is refused, as is a choice without aggregates") {
    const MatrixXd a = chain(40, false);
    LinearChoice c = choice(KrylovMethod::cg, Preconditioner::multigrid);
    auto solver = make_krylov(c);
    CHECK_FALSE(solved(Problem(a).solution(*solver, VectorXd::Ones(40))));
    CHECK(solver->report().message.find("PyAMG") != std::string::npos);
    c.aggregator = down_to_few;
    solver = make_krylov(c);
    CHECK_FALSE(solved(Problem(a).solution(*solver, VectorXd::Ones(40))));
    CHECK(solver->report().message.find("the tangent is singular") != std::string::npos);
}
