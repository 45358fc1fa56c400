// The sparsity pattern against one made pair by pair; places of scalar entries; what a step is.
#include <doctest/doctest.h>

#include <set>

#include "dense.hpp"
#include "visviva/term/entry_term.hpp"
#include "visviva/term/pattern.hpp"

using namespace visviva;

namespace {

struct Mesh {
    std::vector<int> node;
    std::vector<char> fixed;
    std::set<std::pair<int, int>> pairs;  // of first unknowns

    explicit Mesh(unsigned seed) {
        Numbers numbers(seed);
        for (int k = 0; k < 12; ++k) {
            const int first = static_cast<int>(node.size()), size = 1 + numbers.below(3);
            for (int c = 0; c < size; ++c) node.push_back(first), fixed.push_back(numbers.below(3) == 0);
        }
        for (int k = 0; k < 40; ++k) pairs.insert({node[numbers.below(n())], node[numbers.below(n())]});
    }
    int n() const { return static_cast<int>(node.size()); }
    bool is_free(int unknown) const {
        for (int u = 0; u < n(); ++u)
            if (node[u] == node[unknown] && !fixed[u]) return true;
        return false;
    }
    int size(int unknown) const {
        return static_cast<int>(std::count(node.begin(), node.end(), node[unknown]));
    }
    bool coupled(int a, int b) const {
        if (!is_free(a) || !is_free(b)) return false;
        return pairs.count({node[a], node[b]}) || (node[a] == node[b] && size(a) > 1);
    }
};

}  // namespace

TEST_CASE("pattern: couples, order, held rows and places") {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        CAPTURE(seed);
        const Mesh mesh(seed);
        Pattern pattern(mesh.node, mesh.fixed);
        for (const auto& [a, b] : mesh.pairs) pattern.couple(a, b), pattern.couple(a, b);
        Csr csr;
        pattern.finish(csr);

        std::vector<int> unknown, held;
        for (int u = 0; u < mesh.n(); ++u) {
            if (!mesh.is_free(u)) continue;
            if (mesh.fixed[u]) held.push_back(static_cast<int>(unknown.size()));
            unknown.push_back(u);
        }
        CHECK(csr.n == static_cast<int>(unknown.size()));
        CHECK(csr.unknown == unknown);
        CHECK(pattern.held() == held);
        for (int u = 0; u < mesh.n(); ++u)
            CHECK((csr.equation[u] < 0 ? !mesh.is_free(u) : csr.unknown[csr.equation[u]] == u));

        std::vector<std::int64_t> row = {0};
        std::vector<int> col;
        for (int a : unknown) {
            CHECK(pattern.row_start(a) == row.back());
            for (std::size_t j = 0; j < unknown.size(); ++j) {
                if (!mesh.coupled(a, unknown[j])) continue;
                CHECK(pattern.position(a, unknown[j]) == static_cast<std::int64_t>(col.size()));
                col.push_back(static_cast<int>(j));
            }
            row.push_back(static_cast<std::int64_t>(col.size()));
            CHECK(pattern.row_length(a) == row.back() - row[row.size() - 2]);
            const Pattern::Rows rows = pattern.rows(a);
            CHECK(rows.end - rows.begin == mesh.size(a) * pattern.row_length(a));
            CHECK(rows.begin == pattern.row_start(mesh.node[a]));
        }
        CHECK(csr.row == row);
        CHECK(csr.col == col);
    }
}

TEST_CASE("pattern: nodes that nothing couples are left out as if they were fixed") {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        Mesh m(seed);
        std::set<int> touched;
        for (auto pair = m.pairs.begin(); pair != m.pairs.end();) {
            const bool is_near = pair->first < m.n() / 2 && pair->second < m.n() / 2 &&
                                 m.is_free(pair->first) && m.is_free(pair->second);
            if (is_near) touched.insert({pair->first, pair->second});
            pair = is_near ? std::next(pair) : m.pairs.erase(pair);
        }
        std::vector<char> others_fixed = m.fixed;
        for (int u = 0; u < m.n(); ++u)
            if (!touched.count(m.node[u])) others_fixed[u] = 1;
        Pattern found(m.node, m.fixed), expected(m.node, others_fixed);
        for (auto [a, b] : m.pairs)
            for (Pattern* pattern : {&found, &expected}) pattern->couple(a, b), pattern->couple(b, a);
        Csr left, wanted;
        found.leave_uncoupled();
        found.finish(left), expected.finish(wanted);
        CHECK(left.row == wanted.row);
        CHECK(left.col == wanted.col);
        CHECK(left.unknown == wanted.unknown);
        CHECK(left.equation == wanted.equation);
        CHECK(found.held() == expected.held());
    }
}

TEST_CASE("pattern: what is fixed has no place") {
    Pattern pattern({0, 0, 2}, {1, 1, 0});
    pattern.couple(0, 2), pattern.couple(2, 0), pattern.couple(2, 2);
    Csr csr;
    pattern.finish(csr);
    CHECK(csr.n == 1);
    CHECK(csr.equation == std::vector<int>{-1, -1, 0});
    CHECK(csr.col == std::vector<int>{0});
    CHECK(pattern.position(0, 2) == -1);
    CHECK(pattern.position(2, 2) == 0);
    CHECK(pattern.row_start(1) == -1);
    CHECK(pattern.row_length(1) == 0);
    CHECK(pattern.rows(1).node == -1);
    CHECK(pattern.rows(1).begin == pattern.rows(1).end);
}

TEST_CASE("pattern: what no term has coupled has no place, and is no neighbour's") {
    Pattern pattern({0, 1, 2, 3}, {0, 0, 0, 0});
    for (int k = 0; k < 4; ++k) pattern.couple(k, k);
    pattern.couple(0, 2);
    Csr csr;
    pattern.finish(csr);
    CHECK(pattern.position(0, 2) == 1);
    CHECK_THROWS_WITH_AS(pattern.position(0, 1), doctest::Contains("row 0, column 1"), std::logic_error);
    CHECK_THROWS_AS(pattern.position(0, 3), std::logic_error);  // beyond the last one of the row
    CHECK_THROWS_AS(pattern.position(2, 0), std::logic_error);
}

namespace {

struct Entries : EntryTerm {
    std::vector<std::pair<int, int>> entries;
    std::vector<std::int64_t> positions;

    void residual(const Context&, double*) override {}
    void tangent(const Context&, double* values) override {
        for (std::size_t k = 0; k < positions.size(); ++k) values[positions[k]] += 1 << k;
    }
    void ledger(const Context&, const double*, LedgerSums&) override {}

  private:
    void list_entries(std::vector<std::pair<int, int>>& all) const override { all = entries; }
    void set_positions(const std::vector<std::int64_t>& places) override { positions = places; }
};

}  // namespace

TEST_CASE("entry term: entries add up in their places, and what is fixed goes behind them") {
    Entries term;
    term.entries = {{2, 2}, {2, 3}, {0, 2}, {3, 2}, {2, 2}, {1, 1}};
    Pattern pattern({0, 1, 2, 3}, {1, 1, 0, 0});
    term.couple(pattern);
    Csr csr;
    pattern.finish(csr);
    term.connect(pattern);
    CHECK(csr.col == std::vector<int>{0, 1, 0});
    std::vector<double> values(csr.col.size() + 1, 0.0);
    term.tangent({Step{}, Vectors{}, Signals{}}, values.data());
    CHECK(values == std::vector<double>{1 + 16, 2, 8, 4 + 32});
    CHECK(term.capabilities().mesh == nullptr);
}

TEST_CASE("step: without velocities by increments it is one of statics") {
    Step step;
    CHECK(step.is_static());
    step.motion[1][0] = 1;  // at an instant masses alone may count
    CHECK(step.is_static());
    step.motion[0][0] = 1 / 0.1;
    CHECK_FALSE(step.is_static());
}
