// Block LU of mechanisms against dense factorisations: solutions, what is singular, and redundant
// constraints.
#include <doctest/doctest.h>

#include <numeric>

#include "dense.hpp"
#include "visviva/linear/block_lu.hpp"

using namespace visviva;
using Eigen::MatrixXd, Eigen::VectorXd;

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
