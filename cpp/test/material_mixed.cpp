// Energies that are made of a material's: plane stress, F-bar, and pressures with their measures of volume.
#include <doctest/doctest.h>

#include "material_samples.hpp"
#include "visviva/material/mixed_energy.hpp"
#include "visviva/point/energies.hpp"

using namespace visviva;
using namespace visviva::isa_test;

TEST_CASE("materials: plane stress leaves none across, and its moduli are derivatives") {
    for (const Material& m : materials) {
        CAPTURE(m.name);
        const Parameters p(m.par);
        V across;
        const auto in_plane = [&](const VectorXd& x) {
            const V c[6] = {broadcast(x[0]), broadcast(x[1]), V{}, broadcast(x[2]), V{}, V{}};
            Response r;
            const PlaneStress<MaterialEnergy> energy{{{}, m.kind, p.p}, true};
            energy.evaluate<true>(c, r);
            across = energy.across(c);
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

namespace {
/// Stresses and moduli of an energy against differences.
template <class Energy>
void check(const Energy& energy, const VectorXd& c) {
    constexpr int n = Energy::n;
    const auto evaluate = [&](const VectorXd& x) {
        V lanes[n];
        for (int k = 0; k < n; ++k) lanes[k] = broadcast(x[k]);
        Potential<n> p;
        energy.template evaluate<true>(lanes, p);
        return p;
    };
    const auto value = [&](const VectorXd& x) { return VectorXd(VectorXd::Constant(1, evaluate(x).W[0])); };
    const auto stress = [&](const VectorXd& x) {
        const auto p = evaluate(x);
        return VectorXd(VectorXd::NullaryExpr(n, [&](Eigen::Index k) { return p.s[k][0]; }));
    };
    const MatrixXd s = by_differences(value, c, 1e-3), d = by_differences(stress, c, 1e-3);
    const auto p = evaluate(c);
    for (int k = 0; k < n; ++k) {
        CHECK(Energy::weight(k) * p.s[k][0] == doctest::Approx(s(0, k)).epsilon(1e-7));
        for (int l = 0; l < n; ++l)
            CHECK(Energy::weight(l) * p.second(k, l)[0] == doctest::Approx(d(k, l)).epsilon(1e-7));
    }
}
}  // namespace

TEST_CASE("materials: stresses and moduli of F-bar and of pressures are derivatives of their energies") {
    Numbers numbers(8);
    const Parameters p({1.2, 3, 2});
    const MaterialEnergy neo_hooke{{}, MaterialKind::neo_hooke, p.p};
    const V strain = broadcast(0.15);
    for (int directions : {2, 3}) {
        VectorXd c = 0.1 * numbers.vector(12);
        if (directions == 2) c[2] = c[4] = c[5] = c[8] = c[10] = c[11] = 0;
        CAPTURE(directions);
        for (const V* heat : {static_cast<const V*>(nullptr), &strain}) {
            const Stretched<MaterialEnergy> material{neo_hooke, heat, false};
            check(FbarEnergy<Stretched<MaterialEnergy>>{{}, material, false, directions}, c);
        }
    }
    for (VolumeMeasure measure : {VolumeMeasure::logarithm, VolumeMeasure::difference, VolumeMeasure::simo,
                                  VolumeMeasure::trace, VolumeMeasure::blatz_ko}) {
        const VolumeEnergy volume{{}, measure, broadcast(0.8)};
        CAPTURE(static_cast<int>(measure));
        const VectorXd c = 0.2 * numbers.vector(6);
        check(volume, c);
        const PressureEnergy<MaterialEnergy> mixed{neo_hooke, volume, broadcast(-0.7)};
        check(mixed, c);
        check(Stretched<PressureEnergy<MaterialEnergy>>{mixed, &strain, false}, c);
    }
}

TEST_CASE("materials: energies of several fields are wrapped like those of materials") {
    Numbers numbers(9);
    const Parameters p({20, 10, 8, 2, 20, 0.5});
    const V strain = broadcast(0.1);
    const ViscoelasticEnergy viscous(p.p);
    const VectorXd c = 0.1 * numbers.vector(12);
    check(Stretched<ViscoelasticEnergy>{viscous, &strain, false}, c);
    // free of stress where heat alone leads to
    VectorXd free = VectorXd::Zero(12);
    free.head(3).setConstant(1.1 * 1.1 - 1);
    V e[12];
    for (int k = 0; k < 12; ++k) e[k] = broadcast(free[k]);
    Potential<12> at;
    Stretched<ViscoelasticEnergy>{viscous, &strain, false}.evaluate<true>(e, at);
    for (int k = 0; k < 12; ++k) CHECK(std::abs(at.s[k][0]) < 1e-14);
    // no stress across, by an energy with internal variables
    e[3] = broadcast(0.2), e[4] = e[5] = V{};
    const PlaneStress<ViscoelasticEnergy> sheet{viscous, true};
    const V across = sheet.across(e);
    sheet.evaluate<false>(e, at);
    e[2] = across;
    Potential<12> whole;
    viscous.evaluate<false>(e, whole);
    CHECK(std::abs(whole.s[2][0]) < 1e-12);
    CHECK(+at.W[0] == doctest::Approx(whole.W[0]).epsilon(1e-13));
}
