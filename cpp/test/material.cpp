// Stresses and moduli of the materials: against differences of their energies, against jets of the energies
// through plain formulas of the invariants, and between materials that coincide.
#include <doctest/doctest.h>

#include "dense.hpp"
#include "visviva/material/mixed_energy.hpp"
#include "visviva/material/plane_stress.hpp"

using namespace visviva;
using namespace visviva::isa_test;

namespace {

using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::VectorXd;
using Six = Eigen::Matrix<double, 6, 1>;

struct Material {
    std::string name;
    MaterialKind kind;
    std::vector<double> par;
};

Six tensor(const Matrix3d& a) {
    Six s;
    for (int k = 0; k < 6; ++k) s[k] = a(voigt_a[k], voigt_b[k]);
    return s;
}
Matrix3d matrix(const Six& s) {
    Matrix3d a;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) a(i, j) = s[voigt[i][j]];
    return a;
}

std::vector<double> fibres(const Matrix3d& turn) {
    std::vector<double> all;
    for (double angle : {0.5, -0.9}) {
        const Eigen::Vector3d a = turn * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.2).normalized();
        const Six s = tensor(a * a.transpose());
        all.insert(all.end(), s.begin(), s.end());
    }
    return all;
}

Material holzapfel_fibres(const Matrix3d& turn) {
    Material m{"holzapfel", MaterialKind::holzapfel, {1.1, 0.7, 1.9, 0.1, 6, 2}};
    for (double a : fibres(turn)) m.par.push_back(a);
    return m;
}

const std::vector<Material> materials = {
    {"hooke", MaterialKind::hooke, {3, 1.2}},
    {"neo-hooke", MaterialKind::neo_hooke, {1.2, 3, 0}},
    {"neo-hooke, simo", MaterialKind::neo_hooke, {1.2, 3, 2}},
    {"mooney", MaterialKind::mooney, {0.7, 0.3, 2 * 0.7 + 4 * 0.3, 4, 1}},
    {"isochoric", MaterialKind::isochoric, {0.6, 0.2, 0.1, 0.3, 5, 0}},
    {"gent", MaterialKind::gent, {1.3, 20, 4, 2}},
    {"ogden", MaterialKind::ogden, {4, 1, 1, 1.1, 1.8, 0.3, -2.2, 0.2, 5}},
    {"ogden, not split", MaterialKind::ogden, {4, 0, 0, 1.1, 1.8, 0.3, -2.2, 0, 1}},
    {"blatz-ko", MaterialKind::blatz_ko, {1.4, 0.8}},
    holzapfel_fibres(Matrix3d::Identity()),
};

struct Parameters {
    V p[material_max_parameters] = {};
    explicit Parameters(const std::vector<double>& par) {
        for (std::size_t k = 0; k < par.size(); ++k) p[k] = broadcast(par[k]);
    }
};

struct Answer {
    double W;
    Six s;
    Eigen::Matrix<double, 6, 6> d;  // over tensor components
};

Answer answer(const Response& r) {
    Answer a{r.W[W - 1], {}, {}};
    for (int k = 0; k < 6; ++k) {
        a.s[k] = r.s[k][W - 1];
        for (int l = k; l < 6; ++l) a.d(k, l) = a.d(l, k) = r.d[packed(6, k, l)][W - 1];
    }
    return a;
}

Answer respond_to(const Material& m, const Six& c) {
    V x[6];
    for (int k = 0; k < 6; ++k) x[k] = broadcast(c[k]);
    Response r;
    respond<true>(m.kind, x, Parameters(m.par).p, r);
    return answer(r);
}

// Differences vary a component on both sides of the diagonal at once.
Six multiplicities() { return Six(1, 1, 1, 2, 2, 2); }

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
        if (!isotropic(m.kind)) continue;
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
            if (!plain(m.kind)) continue;
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

TEST_CASE("materials: plane stress leaves none across, and its moduli are derivatives") {
    for (const Material& m : materials) {
        CAPTURE(m.name);
        const Parameters p(m.par);
        V across;
        const auto in_plane = [&](const VectorXd& x) {
            const V c[6] = {broadcast(x[0]), broadcast(x[1]), V{}, broadcast(x[2]), V{}, V{}};
            Response r;
            plane_stress<true>(m.kind, c, p.p, r, across);
            return answer(r);
        };
        const Eigen::Vector3d c(0.2, -0.1, 0.07);
        const Answer a = in_plane(c);
        const Six whole{c[0], c[1], across[0], c[2], 0, 0};
        CHECK(a.W == doctest::Approx(respond_to(m, whole).W).epsilon(1e-13));
        CHECK(std::abs(respond_to(m, whole).s[2]) < 1e-10);
        const auto stress = [&](const VectorXd& x) {
            const Six s = in_plane(x).s;
            return VectorXd(Eigen::Vector3d(s[0], s[1], s[3]));
        };
        const MatrixXd moduli = by_differences(stress, c, 1e-3);
        const int at[3] = {0, 1, 3};
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l)
                CHECK(a.d(at[k], at[l]) * (l < 2 ? 1 : 2) == doctest::Approx(moduli(k, l)).epsilon(1e-7));
    }
}

TEST_CASE("materials: half the square of a volume measure is the volumetric energy") {
    using One = Jet<1, true>;
    for (double j : {-0.6, -0.35, -0.0301, -0.0299, -1e-6, 0.0, 1e-9, 0.0299, 0.0301, 0.4, 0.6, 3.0}) {
        CAPTURE(j);
        const One J = One::variable(broadcast(j), 0);
        const double b = 0.8;
        const One g[2] = {simo_measure(J), blatz_ko_measure(J, broadcast(b))};
        const One U[2] = {volumetric(J, broadcast(2)),
                          (1 / b) * ((1 / b) * powm1(J, broadcast(-b)) + log1p(J))};
        for (int k = 0; k < 2; ++k) {
            CAPTURE(k);
            const One half = 0.5 * (g[k] * g[k]);
            CHECK(std::abs(half.v[0] - U[k].v[0]) < 1e-15 + 1e-13 * U[k].v[0]);
            CHECK(std::abs(half.g[0][0] - U[k].g[0][0]) < 2e-15 + 1e-12 * std::abs(U[k].g[0][0]));
            CHECK(half.h[0][0] == doctest::Approx(U[k].h[0][0]).epsilon(1e-11));
            CHECK((g[k].v[0] > 0) == (j > 0));
        }
    }
}

TEST_CASE("materials: stresses and moduli of F-bar and of pressures are derivatives of their energies") {
    Numbers numbers(8);
    const auto check = [&](const auto& energy, const VectorXd& c) {
        constexpr int n = std::decay_t<decltype(energy)>::n;
        const auto evaluate = [&](const VectorXd& x) {
            V lanes[n];
            for (int k = 0; k < n; ++k) lanes[k] = broadcast(x[k]);
            Potential<n> p;
            energy.template evaluate<true>(lanes, p);
            return p;
        };
        const auto value = [&](const VectorXd& x) {
            return VectorXd(VectorXd::Constant(1, evaluate(x).W[0]));
        };
        const auto stress = [&](const VectorXd& x) {
            const auto p = evaluate(x);
            return VectorXd(VectorXd::NullaryExpr(n, [&](Eigen::Index k) { return p.s[k][0]; }));
        };
        const MatrixXd s = by_differences(value, c, 1e-3), d = by_differences(stress, c, 1e-3);
        const auto p = evaluate(c);
        for (int k = 0; k < n; ++k) {
            CHECK(multiplicity(k) * p.s[k][0] == doctest::Approx(s(0, k)).epsilon(1e-7));
            for (int l = 0; l < n; ++l)
                CHECK(multiplicity(l) * p.d[n * k + l][0] == doctest::Approx(d(k, l)).epsilon(1e-7));
        }
    };
    const Parameters p({1.2, 3, 2});
    for (int directions : {2, 3}) {
        VectorXd c = 0.1 * numbers.vector(12);
        if (directions == 2) c[2] = c[4] = c[5] = c[8] = c[10] = c[11] = 0;
        CAPTURE(directions);
        check(FbarEnergy{MaterialKind::neo_hooke, false, directions, p.p}, c);
    }
    for (VolumeMeasure measure : {VolumeMeasure::logarithm, VolumeMeasure::difference, VolumeMeasure::simo,
                                  VolumeMeasure::trace, VolumeMeasure::blatz_ko}) {
        const VolumeEnergy volume{measure, broadcast(0.8)};
        CAPTURE(static_cast<int>(measure));
        const VectorXd c = 0.2 * numbers.vector(6);
        check(volume, c);
        check(PressureEnergy{MaterialKind::neo_hooke, p.p, volume, broadcast(-0.7)}, c);
    }
}
