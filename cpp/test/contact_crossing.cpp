// Where stretches come nearest: against a search of all places, and derivatives against differences.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "visviva/contact/crossing.hpp"

using namespace visviva;

namespace {

using Vector12 = Eigen::Matrix<double, 12, 1>;

Stretches of(const Vector12& X) {
    return {X.segment<3>(0), X.segment<3>(3), X.segment<3>(6), X.segment<3>(9)};
}

double sought(const Stretches& m) {
    constexpr int n = 400;
    double least = HUGE_VAL;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
            const Eigen::Vector3d x = m.first(i / double(n)), y = m.second(j / double(n));
            least = std::min(least, (x - y).squaredNorm() + Crossing::k * (x - m.a).squaredNorm());
        }
    return std::sqrt(least);
}

Vector12 random(std::mt19937& engine) {
    std::uniform_real_distribution<double> number(-1, 1);
    Vector12 X;
    for (double& x : X) x = number(engine);
    X.segment<6>(6) += 0.5 * X.segment<6>(0).reverse();
    return X;
}

}  // namespace

TEST_CASE("crossing: the least distance of all places") {
    std::mt19937 engine(3);
    for (int i = 0; i < 20; ++i) {
        const Stretches m = of(random(engine));
        const double found = cross(m).distance, least = sought(m);
        CHECK(found <= least + 1e-12);
        CHECK(found > least - 1e-2);
    }
}

TEST_CASE("crossing: stretches that cross touch there, parallel ones at the point") {
    const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0), up(0, 0, 0.1);
    const Crossing crossed = cross({-0.3 * x, 0.7 * x, -y - up, y - up});
    CHECK(std::abs(crossed.place[0] - 0.3 / (1 + Crossing::k)) < 1e-14);
    CHECK(crossed.distance < 0.1 * (1 + 0.5 * Crossing::k * 9));
    const Crossing parallel = cross({0.2 * x, 0.7 * x, -x - up, x - up});
    CHECK(std::abs(parallel.place[0]) < 1e-14);
    CHECK(std::abs(parallel.distance - 0.1) < 1e-15);
}

TEST_CASE("crossing: derivatives by the ends of both stretches") {
    constexpr double h = 1e-6;
    std::mt19937 engine(5);
    int kinds[2][2] = {};
    for (int i = 0; i < 60; ++i) {
        Vector12 X = random(engine);
        const bool point = i % 6 == 0;
        if (point) X.segment<3>(3) = X.segment<3>(0);
        const Crossing c = cross(of(X));
        const CrossingDerivatives d = differentiate(of(X), c);
        ++kinds[c.free[0]][c.free[1]];
        for (int k = 0; k < 12; ++k) {
            if (point && k < 6) continue;
            Vector12 step = Vector12::Zero();
            step[k] = h;
            const Crossing after = cross(of(X + step)), before = cross(of(X - step));
            const auto up = differentiate(of(X + step), after), down = differentiate(of(X - step), before);
            if (after.free[0] != before.free[0] || after.free[1] != before.free[1]) continue;
            CHECK(std::abs((after.distance - before.distance) / (2 * h) - d.gradient[k]) < 1e-7);
            CHECK(((up.gradient - down.gradient) / (2 * h) - d.hessian.col(k)).norm() < 1e-5);
            CHECK(((up.normal - down.normal) / (2 * h) - d.normals.col(k)).norm() < 1e-5);
            CHECK(std::abs((after.apart - before.apart) / (2 * h) - d.aparts[k]) < 1e-5);
            for (int j = 0; j < 2; ++j)
                CHECK(std::abs((after.place[j] - before.place[j]) / (2 * h) - d.places(j, k)) < 1e-5);
        }
    }
    CHECK(std::min({kinds[0][0], kinds[0][1], kinds[1][0], kinds[1][1]}) > 0);
}
