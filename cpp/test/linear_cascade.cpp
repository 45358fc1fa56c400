// The cascade of solvers: who takes over where one fails, says why, and when the preferred one comes back.
#include <doctest/doctest.h>

#include "linear_samples.hpp"

using namespace visviva;
using Eigen::MatrixXd, Eigen::VectorXd;

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
    CHECK(solver->report().message == "simplicial Cholesky was left: the tangent is not positive definite; ");
    CHECK(solver->report().name == make_sparse_lu()->report().name);
    CHECK(solver->capabilities().sequence->state()[0] == 1);
}

TEST_CASE("cascade: where a solution fails the next solver factors and solves") {
    Numbers numbers(21);
    const MatrixXd a = definite(numbers, 12);
    const VectorXd b = numbers.vector(12);
    const auto solver = make_linear({too_few_iterations(), too_few_iterations(), choice(Backend::sparse_lu)});
    CHECK(difference(Problem(a).solution(*solver, b), a.fullPivLu().solve(b)) < 1e-12);
    CHECK(solver->capabilities().sequence->state()[0] == 2);
    CHECK(solver->report().message.find("after 1 iterations") != std::string::npos);
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
        if (!solver->report().message.empty()) tried.push_back(k);
    }
    CHECK(tried == std::vector<int>{0, 17, 50});
    problem.take(good);
    for (int k = 0; k < 100; ++k) REQUIRE(problem.factor(*solver));
    CHECK(solver->capabilities().sequence->state()[0] == 0);
    CHECK(solver->report().name == "simplicial Cholesky");
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
    solver->capabilities().sequence->allow_last_resort(false);
    CHECK_FALSE(problem.factor(*solver));
    CHECK(solver->report().message == "the tangent is not positive definite");
    solver->capabilities().sequence->allow_last_resort(true);
    CHECK(problem.factor(*solver));
    solver->capabilities().sequence->allow_last_resort(false);
    CHECK_FALSE(problem.factor(*solver));

    const Floating two(true, 1);
    const auto all = make_linear({choice(Backend::cholesky), choice(Backend::sparse_lu)});
    const Problem singular(two.a);
    all->analyze(singular.csr, singular.blocks);
    CHECK_FALSE(singular.factor(*all));
    CHECK(two.has(all->report().singular_unknown));
}
