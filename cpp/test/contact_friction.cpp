// Coulomb's traction and the sliding that it acts on: cone, stick and slip, work and balance, and gradients
// against differences.
#include <doctest/doctest.h>

#include <cmath>

#include "dense.hpp"
#include "visviva/contact/friction.hpp"

using namespace visviva;
using Eigen::MatrixXd, Eigen::Vector2d, Eigen::Vector3d, Eigen::VectorXd;

TEST_CASE("friction: sticks within the cone, slips at its border along the trial traction") {
    Numbers numbers(91);
    int slipping = 0;
    for (int k = 0; k < 200; ++k) {
        const Vector2d trial = 2 * numbers.vector(2);
        const double limit = 1 + numbers.one();
        const Traction t = coulomb(trial, limit);
        CHECK(t.slips == (trial.norm() > limit));
        CHECK(t.value.norm() <= limit * (1 + 1e-15));
        // no other traction within the cone is nearer to the trial one
        for (int j = 0; j < 20; ++j) {
            const Vector2d other(limit * std::cos(0.1 * j * M_PI), limit * std::sin(0.1 * j * M_PI));
            CHECK((other - trial).norm() >= (t.value - trial).norm() - 1e-14);
        }
        if (!t.slips) CHECK(t.value == trial);
        if (t.slips) CHECK(difference(t.value, limit / trial.norm() * trial) < 1e-15);
        slipping += t.slips;

        const auto by_trial = [&](const VectorXd& x) { return VectorXd(coulomb(x, limit).value); };
        const auto by_limit = [&](const VectorXd& x) { return VectorXd(coulomb(trial, x[0]).value); };
        const double h = 1e-4;
        if (std::abs(trial.norm() - limit) < 3 * h) continue;  // where sticking ends derivatives jump
        CHECK((t.by_trial - by_differences(by_trial, trial, h)).norm() < 1e-8);
        CHECK((t.by_limit - by_differences(by_limit, VectorXd::Constant(1, limit), h)).norm() < 1e-8);
    }
    CHECK(slipping > 50);
    CHECK(slipping < 190);
}

TEST_CASE("friction: at the border, at rest, and where nothing presses") {
    CHECK_FALSE(coulomb({0.6, 0.8}, 1).slips);
    CHECK_FALSE(coulomb({0, 0}, 0).slips);
    CHECK(coulomb({0, 0}, 0).value.norm() == 0);
    const Traction t = coulomb({0.3, -0.4}, 0);
    CHECK(t.slips);
    CHECK(t.value.norm() == 0);
    CHECK(t.by_trial.norm() == 0);
    CHECK(t.by_limit == Vector2d(0.6, -0.8));
}

namespace {

// A vertex on a triangle of others, with weights and tangents that change as all of them move.
struct Stencil {
    static constexpr Eigen::Index k = 5;
    int dim;
    VectorXd masses;

    VectorXd place(Numbers& numbers) const {
        VectorXd x(3 * k);
        x << 0.3, 0.3, 0.1, 0, 0, 0, 1, 0, 0.1, 0.1, 1, -0.1, 0.9, 1.1, 0.05;
        x += 0.05 * numbers.vector(3 * k);
        return flat(x);
    }
    VectorXd flat(VectorXd x) const {
        for (Eigen::Index i = 2; dim == 2 && i < 3 * k; i += 3) x[i] = 0;
        return x;
    }
    VectorXd weight(const VectorXd& x) const {
        VectorXd w(k);
        for (Eigen::Index i = 1; i < k; ++i) w[i] = -0.1 * i - 0.2 * x[3 * i] * x[1] + 0.1 * x[0];
        w[0] = -w.tail(k - 1).sum();
        return w;
    }
    Vector3d normal(const VectorXd& x) const {
        const Vector3d a = x.segment<3>(3), b = x.segment<3>(6), c = x.segment<3>(9);
        if (dim == 2) return Vector3d(b[1] - a[1], a[0] - b[0], 0).normalized();
        return (b - a).cross(c - a).normalized();
    }
    Grip grip(const VectorXd& x, bool gradients = true) const {
        Grip g;
        g.weight = weight(x);
        const Vector3d edge = x.segment<3>(6) - x.segment<3>(3);
        const MatrixXd N = by_differences([&](const VectorXd& y) { return VectorXd(normal(y)); }, x, 1e-3);
        set_tangents(dim, normal(x), gradients ? &N : nullptr, edge, 1, 2, g);
        if (gradients)
            g.weight_gradient = by_differences([&](const VectorXd& y) { return weight(y); }, x, 1e-3);
        return g;
    }
};

std::vector<Stencil> stencils() {
    VectorXd masses(Stencil::k);
    masses << 1, 0.7, 1.3, 0.4, 2;
    return {{2, masses}, {3, masses}};
}

MatrixXd in_plane(const Stencil& s, MatrixXd by_place) {
    for (Eigen::Index i = 2; s.dim == 2 && i < by_place.cols(); i += 3) by_place.col(i).setZero();
    return by_place;
}

}  // namespace

TEST_CASE("friction: tangents are orthonormal to the normal, and turn as differences do") {
    Numbers numbers(92);
    for (const Stencil& s : stencils()) {
        const VectorXd x = s.place(numbers);
        const Grip g = s.grip(x);
        for (int i = 0; i < s.dim - 1; ++i) {
            CHECK(std::abs(g.tangent.col(i).dot(s.normal(x))) < 1e-15);
            CHECK(g.tangent.col(i).norm() == doctest::Approx(1).epsilon(1e-15));
            const MatrixXd slope = by_differences(
                [&](const VectorXd& y) { return VectorXd(s.grip(y, false).tangent.col(i)); }, x, 1e-3);
            CHECK(difference(in_plane(s, g.tangent_gradient[i]), in_plane(s, slope)) < 1e-8);
        }
        if (s.dim == 3) CHECK(std::abs(g.tangent.col(0).dot(g.tangent.col(1))) < 1e-15);
        if (s.dim == 2) CHECK(g.tangent.col(1).norm() == 0);
    }
}

TEST_CASE(
    "friction: forces have neither resultant nor torque, do the sliding's work, and rigid motion is none") {
    Numbers numbers(93);
    for (const Stencil& s : stencils()) {
        const VectorXd x = s.place(numbers), D = s.flat(0.1 * numbers.vector(x.size()));
        const Grip grip = s.grip(x);
        const Sliding sliding(grip, x, D, s.masses, s.dim);
        const Vector2d traction = numbers.vector(2);
        const VectorXd f = sliding.force(traction);
        Vector3d resultant = Vector3d::Zero(), torque = Vector3d::Zero();
        for (Eigen::Index i = 0; i < s.k; ++i) {
            resultant += f.segment<3>(3 * i);
            torque += Vector3d(x.segment<3>(3 * i)).cross(Vector3d(f.segment<3>(3 * i)));
        }
        CHECK(f.norm() > 0.01);
        CHECK(resultant.norm() < 1e-14);
        CHECK(torque.norm() < 1e-14);
        CHECK(f.dot(D) == doctest::Approx(traction.dot(sliding.displacement())).epsilon(1e-12));
        CHECK(difference(sliding.directions() * traction, f) < 1e-14);

        VectorXd rigid(x.size());
        const Vector3d turn = s.dim == 2 ? Vector3d(0, 0, 0.3) : Vector3d(0.3, -0.2, 0.4);
        for (Eigen::Index i = 0; i < s.k; ++i)
            rigid.segment<3>(3 * i) = Vector3d(0.2, -0.1, 0) + turn.cross(Vector3d(x.segment<3>(3 * i)));
        CHECK(Sliding(grip, x, rigid, s.masses, s.dim).displacement().norm() < 1e-14);
        CHECK(Sliding(grip, x, D + rigid, s.masses, s.dim)
                  .displacement()
                  .isApprox(sliding.displacement(), 1e-11));
    }
}

TEST_CASE("friction: gradients of the displacement and of forces are those of differences") {
    Numbers numbers(94);
    for (const Stencil& s : stencils())
        for (double theta : {0.0, 0.5, 1.0}) {
            const VectorXd x0 = s.place(numbers), D = s.flat(0.1 * numbers.vector(x0.size()));
            const Vector2d traction = numbers.vector(2);
            const auto with = [&](const VectorXd& d, auto use) {
                const VectorXd x = x0 + theta * d;
                const Grip grip = s.grip(x);
                return use(Sliding(grip, x, d, s.masses, s.dim));
            };
            const MatrixXd displacement = by_differences(
                [&](const VectorXd& d) {
                    return with(d, [](const Sliding& a) { return VectorXd(a.displacement()); });
                },
                D, 1e-3);
            const MatrixXd force = by_differences(
                [&](const VectorXd& d) {
                    return with(d, [&](const Sliding& a) { return a.force(traction); });
                },
                D, 1e-3);
            with(D, [&](const Sliding& a) {
                CHECK(difference(in_plane(s, a.displacement_gradient(theta)), in_plane(s, displacement)) <
                      1e-8);
                CHECK((in_plane(s, a.force_gradient(traction, theta)) - in_plane(s, force)).norm() < 1e-8);
                return 0;
            });
        }
}

TEST_CASE("friction: what is left without the rigid motion, by masses and increments") {
    Numbers numbers(95);
    for (const Stencil& s : stencils()) {
        const VectorXd x = s.place(numbers), D = s.flat(0.1 * numbers.vector(x.size()));
        const Complement c(x, D, s.masses, s.dim);
        const auto momentum = [&](const VectorXd& w) { return Complement(x, D, w, s.dim).momentum(); };
        const auto size = [&](const VectorXd& w) {
            return VectorXd(VectorXd::Constant(1, Complement(x, D, w, s.dim).size()));
        };
        CHECK(difference(c.by_masses(), by_differences(momentum, s.masses, 1e-3)) < 1e-8);
        CHECK(difference(c.size_by_masses().transpose(), by_differences(size, s.masses, 1e-3)) < 1e-8);
        CHECK(c.size() == doctest::Approx(c.momentum().dot(D)).epsilon(1e-12));
        CHECK(c.size() > 0);
    }
}
