// Reductions: their solutions are those of the whole dense system.
#include <doctest/doctest.h>

#include "linear_samples.hpp"
#include "visviva/linear/reduce/contact_condensation.hpp"
#include "visviva/linear/reduce/director_elimination.hpp"
#include "visviva/linear/reduce/element_condensation.hpp"
#include "visviva/linear/reduce/slave_elimination.hpp"

using namespace visviva;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {

// Whether a solver solves a system as the dense factorisation does, twice and with values anew.
void check(const MatrixXd& a, Problem& problem, LinearSolver& solver, Numbers& numbers) {
    solver.analyze(problem.csr, problem.blocks);
    for (double factor : {1.0, -2.5}) {
        problem.take(factor * a);
        REQUIRE(problem.factor(solver));
        for (int again = 0; again < 2; ++again) {
            const VectorXd b = numbers.vector(a.rows());
            CHECK(difference(factor * problem.solve(solver, b), a.fullPivLu().solve(b)) < 1e-11);
        }
    }
}

std::shared_ptr<ElementCondensation> condensation(const Problem& problem, const std::vector<int>& element) {
    auto reduction = std::make_shared<ElementCondensation>(problem.by_unknown(element, -1));
    reduction->analyze(problem.csr, {}, {});
    return reduction;
}

// --- condensation: elements of three nodes each and so many unknowns of their own

struct Elements {
    static constexpr int n_nodes = 8;
    MatrixXd a;
    std::vector<int> element;  // by equation
    int n_own;

    Elements(Numbers& numbers, int own) : n_own(own) {
        const int n = n_nodes + own * (n_nodes - 2);
        a = MatrixXd::Zero(n, n);
        element.assign(n, -1);
        for (int e = 0; e + 2 < n_nodes; ++e) {
            std::vector<int> at = {e, e + 1, e + 2};
            for (int k = 0; k < own; ++k) at.push_back(first(e) + k), element[at.back()] = e;
            for (int i : at)
                for (int j : at) a(i, j) += numbers.one() + (i == j ? 5 : 0);
        }
    }
    int first(int e) const { return n_nodes + n_own * e; }
};

}  // namespace

TEST_CASE("condensation: unknowns of single elements leave and come back") {
    Numbers numbers(31);
    for (int own : {1, 2, 4}) {
        const Elements e(numbers, own);
        Problem problem(e.a);
        const auto reduction = condensation(problem, e.element);
        CHECK(reduction->left().n == Elements::n_nodes);
        check(e.a, problem, *make_reduced(reduction, make_sparse_lu()), numbers);
    }
}

TEST_CASE("condensation: what is left is the Schur complement") {
    Numbers numbers(32);
    const Elements e(numbers, 2);
    const Problem problem(e.a);
    const auto reduction = condensation(problem, e.element);
    REQUIRE(reduction->reduce(problem.values.data()));
    const int n = Elements::n_nodes;
    const MatrixXd schur = e.a.topLeftCorner(n, n) - e.a.topRightCorner(n, e.a.cols() - n) *
                                                         e.a.bottomRightCorner(e.a.rows() - n, e.a.cols() - n)
                                                             .fullPivLu()
                                                             .solve(e.a.bottomLeftCorner(e.a.rows() - n, n));
    MatrixXd left = MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i)
        for (auto k = reduction->left().row[i]; k < reduction->left().row[i + 1]; ++k)
            left(i, reduction->left().col[k]) = reduction->values()[k];
    CHECK(difference(left, schur) < 1e-13);
}

TEST_CASE("condensation: an element that does not resist its own unknowns is named") {
    Numbers numbers(33);
    Elements e(numbers, 2);
    const int bad = e.first(3);
    const MatrixXd whole = e.a;
    e.a.block(bad, bad, 2, 2).setZero();
    const Problem problem(e.a, whole);
    const auto solver = make_reduced(condensation(problem, e.element), make_sparse_lu());
    solver->analyze(problem.csr, problem.blocks);
    CHECK_FALSE(problem.factor(*solver));
    CHECK(solver->report().singular_unknown == Problem::unknown(bad));
    CHECK(solver->report().message == "an element does not resist its own enhanced strains or pressures");
}

TEST_CASE("condensation: elements whose own unknowns couple are refused") {
    Numbers numbers(34);
    Elements e(numbers, 1);
    e.a(e.first(0), e.first(1)) = 1;
    const Problem problem(e.a);
    CHECK_THROWS_AS(condensation(problem, e.element), std::invalid_argument);
}

// --- elimination: nodes that constraints give by others

namespace {

// `n` moving unknowns; the constraints' rows and columns have one pattern, and values of their own.
struct Tied {
    int n;
    MatrixXd a;
    std::vector<Dependence> dependences;  // equations
    std::vector<char> fixed;
    std::vector<int> node;

    Tied(Numbers& numbers, int n, int constraints) : n(n) {
        a = side_by_side(arbitrary_matrix(numbers, n), MatrixXd::Zero(constraints, constraints));
        fixed.assign(n + constraints, 0);
        for (int i = 0; i < n + constraints; ++i) node.push_back(i);
    }
    void tie(Numbers& numbers, int constraint, int unknown, const std::vector<int>& others) {
        a(n + constraint, unknown) = 2 + numbers.one(), a(unknown, n + constraint) = -2 + numbers.one();
        for (int k : others) a(n + constraint, k) = numbers.one(), a(k, n + constraint) = numbers.one();
        dependences.push_back({unknown, n + constraint});
    }
    std::shared_ptr<SlaveElimination> reduction(const Problem& p) const {
        auto listed = dependences;
        for (Dependence& d : listed) d = {Problem::unknown(d.unknown), Problem::unknown(d.multiplier)};
        std::vector<int> numbered;
        for (int k : node) numbered.push_back(Problem::unknown(k));
        auto reduction = std::make_shared<SlaveElimination>(listed);
        reduction->analyze(p.csr, p.by_unknown<char>(fixed, 1), p.by_unknown(numbered, Problem::fixed));
        return reduction;
    }
};

}  // namespace

TEST_CASE("elimination: tied unknowns and their multipliers leave and come back") {
    Numbers numbers(35);
    Tied t(numbers, 14, 4);
    t.tie(numbers, 0, 3, {0, 1, 6});
    t.tie(numbers, 1, 4, {1});
    t.tie(numbers, 2, 9, {0, 7, 8, 13});
    t.tie(numbers, 3, 11, {});
    Problem problem(t.a);
    const auto reduction = t.reduction(problem);
    CHECK(reduction->n() == 4);
    CHECK(reduction->left().n == 10);
    check(t.a, problem, *make_reduced(reduction, make_sparse_lu()), numbers);
}

TEST_CASE("elimination: what depends on dependent unknowns stays among the equations") {
    Numbers numbers(36);
    Tied t(numbers, 10, 3);
    t.tie(numbers, 0, 3, {0, 1});
    t.tie(numbers, 1, 5, {3, 6});  // on what the first gives
    t.tie(numbers, 2, 1, {7});     // gives what the first depends on
    Problem problem(t.a);
    const auto reduction = t.reduction(problem);
    CHECK(reduction->n() == 1);
    check(t.a, problem, *make_reduced(reduction, make_sparse_lu()), numbers);
}

TEST_CASE("elimination: what is held beside free unknowns does not move") {
    Numbers numbers(37);
    Tied t(numbers, 10, 1);
    t.tie(numbers, 0, 4, {0, 6});
    t.fixed[6] = 1;
    Problem problem(t.a);  // as systems have it: the pattern, and an identity for what is held
    MatrixXd a = t.a;
    a.row(6).setZero(), a.col(6).setZero(), a(6, 6) = 1;
    problem.take(a);
    const auto solver = make_reduced(t.reduction(problem), make_sparse_lu());
    solver->analyze(problem.csr, problem.blocks);
    REQUIRE(problem.factor(*solver));
    VectorXd b = numbers.vector(11);
    b[6] = 0;
    CHECK(difference(problem.solve(*solver, b), a.fullPivLu().solve(b)) < 1e-12);
}

// --- exchange: pressures that press on nodes of their own

namespace {

// Two unknowns of their own, then nodes of `dim` each, then one multiplier for each of the first `pressed`.
struct Pressed {
    static constexpr int before = Problem::fixed;
    int dim, n_nodes, pressed;
    MatrixXd a, coupled;

    Pressed(Numbers& numbers, int dim, int n_nodes, int pressed)
        : dim(dim), n_nodes(n_nodes), pressed(pressed) {
        const int n = before + dim * n_nodes;
        a = side_by_side(arbitrary_matrix(numbers, n), MatrixXd::Zero(pressed, pressed));
        for (int k = 0; k < pressed; ++k) {
            for (int j = 0; j < n; j += 3) a(n + k, j) = 0.2 * numbers.one();
            a.block(node(k), n + k, dim, 1) = numbers.matrix(dim, 1);
            a.block(n + k, node(k), 1, dim) += a.block(node(k), n + k, dim, 1).transpose();
        }
        coupled = a;
    }
    int node(int k) const { return before + dim * k; }
    int multiplier(int k) const { return node(n_nodes) + k; }
    std::shared_ptr<ContactCondensation> reduction(const Problem& p) const {
        std::vector<NodalMultiplier> listed;
        for (int k = 0; k < pressed; ++k)
            listed.push_back({Problem::unknown(multiplier(k)), Problem::unknown(node(k)), dim});
        std::vector<char> fixed(p.csr.equation.size(), 0);
        fixed[Problem::fixed] = 1;
        auto reduction = std::make_shared<ContactCondensation>(listed);
        reduction->analyze(p.csr, fixed, {});
        return reduction;
    }
};

}  // namespace

TEST_CASE("exchange: pressures leave and come back") {
    Numbers numbers(38);
    for (int dim : {1, 2, 3}) {
        const Pressed p(numbers, dim, 6, 3);
        Problem problem(p.a);
        const auto reduction = p.reduction(problem);
        CHECK(reduction->n() == 3);
        check(p.a, problem, *make_reduced(reduction, make_sparse_lu()), numbers);
        CHECK_FALSE(reduction->is_rough());
    }
}

TEST_CASE("exchange: pressures with an entry of their own, on others as well, and without any force") {
    Numbers numbers(39);
    Pressed p(numbers, 2, 6, 3);
    p.a(p.multiplier(0), p.multiplier(0)) = 0.7;
    p.a(p.node(5), p.multiplier(0)) = 0.4, p.a(0, p.multiplier(1)) = -0.9;  // no node of another pressure
    p.a.col(p.multiplier(2)).setZero(), p.a.row(p.multiplier(2)).setZero();
    p.a(p.multiplier(2), p.multiplier(2)) = -3;
    Problem problem(p.a, p.coupled + p.a);
    const auto reduction = p.reduction(problem);
    CHECK(reduction->n() == 3);
    check(p.a, problem, *make_reduced(reduction, make_sparse_lu()), numbers);
    CHECK_FALSE(reduction->is_rough());
}

TEST_CASE("exchange: forces on each other's nodes are made up for, small or large") {
    Numbers numbers(40);
    Pressed p(numbers, 2, 6, 3);
    const MatrixXd without = p.a;
    const auto press = [&](double force) {
        p.a = without;
        p.a(p.node(0), p.multiplier(1)) = force, p.a(p.node(1) + 1, p.multiplier(2)) = force;
    };
    press(0.05);
    Problem problem(p.a);
    const auto reduction = p.reduction(problem);
    const auto solver = make_reduced(reduction, make_sparse_lu());
    check(p.a, problem, *solver, numbers);
    CHECK(reduction->is_rough());
    press(30);
    problem.take(p.a);
    check(p.a, problem, *solver, numbers);
}

namespace {

// Pressures that act on the nodes beside their own as well, with forces that grow along the chain.
Pressed chain_of_pressures(int dim, int n, double force) {
    Numbers numbers(1);
    Pressed p(numbers, dim, n, n);
    for (int k = 0; k + 1 < n; ++k) {
        p.a(p.node(k), p.multiplier(k + 1)) = force * (1 + k / 30.);
        p.a(p.node(k + 1), p.multiplier(k)) = -force * (4. / 3 + k / 30.);
    }
    return p;
}

VectorXd condensed(const Pressed& p, std::unique_ptr<LinearSolver> rest, const VectorXd& b,
                   double tolerance) {
    Problem problem(p.a);
    const auto solver = make_reduced(p.reduction(problem), std::move(rest));
    solver->analyze(problem.csr, problem.blocks);
    REQUIRE(problem.factor(*solver));
    const VectorXd x = problem.solve(*solver, b, tolerance);
    if (!solved(x)) CHECK(solver->report().message.starts_with("condensed pressures press too much"));
    return x;
}

}  // namespace

// With nodes of one unknown, constraints hold all: only the multipliers tell that forces were left out.
TEST_CASE("exchange: chains of pressures on each other's nodes are solved exactly or not at all") {
    Numbers numbers(44);
    for (int dim : {1, 2, 3})
        for (int n : {4, 12, 40})
            for (double force : {1e-3, 0.1, 1., 30., 1e4}) {
                const Pressed p = chain_of_pressures(dim, n, force);
                const VectorXd b = numbers.vector(p.a.rows()), x = condensed(p, make_sparse_lu(), b, 0);
                CAPTURE(dim);
                CAPTURE(n);
                CAPTURE(force);
                CHECK((solved(x) || (n > 30 && force > 0.01)));  // more pressures than are mixed
                if (!solved(x)) continue;
                CHECK(difference(p.a * x, b) < 1e-11);
                CHECK(difference(x, p.a.fullPivLu().solve(b)) < 1e-12);
            }
}

TEST_CASE("exchange: iterations leave of forces on each other's nodes what they leave of all") {
    Numbers numbers(45);
    for (double force : {0.1, 30.})
        for (double tolerance : {1e-3, 1e-9}) {
            const Pressed p = chain_of_pressures(3, 12, force);
            const VectorXd b = numbers.vector(p.a.rows());
            LinearChoice iterations = choice(Backend::krylov);
            iterations.method = KrylovMethod::gmres, iterations.tolerance = 1e-12;
            const VectorXd x = condensed(p, make_linear({iterations}), b, tolerance);
            CAPTURE(force);
            CAPTURE(tolerance);
            CHECK(difference(p.a * x, b) < 10 * tolerance);
        }
}

TEST_CASE("exchange: a pressure without a force and without an entry of its own is named") {
    Numbers numbers(41);
    Pressed p(numbers, 3, 4, 2);
    p.a.col(p.multiplier(1)).setZero();
    const Problem problem(p.a, p.coupled);
    const auto solver = make_reduced(p.reduction(problem), make_sparse_lu());
    solver->analyze(problem.csr, problem.blocks);
    CHECK_FALSE(problem.factor(*solver));
    CHECK(solver->report().singular_unknown == Problem::unknown(p.multiplier(1)));
    CHECK(solver->report().message == "a contact pressure has no force on its own node");
}

TEST_CASE("reductions around each other: elements condensed, then pressures exchanged") {
    Numbers numbers(42);
    const Pressed p(numbers, 2, 6, 2);
    const int n = static_cast<int>(p.a.rows());
    MatrixXd a = side_by_side(p.a, 4 * MatrixXd::Identity(2, 2));  // behind them an element's two unknowns
    const std::vector<int> nodes = {p.node(4), p.node(4) + 1, p.node(5), p.node(5) + 1};
    for (int i : nodes) {
        for (int j : nodes) a(i, j) += 0.1 * numbers.one() + 0.01;
        for (int k : {n, n + 1}) a(i, k) = numbers.one(), a(k, i) = numbers.one();
    }
    a(n, n + 1) = 0.3, a(n + 1, n) = -0.2;
    std::vector<int> element(n + 2, -1);
    element[n] = element[n + 1] = 0;
    Problem problem(a);
    const auto elements = condensation(problem, element);
    Problem inner(a);
    inner.csr = elements->left();
    const auto exchange = p.reduction(inner);
    // the exchange keeps the address of the pattern it was made for
    check(a, problem, *make_reduced(elements, make_reduced(exchange, make_sparse_lu())), numbers);
}

// --- directors: vectors whose length a multiplier holds

namespace {

// Nodes of a position and a vector, coupled whole with all others; the row and the column of a multiplier are
// different places on the sphere.
struct Held {
    static constexpr int n_nodes = 4, width = 6, n = n_nodes * width;
    MatrixXd a, coupled;
    std::vector<char> fixed;
    std::vector<int> node;
    std::vector<HeldLength> lengths;

    explicit Held(Numbers& numbers) {
        a = side_by_side(arbitrary_matrix(numbers, n, 2), MatrixXd::Zero(n_nodes, n_nodes));
        coupled = side_by_side(MatrixXd::Ones(n, n), MatrixXd::Zero(n_nodes, n_nodes));
        fixed.assign(n + n_nodes, 0);
        for (int i = 0; i < n; ++i) node.push_back(i / width * width);
        for (int k = 0; k < n_nodes; ++k) {
            node.push_back(n + k), lengths.push_back({width * k + 3, n + k});
            for (int i = width * k; i < width * (k + 1); ++i) coupled(i, n + k) = coupled(n + k, i) = 1;
            for (int c = 0; c < 3; ++c) {
                const int i = width * k + 3 + c;
                a(n + k, i) = 2 + numbers.one(), a(i, n + k) = 0.1 + a(n + k, i);
            }
            coupled(n + k, n + k) = 1;
        }
    }
    void hold(int i) {
        fixed[i] = 1;
        a.row(i).setZero(), a.col(i).setZero(), a(i, i) = 1;
    }
    std::shared_ptr<DirectorElimination> reduction(const Problem& p) const {
        auto listed = lengths;
        for (HeldLength& l : listed) l = {Problem::unknown(l.unknown), Problem::unknown(l.multiplier)};
        std::vector<int> numbered;
        for (int k : node) numbered.push_back(Problem::unknown(k));
        auto reduction = std::make_shared<DirectorElimination>(listed);
        reduction->analyze(p.csr, p.by_unknown<char>(fixed, 1), p.by_unknown(numbered, Problem::fixed));
        return reduction;
    }
};

}  // namespace

TEST_CASE("directors: vectors of constant length leave one component and the multiplier, and come back") {
    Numbers numbers(51);
    const Held h(numbers);
    Problem problem(h.a, h.coupled);
    const auto reduction = h.reduction(problem);
    CHECK(reduction->n() == 4);
    CHECK(reduction->left().n == 20);
    check(h.a, problem, *make_reduced(reduction, make_sparse_lu()), numbers);
}

TEST_CASE("directors: what is left is symmetric and definite where the tangent is on the constraints") {
    Numbers numbers(52);
    Held h(numbers);
    MatrixXd k = arbitrary_matrix(numbers, Held::n, 2);
    h.a.topLeftCorner(Held::n, Held::n) = k * k.transpose();
    h.a.topRightCorner(Held::n, 4) = h.a.bottomLeftCorner(4, Held::n).transpose();
    const Problem problem(h.a, h.coupled);
    const auto reduction = h.reduction(problem);
    REQUIRE(reduction->reduce(problem.values.data()));
    MatrixXd left = MatrixXd::Zero(20, 20);
    for (int i = 0; i < 20; ++i)
        for (auto e = reduction->left().row[i]; e < reduction->left().row[i + 1]; ++e)
            left(i, reduction->left().col[e]) = reduction->values()[e];
    CHECK(difference(left, left.transpose()) < 1e-13);
    CHECK(Eigen::SelfAdjointEigenSolver<MatrixXd>(left).eigenvalues()[0] > 0);
}

TEST_CASE("directors: components that are held do not move, and one alone leaves with its multiplier") {
    Numbers numbers(53);
    Held h(numbers);
    h.hold(4);               // between the others
    h.hold(10), h.hold(11);  // all but one
    Problem problem(h.a, h.coupled);
    const auto reduction = h.reduction(problem);
    CHECK(reduction->n() == 4);
    CHECK(reduction->left().n == 20);
    const auto solver = make_reduced(reduction, make_sparse_lu());
    solver->analyze(problem.csr, problem.blocks);
    REQUIRE(problem.factor(*solver));
    VectorXd b = numbers.vector(static_cast<int>(h.a.rows()));
    for (int i : {4, 10, 11}) b[i] = 0;
    CHECK(difference(problem.solve(*solver, b), h.a.fullPivLu().solve(b)) < 1e-11);
}

TEST_CASE("directors: a multiplier without a force is named") {
    Numbers numbers(54);
    Held h(numbers);
    h.a.col(Held::n + 2).setZero();
    const Problem problem(h.a, h.coupled);
    const auto solver = make_reduced(h.reduction(problem), make_sparse_lu());
    solver->analyze(problem.csr, problem.blocks);
    CHECK_FALSE(problem.factor(*solver));
    CHECK(solver->report().singular_unknown == Problem::unknown(Held::n + 2));
}
