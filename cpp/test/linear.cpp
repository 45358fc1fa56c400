// Factorisations and their cascade against dense ones: solutions, what is singular and where, who takes over.
#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "dense.hpp"
#include "visviva/linear/block_lu.hpp"
#include "visviva/linear/linear_choice.hpp"

using namespace visviva;
using Eigen::MatrixXd, Eigen::VectorXd;

// oneMKL keeps what it has allocated until the process ends.
extern "C" const char* __lsan_default_suppressions() { return "leak:libmkl"; }

namespace {

MatrixXd definite(Numbers& numbers, int n) {
    const MatrixXd a = arbitrary_matrix(numbers, n, 2);
    return a * a.transpose();
}

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

LinearChoice choice(Backend backend, MatrixKind kind = MatrixKind::general) {
    LinearChoice c;
    c.backend = backend, c.kind = kind, c.library = TEST_MKL;
    return c;
}

bool has_pardiso() { return missing_pardiso(TEST_MKL).empty(); }

// Relative to the solution in units in which the diagonal is one.
double error(LinearSolver& solver, const MatrixXd& a, const VectorXd& b) {
    const VectorXd x = Problem(a).solution(solver, b);
    if (x.size() == 0) return INFINITY;
    return difference(a * x, b);
}

// Two chains, of which the second floats: unknowns from `first` on. Whole numbers leave a pivot of zero,
// others one of rounding.
struct Floating {
    MatrixXd a = side_by_side(chain(7, true), chain(5, false));
    int first = Problem::unknown(7);

    explicit Floating(bool exact) {
        const VectorXd units = VectorXd::LinSpaced(12, 1.3, 4.7);
        if (!exact) a = units.asDiagonal() * a * units.asDiagonal();
    }
};

void check_singular(LinearSolver& solver, const std::vector<const char*>& messages = {}) {
    for (bool exact : {true, false}) {
        const Floating two(exact);
        const Problem problem(two.a);
        solver.analyze(problem.csr, problem.blocks);
        CHECK_FALSE(problem.factor(solver));
        CHECK(solver.singular_unknown() >= two.first);
        if (!messages.empty()) CHECK(solver.message() == messages[exact ? 0 : 1]);
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
    CHECK(solver->singular_unknown() >= Problem::unknown(6));
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
    CHECK(Problem(a).solution(*solver, numbers.vector(9)).size() == 0);
    CHECK(solver->message() == "the tangent is not positive definite");
    a = definite(numbers, 9);
    a(3, 4) += 0.1, a(4, 3) -= 0.1;
    CHECK(Problem(a).solution(*solver, numbers.vector(9)).size() == 0);
    CHECK(solver->message().find("not symmetric") != std::string::npos);
    a = definite(numbers, 9), a(2, 2) = NAN;
    CHECK(Problem(a).solution(*solver, numbers.vector(9)).size() == 0);
    CHECK(solver->message().find("not finite") != std::string::npos);
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
    CHECK(solver->memory() == c.memory_limit);
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
    CHECK(symmetric->n_negative() == (eigenvalues.array() < 0).count());
    CHECK(symmetric->n_negative() == 10);
    for (MatrixKind kind : {MatrixKind::definite, MatrixKind::symmetric, MatrixKind::general})
        check_singular(*make_pardiso(choice(Backend::pardiso, kind)));
    MatrixXd indefinite = definite(numbers, 9);
    indefinite(4, 4) = -1;
    CHECK(Problem(indefinite).solution(*cholesky, numbers.vector(9)).size() == 0);
    CHECK(cholesky->message() == "the tangent is not positive definite");
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

// --- blocks

namespace {

struct BlockProblem {
    std::vector<int> sizes, stage;
    std::vector<std::pair<int, int>> pairs;
    std::vector<char> multiplier;
    MatrixXd a;

    int first(int block) const { return std::accumulate(sizes.begin(), sizes.begin() + block, 0); }
    // Bodies in a chain with joints between neighbours, as mechanisms have them.
    BlockProblem(Numbers& numbers, int bodies, int joint) {
        for (int k = 0; k < bodies; ++k) sizes.push_back(6), stage.push_back(0);
        for (int k = 0; k + 1 < bodies; ++k) {
            sizes.push_back(joint), stage.push_back(1);
            pairs.push_back({bodies + k, k}), pairs.push_back({k + 1, bodies + k});
        }
        const int n = first(static_cast<int>(sizes.size()));
        a = MatrixXd::Zero(n, n);
        multiplier.assign(n, 0);
        for (int k = 0; k < bodies; ++k) {
            const MatrixXd m = numbers.matrix(6, 6);
            a.block(6 * k, 6 * k, 6, 6) =
                m * m.transpose() + MatrixXd::Identity(6, 6) + 0.3 * numbers.matrix(6, 6);
        }
        for (std::size_t p = 0; p < pairs.size(); p += 2) {
            const int b = pairs[p].first, at = first(b);
            std::fill_n(multiplier.begin() + at, joint, 1);
            for (int body : {pairs[p].second, pairs[p + 1].first}) {
                a.block(at, first(body), joint, 6) = numbers.matrix(joint, 6);
                a.block(first(body), at, 6, joint) =
                    a.block(at, first(body), joint, 6).transpose() + 0.1 * numbers.matrix(6, joint);
            }
        }
    }
    void fill(BlockLU& lu) const {
        lu.set_zero();
        const int n = static_cast<int>(sizes.size());
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                if (const LuBlock to = lu.block(i, j))
                    for (int r = 0; r < sizes[i]; ++r)
                        for (int c = 0; c < sizes[j]; ++c) to(r, c) = a(first(i) + r, first(j) + c);
    }
    void analyze(BlockLU& lu) const { lu.analyze(sizes, stage, pairs, multiplier), fill(lu); }
};

VectorXd solve(const BlockLU& lu, VectorXd b) { return lu.solve(b.data()), b; }

}  // namespace

TEST_CASE("block LU: solutions are those of the dense matrix") {
    Numbers numbers(17);
    for (int bodies : {1, 2, 9})
        for (int joint : {1, 3, 5}) {
            const BlockProblem p(numbers, bodies, joint);
            BlockLU lu;
            p.analyze(lu);
            const VectorXd b = numbers.vector(p.a.rows());
            for (int again = 0; again < 2; ++again) {  // a factorisation overwrites the matrix
                p.fill(lu);
                REQUIRE(lu.factor(0));
                CHECK(difference(solve(lu, b), p.a.fullPivLu().solve(b)) < 1e-11);
            }
        }
}

TEST_CASE("block LU: the largest blocks, and rows exchanged within them") {
    Numbers numbers(18);
    BlockProblem p(numbers, 1, 1);
    p.sizes = {lu_max_block, lu_max_block, 7}, p.stage = {0, 0, 0}, p.pairs = {{0, 1}, {1, 2}, {2, 2}};
    const int n = 2 * lu_max_block + 7;
    p.multiplier.assign(n, 0);
    p.a = numbers.matrix(n, n);
    p.a.block(0, 2 * lu_max_block, lu_max_block, 7).setZero();
    p.a.block(2 * lu_max_block, 0, 7, lu_max_block).setZero();
    p.a(0, 0) = 0;
    BlockLU lu;
    p.analyze(lu);
    REQUIRE(lu.factor(0));
    const VectorXd b = numbers.vector(n);
    CHECK(difference(solve(lu, b), p.a.fullPivLu().solve(b)) < 1e-9);
}

TEST_CASE("block LU: names the block that is singular, and is done with constraints that repeat others") {
    Numbers numbers(19);
    BlockProblem p(numbers, 4, 3);
    const int joint = 5, at = p.first(joint);  // the second one repeats its first row
    p.a.row(at + 2) = p.a.row(at), p.a.col(at + 2) = p.a.col(at);
    BlockLU lu;
    p.analyze(lu);
    CHECK_FALSE(lu.factor(0));
    CHECK(lu.singular_block() == joint);

    MatrixXd once(p.a.rows() - 1, p.a.cols() - 1);  // without the repetition
    const auto left = [&](int i) { return i < at + 2 ? i : i + 1; };
    for (int i = 0; i < once.rows(); ++i)
        for (int j = 0; j < once.cols(); ++j) once(i, j) = p.a(left(i), left(j));
    VectorXd b = numbers.vector(p.a.rows()), b1(once.rows());
    b[at + 2] = b[at];
    for (int i = 0; i < once.rows(); ++i) b1[i] = b[left(i)];
    const VectorXd bodies = once.fullPivLu().solve(b1).head(24);

    p.fill(lu);
    REQUIRE(lu.factor(1e-10));
    CHECK(difference(solve(lu, b).head(24), bodies) < 1e-7);
    lu.find_dependent(true), p.fill(lu);
    REQUIRE(lu.factor(0));
    CHECK(lu.n_dependent() == 1);
    CHECK(lu.gauges().size() == 1);
    CHECK(difference(solve(lu, b).head(24), bodies) < 1e-10);
    p.fill(lu);
    REQUIRE(lu.factor(0));
    CHECK(difference(solve(lu, b).head(24), bodies) < 1e-10);
}

TEST_CASE("block LU: what does not fit is refused") {
    BlockLU lu;
    CHECK_THROWS_AS(lu.analyze({lu_max_block + 1}, {0}, {}, std::vector<char>(65)), std::invalid_argument);
    CHECK_THROWS_AS(lu.analyze({1, 1}, {0}, {}, {0, 0}), std::invalid_argument);
    CHECK_THROWS_AS(lu.analyze({1, 1}, {0, 0}, {{0, 2}}, {0, 0}), std::invalid_argument);
    CHECK_THROWS_AS(lu.analyze({2}, {0}, {}, {0}), std::invalid_argument);
}

// --- cascade

namespace {

LinearChoice too_few_iterations() {
    LinearChoice c = choice(Backend::krylov);
    c.preconditioner = Preconditioner::none, c.max_iterations = 1, c.tolerance = 1e-12;
    return c;
}

}  // namespace

TEST_CASE("cascade: where a factorisation fails the next solver serves, and says why") {
    Numbers numbers(20);
    MatrixXd a = definite(numbers, 9);
    a(4, 4) = -1;
    const auto solver = make_linear({choice(Backend::cholesky), choice(Backend::sparse_lu)});
    const VectorXd b = numbers.vector(9);
    CHECK(difference(Problem(a).solution(*solver, b), a.fullPivLu().solve(b)) < 1e-12);
    CHECK(solver->message() == "simplicial Cholesky was left: the tangent is not positive definite; ");
    CHECK(solver->name() == make_sparse_lu()->name());
    CHECK(solver->state()[0] == 1);
}

TEST_CASE("cascade: where a solution fails the next solver factors and solves") {
    Numbers numbers(21);
    const MatrixXd a = definite(numbers, 12);
    const VectorXd b = numbers.vector(12);
    const auto solver = make_linear({too_few_iterations(), too_few_iterations(), choice(Backend::sparse_lu)});
    CHECK(difference(Problem(a).solution(*solver, b), a.fullPivLu().solve(b)) < 1e-12);
    CHECK(solver->state()[0] == 2);
    CHECK(solver->message().find("after 1 iterations") != std::string::npos);
}

TEST_CASE("cascade: the preferred solver is tried again after a while, ever more rarely") {
    Numbers numbers(22);
    const MatrixXd good = definite(numbers, 6), bad = -good;
    Problem problem(good);
    const auto solver = make_linear({choice(Backend::cholesky), choice(Backend::sparse_lu)});
    solver->analyze(problem.csr, problem.blocks);
    std::vector<int> tried;
    problem.take(bad);
    for (int k = 0; k < 60; ++k) {
        REQUIRE(problem.factor(*solver));
        if (!solver->message().empty()) tried.push_back(k);
    }
    CHECK(tried == std::vector<int>{0, 17, 50});
    problem.take(good);
    for (int k = 0; k < 100; ++k) REQUIRE(problem.factor(*solver));
    CHECK(solver->state()[0] == 0);
    CHECK(solver->name() == "simplicial Cholesky");
}

TEST_CASE("cascade: a last resort serves only where it may, and if all fail the last one says why") {
    Numbers numbers(23);
    MatrixXd a = definite(numbers, 6);
    a(1, 1) = -1;
    LinearChoice last = choice(Backend::sparse_lu);
    last.last_resort = true;
    const Problem problem(a);
    const auto solver = make_linear({choice(Backend::cholesky), last});
    solver->analyze(problem.csr, problem.blocks);
    solver->allow_last_resort(false);
    CHECK_FALSE(problem.factor(*solver));
    CHECK(solver->message() == "the tangent is not positive definite");
    solver->allow_last_resort(true);
    CHECK(problem.factor(*solver));
    solver->allow_last_resort(false);
    CHECK_FALSE(problem.factor(*solver));

    const Floating two(true);
    const auto all = make_linear({choice(Backend::cholesky), choice(Backend::sparse_lu)});
    const Problem singular(two.a);
    all->analyze(singular.csr, singular.blocks);
    CHECK_FALSE(singular.factor(*all));
    CHECK(all->singular_unknown() >= two.first);
}
