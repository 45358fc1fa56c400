// Jets and the functions of lanes against the C library in long double; long sums against plain ones.
#include <doctest/doctest.h>

#include <cmath>
#include <thread>
#include <vector>

#include "dense.hpp"
#include "visviva/base/jet.hpp"
#include "visviva/base/parallel.hpp"
#include "visviva/base/unknowns.hpp"
#include "visviva/base/vectors.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

using namespace visviva;
using namespace visviva::isa_test;

namespace {

using Real = long double;
using One = Jet<1, true>;
constexpr double eps = 2.220446049250313e-16;

struct Exact {
    Real value, first, second;
};

One at(double u) { return One::variable(broadcast(u), 0); }

// All three within `ulps` of what they should be or of `terms` that they are the sums of, in every lane.
void compare(const One& got, const Exact& exact, double ulps, const Exact& terms = {0, 0, 0}) {
    const V* numbers[3] = {&got.v, &got.g[0], &got.h[0]};
    const Real wanted[3] = {exact.value, exact.first, exact.second};
    const Real size[3] = {terms.value, terms.first, terms.second};
    for (int k = 0; k < 3; ++k)
        for (int l = 0; l < W; ++l) {
            CAPTURE(k);
            CHECK(std::abs((*numbers[k])[l] - wanted[k]) <=
                  ulps * eps * std::max(std::abs(wanted[k]), size[k]));
        }
}

const std::vector<double> places = {0,        1e-300, -1e-17, 1e-9,  -1e-4, 9.99e-3, 0.01,
                                    0.010001, -0.3,   0.4143, 0.999, -0.7,  3,       25};

}  // namespace

TEST_CASE("jets: the logarithm near one") {
    for (double u : places) {
        CAPTURE(u);
        const Real i = 1 / (1 + Real(u));
        compare(log1p(at(u)), {std::log1p(Real(u)), i, -i * i}, 4);
    }
    compare(log1p(at(-1 + 1e-10)),
            {std::log1p(Real(-1 + 1e-10)), 1 / (1 + Real(-1 + 1e-10)),
             -1 / ((1 + Real(-1 + 1e-10)) * (1 + Real(-1 + 1e-10)))},
            4);
    compare(log1p(at(1e200)), {std::log1p(Real(1e200)), 1e-200L, -0.0L}, 4);
}

TEST_CASE("jets: the exponential less one") {
    // beyond its series 1 is taken from exp, which leaves its rounding divided by the difference
    for (double sign : {1.0, -1.0})
        for (double u : places) {
            CAPTURE(sign * u);
            const Real x = Real(sign) * u;
            const Exact of_value_and_one = {0, 1, 1};
            compare(expm1(at(sign * u)), {std::expm1(x), std::exp(x), std::exp(x)}, u < 0.1 ? 200 : 40,
                    of_value_and_one);
        }
}

TEST_CASE("jets: powers less one") {
    for (double a : {-2.0 / 3, 0.5, 3.0, 1.0, 0.0, -4.0})
        for (double u : places) {
            CAPTURE(a);
            CAPTURE(u);
            const Real x = 1 + Real(u), p = std::pow(x, Real(a));
            const Real less = std::expm1(Real(a) * std::log1p(Real(u)));
            const Real first = std::abs(a) / x, second = std::abs(a * (a - 1)) / (x * x);
            compare(powm1(at(u), broadcast(a)), {less, a * p / x, Real(a) * (Real(a) - 1) * p / (x * x)}, 400,
                    {0, first, second});
        }
}

TEST_CASE("jets: the positive part, whose slope at zero is that of its flat side") {
    compare(positive(at(0.3)), {0.3, 1, 0}, 0);
    compare(positive(at(-0.3)), {0, 0, 0}, 0);
    compare(positive(at(0)), {0, 0, 0}, 0);
}

TEST_CASE("jets: sums, products and multiples of two variables") {
    using Two = Jet<2, true>;
    for (double x : {0.0, 1.5})
        for (double y : {0.0, -0.75}) {
            const Two X = Two::variable(broadcast(x), 0), Y = Two::variable(broadcast(y), 1);
            // x^2 y + 3 x - y + 2
            const Two f = X * X * Y + 3.0 * X - Y + 2.0;
            const double wanted[6] = {x * x * y + 3 * x - y + 2, 2 * x * y + 3, x * x - 1, 2 * y, 2 * x, 0};
            const V got[6] = {f.v, f.g[0], f.g[1], f.h[0], f.h[1], f.h[2]};
            for (int k = 0; k < 6; ++k) CHECK(got[k][0] == wanted[k]);
        }
}

TEST_CASE("jets: what is made of all functions, against differences") {
    const auto f = [](const auto& x, const auto& y, const auto& z) {
        return expm1(log1p(x * x + y * y) * z) + powm1(x * z + 1.0, broadcast(-1.3)) * positive(y + 2.0) -
               0.5 * (z * z * z);
    };
    using Three = Jet<3, true>;
    const Eigen::Vector3d place(0.4, -0.3, 0.8);
    Three variables[3];
    for (int k = 0; k < 3; ++k) variables[k] = Three::variable(broadcast(place[k]), k);
    const Three jet = f(variables[0], variables[1], variables[2]);
    const auto gradient = [&](const Eigen::VectorXd& x) {
        using First = Jet<3, false>;
        First v[3];
        for (int k = 0; k < 3; ++k) v[k] = First::variable(broadcast(x[k]), k);
        const First r = f(v[0], v[1], v[2]);
        return Eigen::VectorXd(Eigen::Vector3d(r.g[0][0], r.g[1][0], r.g[2][0]));
    };
    const auto value = [&](const Eigen::VectorXd& x) {
        const V r = f(broadcast(x[0]), broadcast(x[1]), broadcast(x[2]));
        return Eigen::VectorXd(Eigen::VectorXd::Constant(1, r[0]));
    };
    const Eigen::MatrixXd g = by_differences(value, place, 1e-3), H = by_differences(gradient, place, 1e-3);
    for (int a = 0; a < 3; ++a) {
        CHECK(jet.g[a][0] == doctest::Approx(g(0, a)).epsilon(1e-10));
        for (int b = a; b < 3; ++b)
            CHECK(jet.h[packed(3, a, b)][0] == doctest::Approx(H(a, b)).epsilon(1e-10));
    }
}

TEST_CASE("lanes do not mix") {
    V u;
    for (int l = 0; l < W; ++l) u[l] = 0.1 + l;
    const V e = vexp(u), g = vlog1p(u);
    for (int l = 0; l < W; ++l) {
        CHECK(std::abs(e[l] - std::exp(u[l])) <= 4 * eps * std::exp(u[l]));
        CHECK(std::abs(g[l] - std::log1p(u[l])) <= 4 * eps * std::log1p(u[l]));
    }
}

TEST_CASE("vectors: sums are right, and the same bits for any number of threads") {
    Numbers numbers(1);
    for (int n : {0, 1, 7, 1000, 100003}) {
        const Eigen::VectorXd p = numbers.vector(n), q = numbers.vector(n);
        const Vector a(p.begin(), p.end()), b(q.begin(), q.end());
        Real plain = 0, size = 0;
        for (int i = 0; i < n; ++i) plain += Real(a[i]) * b[i], size += std::abs(Real(a[i]) * b[i]);
        const double sum = dot(a, b);
        CHECK(std::abs(sum - plain) <= 100 * eps * size);
        Vector y = b;
        const double after = add_dot(0.5, a, y, a);
        CHECK(std::abs(after - (plain + 0.5 * Real(norm(a)) * norm(a))) <= 200 * eps * (size + n));
#ifdef _OPENMP
        const int before = n_threads();
        use_threads(3);
        CHECK(dot(a, b) == sum);
        Vector again = b;
        CHECK(add_dot(0.5, a, again, a) == after);
        CHECK(again == y);
        use_threads(before);
#endif
    }
}

#ifdef _OPENMP
TEST_CASE("threads: one number for loops of all threads of a program, and for none of Eigen's") {
    const int before = n_threads();
    std::vector<int> team(6, 0);
    auto count = [&] { parallel_for(6, [&](int i) { team[i] = omp_get_num_threads(); }); };
    for (int n : {3, 2}) {
        use_threads(n);
        std::thread(count).join();
        CHECK(team == std::vector<int>(6, n));
        CHECK(Eigen::nbThreads() == 1);
    }
    std::thread([] { use_threads(4); }).join();
    count();
    CHECK(team == std::vector<int>(6, 4));
    use_threads(before);
}
#endif

TEST_CASE("vectors of unknowns: zeros until they are written, and copies that bring back what was there") {
    Unknowns u(1 << 16), never;
    CHECK(is_zero(u));
    const KeptUnknowns none(u), nothing(never);
    u[3] = -2.5, u.back() = 1e-300;
    const KeptUnknowns some(u);
    const Unknowns written = u;
    none.bring_back(u);
    CHECK(u == Unknowns(1 << 16));
    some.bring_back(u);
    CHECK(u == written);
    some.bring_back(never);
    CHECK(never == written);
    nothing.bring_back(u);
    CHECK(u.empty());
    Unknowns again;
    none.bring_back(again);
    CHECK((again.size() == 1 << 16 && is_zero(again)));
}
