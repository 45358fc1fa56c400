// Stresses and moduli of the materials: against differences of their energies, against jets of the energies
// through plain formulas of the invariants, and between materials that coincide.
#include <doctest/doctest.h>

#include "material_samples.hpp"

using namespace visviva;
using namespace visviva::isa_test;

namespace {

std::vector<Matrix3d> motions() {
    Numbers numbers(3);
    std::vector<Matrix3d> all;
    for (int k = 0; k < 4; ++k) all.push_back(Matrix3d::Identity() + 0.25 * numbers.matrix(3, 3));
    all.push_back(numbers.rotation());
    return all;
}

Six strain(const Matrix3d& F) { return tensor(F.transpose() * F - Matrix3d::Identity()); }

// The energy with invariants written down plainly, over jets of all six components of C.
template <int n, class Energy>
Answer by_jets(const Six& c, const std::vector<double>& fibre, Energy energy) {
    using J = Jet<6, true>;
    J x[6], i[5];
    for (int k = 0; k < 6; ++k) x[k] = J::variable(broadcast(c[k]), k);
    const J C[6] = {x[0] + 1.0, x[1] + 1.0, x[2] + 1.0, x[3], x[4], x[5]};
    i[0] = x[0] + x[1] + x[2];
    i[1] = C[0] * C[1] + C[1] * C[2] + C[2] * C[0] - C[3] * C[3] - C[4] * C[4] - C[5] * C[5] + (-3.0);
    const J det = C[0] * (C[1] * C[2] - C[4] * C[4]) - C[3] * (C[3] * C[2] - C[4] * C[5]) +
                  C[5] * (C[3] * C[4] - C[1] * C[5]);
    i[2] = powm1(det + (-1.0), broadcast(0.5));
    for (int f = 3; f < n; ++f) {
        i[f] = J::constant(V{});
        for (int k = 0; k < 6; ++k) i[f] = i[f] + (k < 3 ? 1.0 : 2.0) * fibre[6 * (f - 3) + k] * x[k];
    }
    const J w = energy(i);
    Answer a{w.v[0], {}, {}};
    for (int k = 0; k < 6; ++k) {
        a.s[k] = w.g[k][0] / multiplicities()[k];
        for (int l = k; l < 6; ++l)
            a.d(k, l) = a.d(l, k) = w.h[packed(6, k, l)][0] / (multiplicities()[k] * multiplicities()[l]);
    }
    return a;
}

}  // namespace

TEST_CASE("materials: stresses and moduli are derivatives of the energy") {
    for (const Material& m : materials)
        for (const Matrix3d& F : motions()) {
            CAPTURE(m.name);
            const Six c = strain(F);
            // where fibres begin to carry, moduli jump
            if (m.kind == MaterialKind::holzapfel && c.norm() < 1e-12) continue;
            const Answer a = respond_to(m, c);
            const auto energy = [&](const VectorXd& x) {
                return VectorXd(VectorXd::Constant(1, respond_to(m, x).W));
            };
            const auto stress = [&](const VectorXd& x) { return VectorXd(respond_to(m, x).s); };
            const MatrixXd slope = by_differences(energy, c, 1e-3), moduli = by_differences(stress, c, 1e-3);
            const double size = respond_to(m, Six::Zero()).d.norm();
            CHECK((a.s.cwiseProduct(multiplicities()) - slope.transpose()).norm() < 1e-8 * size);
            CHECK((a.d * multiplicities().asDiagonal() - moduli).norm() < 1e-7 * size);
        }
}

TEST_CASE("materials: the chain rule through the invariants is that of jets of the whole energy") {
    for (const Material& m : materials)
        for (const Matrix3d& F : motions()) {
            CAPTURE(m.name);
            const Six c = strain(F);
            const Parameters p(m.par);
            Answer jets{};
            if (m.kind == MaterialKind::hooke || m.kind == MaterialKind::ogden) continue;
            if (m.kind == MaterialKind::holzapfel)
                jets = by_jets<5>(c, {m.par.begin() + 6, m.par.end()},
                                  [&](const auto* i) { return holzapfel(i, p.p); });
            else
                with_energy(m.kind, p.p, [&](auto energy) { jets = by_jets<3>(c, {}, energy); });
            const Answer a = respond_to(m, c);
            const double size = respond_to(m, Six::Zero()).d.norm();
            CHECK(std::abs(a.W - jets.W) < 1e-13 * size);
            CHECK((a.s - jets.s).norm() < 1e-13 * size);
            CHECK((a.d - jets.d).norm() < 1e-12 * size);
        }
}

TEST_CASE(
    "materials: at rest there is neither energy nor stress, and the moduli are symmetric and definite") {
    for (const Material& m : materials) {
        CAPTURE(m.name);
        const Answer a = respond_to(m, Six::Zero());
        CHECK(a.W == 0);
        CHECK(a.s.norm() < 1e-15 * a.d.norm());
        const MatrixXd moduli =
            multiplicities().cwiseSqrt().asDiagonal() * a.d * multiplicities().cwiseSqrt().asDiagonal();
        CHECK(Eigen::SelfAdjointEigenSolver<MatrixXd>(moduli).eigenvalues().minCoeff() > 0.01);
    }
}

TEST_CASE("materials: isotropic ones do not see how the reference is turned, fibres turn with it") {
    Numbers numbers(5);
    const Matrix3d Q = numbers.rotation();
    for (const Material& m : materials)
        for (const Matrix3d& F : motions()) {
            CAPTURE(m.name);
            const Material turned = m.kind == MaterialKind::holzapfel ? holzapfel_fibres(Q) : m;
            const Answer a = respond_to(m, strain(F)), b = respond_to(turned, strain(F * Q.transpose()));
            CHECK(b.W == doctest::Approx(a.W).epsilon(1e-12));
            CHECK((matrix(b.s) - Q * matrix(a.s) * Q.transpose()).norm() < 1e-12 * a.d.norm());
        }
}

TEST_CASE("materials: a motion that is rigid alone stores nothing") {
    Numbers numbers(6);
    for (const Material& m : materials) {
        CAPTURE(m.name);
        const Answer a = respond_to(m, strain(numbers.rotation()));
        CHECK(std::abs(a.W) < 1e-28);
        CHECK(a.s.norm() < 1e-14 * a.d.norm());
    }
}

TEST_CASE("materials: Ogden's with exponent two is neo-Hooke's, where principal values coincide as well") {
    std::vector<Matrix3d> all = motions();
    all.push_back(Matrix3d::Identity());
    all.push_back(Eigen::Vector3d(1.2, 1.2, 0.8).asDiagonal());
    all.push_back(Eigen::Vector3d(1.2, 1.2 + 1e-9, 0.8).asDiagonal());
    all.push_back(Eigen::Vector3d(1.1, 1.1, 1.1).asDiagonal());
    const Material o{"", MaterialKind::ogden, {3, 0, 0, 1.2, 2, 0, 1, 0, 1}};
    const Material n{"", MaterialKind::neo_hooke, {1.2, 3, 0}};
    for (const Matrix3d& F : all) {
        const Answer a = respond_to(o, strain(F)), b = respond_to(n, strain(F));
        CHECK(std::abs(a.W - b.W) < 1e-14);
        CHECK((a.s - b.s).norm() < 1e-13);
        CHECK((a.d - b.d).norm() < 1e-7);  // of slopes between values that differ by little
    }
}

TEST_CASE("materials: the response in space is the one at rest pushed forward") {
    for (const Material& m : materials) {
        if (!traits(m.kind).isotropic) continue;
        for (const Matrix3d& F : motions()) {
            CAPTURE(m.name);
            const Answer a = respond_to(m, strain(F));
            const Six e = tensor(F * F.transpose() - Matrix3d::Identity());
            V x[6];
            for (int k = 0; k < 6; ++k) x[k] = broadcast(e[k]);
            const Parameters p(m.par);
            SpatialResponse<false> r;
            respond_in_space(m.kind, x, p.p, r);
            MatrixXd push(6, 6);  // of symmetric tensors over components, a pair off the diagonal at once
            for (int l = 0; l < 6; ++l) {
                Six one = Six::Zero();
                one[l] = 1;
                push.col(l) = tensor(F * matrix(one) * F.transpose());
            }
            Six tau;
            MatrixXd moduli(6, 6);
            for (int k = 0; k < 6; ++k) {
                tau[k] = r.tau[k][0];
                for (int l = k; l < 6; ++l) moduli(k, l) = moduli(l, k) = r.c[packed(6, k, l)][0];
            }
            CHECK((tau - 2 * push * a.s).norm() < 1e-13 * a.d.norm());
            CHECK((moduli - 4 * push * a.d * push.transpose()).norm() < 1e-12 * a.d.norm());
            if (!traits(m.kind).plain) continue;
            SpatialResponse<true> q;
            respond_in_space(m.kind, x, p.p, q);
            const double lambda = q.c[0][0], mu = q.c[1][0];
            MatrixXd two = MatrixXd::Zero(6, 6);
            two.topLeftCorner(3, 3).setConstant(lambda);
            for (int k = 0; k < 6; ++k) two(k, k) += (k < 3 ? 2 : 1) * mu;
            CHECK(difference(two, moduli) < 1e-12);
        }
    }
}
