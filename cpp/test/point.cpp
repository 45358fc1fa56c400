// Discrete gradients over blocks of strains, strain maps, internal variables.
#include <doctest/doctest.h>

#include "material_samples.hpp"
#include "visviva/point/director_maps.hpp"
#include "visviva/point/energies.hpp"
#include "visviva/point/heated_branch.hpp"
#include "visviva/point/quadratic.hpp"
#include "visviva/point/thermoelastic_sheet.hpp"
#include "visviva/point/thermoelastic_volumes.hpp"

using namespace visviva;
using namespace visviva::isa_test;
using Eigen::MatrixXd, Eigen::VectorXd;

namespace {
template <class Energy>
void check_gradient(const Energy& energy, const VectorXd& e0, const VectorXd& e1) {
    constexpr int n = Energy::n;
    V from[n], s[n], T[n * n];
    for (int k = 0; k < n; ++k) from[k] = broadcast(e0[k]);
    const auto energy_at = [&](const VectorXd& e) {
        V at[n];
        for (int k = 0; k < n; ++k) at[k] = broadcast(e[k]);
        Potential<n> p;
        energy.template evaluate<false>(at, p);
        return p.W[0];
    };
    const auto stress = [&](const VectorXd& e) {
        V to[n];
        for (int k = 0; k < n; ++k) to[k] = broadcast(e[k]);
        if constexpr (requires { energy.template discrete_gradient<true>(from, to, s, T); }) {
            energy.template discrete_gradient<true>(from, to, s, T);  // of strains as they stand
            for (int k = 0; k < n; ++k) s[k] = s[k] / Energy::weight(k);
            for (int k = 0; k < n * n; ++k) T[k] = T[k] / (Energy::weight(k / n) * Energy::weight(k % n));
        } else {
            discrete_gradient<true>(energy, from, to, s, T);
        }
        return VectorXd(VectorXd::NullaryExpr(n, [&](Eigen::Index k) { return s[k][0]; }));
    };
    const MatrixXd slope = by_differences(stress, e1, 1e-3);
    const VectorXd found = stress(e1);
    double work = 0;
    for (int k = 0; k < n; ++k) work += Energy::weight(k) * found[k] * (e1[k] - e0[k]);
    const double change = energy_at(e1) - energy_at(e0);
    CHECK(std::abs(work - change) < 1e-13 * (1 + std::abs(change)));
    for (int k = 0; k < n; ++k)
        for (int l = 0; l < n; ++l)
            CHECK(Energy::weight(l) * T[n * k + l][0] == doctest::Approx(slope(k, l)).epsilon(2e-6));
}
}  // namespace

TEST_CASE("point: discrete gradients give the change of energy, whole and in blocks") {
    Numbers numbers(3);
    const V damage[6] = {broadcast(20.0), broadcast(10.0), broadcast(0.5),
                         broadcast(0.3),  broadcast(1e-3), broadcast(10.0)},
            maxwell[4] = {broadcast(20.0), broadcast(10.0), broadcast(8.0), broadcast(2.0)},
            phases[3] = {broadcast(4.0), broadcast(0.1), broadcast(1.0)};
    check_gradient(DamageEnergy(damage), 0.1 * numbers.vector(10), 0.1 * numbers.vector(10));
    check_gradient(ViscoelasticEnergy(maxwell), 0.1 * numbers.vector(12), 0.1 * numbers.vector(12));
    check_gradient(SeparationEnergy(phases), numbers.vector(4), numbers.vector(4));
}

TEST_CASE("point: discrete gradients of every material that conducts heat give the change of energy") {
    Numbers numbers(4), in_plane(6);
    for (const Material& material : materials) {
        if (material.kind == MaterialKind::hooke) continue;
        CAPTURE(material.name);
        V par[thermal::n_par] = {};
        const double heat[5] = {static_cast<double>(material.kind), 0.2, 20.0, 0.4, 0.03};
        for (int k = 0; k < 5; ++k) par[k] = broadcast(heat[k]);
        for (std::size_t k = 0; k < material.par.size(); ++k)
            par[thermal::material + k] = broadcast(material.par[k]);
        for (const double slope : {0.0, 0.01}) {  // of the capacity, whose constant has a gradient of its own
            par[thermal::more] = broadcast(slope);
            check_gradient(ThermoelasticEnergy(par), 0.1 * numbers.vector(7), 0.1 * numbers.vector(7));
            check_gradient(ThermoelasticEnergyOf<CentreVolume<3>>(par), 0.1 * numbers.vector(13),
                           0.1 * numbers.vector(13));
            check_gradient(VolumePressureEnergy(par), 0.1 * numbers.vector(9), 0.1 * numbers.vector(9));
            check_gradient(ThermoelasticEnergyOf<CentreVolume<2>>(par), 0.1 * in_plane.vector(13),
                           0.1 * in_plane.vector(13));
            check_gradient(SheetEnergy(par), 0.1 * in_plane.vector(7), 0.1 * in_plane.vector(7));
        }
    }
}

template <class Map>
static void check_map() {
    Numbers numbers(5);
    constexpr int n_y = Map::n_local, n_e = Map::n_strains;
    const VectorXd y = numbers.vector(n_y);
    using Rows = Strains<Map>;
    V lanes[n_y], e[n_e], entries[Rows::n_entries], B[n_e * n_y] = {};
    for (int j = 0; j < n_y; ++j) lanes[j] = broadcast(y[j]);
    Rows::evaluate(lanes, e), Rows::rows(lanes, entries);
    for (int i = 0; i < Rows::n_entries; ++i)
        B[n_y * Rows::sparse.entry[i].k + Rows::sparse.entry[i].j] = entries[i];
    double exact[n_e];
    Map::strains(y.data(), exact);
    const auto strains = [](const VectorXd& x) {
        VectorXd all(Map::n_strains);
        Map::strains(x.data(), all.data());
        return all;
    };
    const MatrixXd rows = by_differences(strains, y, 1e-3);
    for (int k = 0; k < n_e; ++k) {
        CHECK(+e[k][0] == doctest::Approx(exact[k]).epsilon(1e-13));
        for (int j = 0; j < n_y; ++j) CHECK(std::abs(B[n_y * k + j][0] - rows(k, j)) < 1e-9);
    }
}

TEST_CASE("point: what is found of strain maps at compile time is what they say") {
    check_map<SolidMap>();
    check_map<EntropyMap<SolidMap>>();
    check_map<EntropyMap<PlaneMap>>();
    check_map<EntropyMap<CentreMap<SolidMap>>>();
    check_map<EntropyMap<CentreMap<RevolutionMap>>>();
    check_map<VolumePressureMap<SolidMap>>();
    check_map<VolumePressureMap<PlaneMap>>();
    check_map<HeatedBranchMap<RevolutionMap>>();
    check_map<ScalarMap>();
    check_map<BeamMap>();
    check_map<ShellMap>();
}

TEST_CASE("point: internal variables relax as in closed form, and never gain") {
    // small strains held: A - I -> -(C - I) with rate mu_v / (2 eta)
    const V par[4] = {broadcast(20.0), broadcast(10.0), broadcast(8.0), broadcast(2.0)};
    const ViscoelasticEnergy energy(par);
    Step step;
    step.h = 0.01, step.theta = 0.5, step.stress = Stress::discrete_gradient;
    V e0[12] = {}, e1[12] = {}, et[12] = {}, s[12], T[144];
    e0[0] = e1[0] = broadcast(1e-6);
    for (int k = 0; k < 100; ++k) {
        V lost;
        CHECK(all(evolve<false>(energy, step, W, e0, e1, et, s, T, lost)));
        CHECK(+lost[0] > 0);
        for (int i = 6; i < 12; ++i) e0[i] = e1[i];
    }
    CHECK(+e1[6][0] == doctest::Approx(-1e-6 * (1 - std::exp(-2.0))).epsilon(1e-4));
}
