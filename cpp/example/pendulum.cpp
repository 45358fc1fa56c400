// The core without Python: a point mass on a massless rod swings under gravity; energy and length are
// checked.
#include <cmath>
#include <cstdio>

#include "visviva/strain/strain_term.hpp"
#include "visviva/system/system.hpp"
#include "visviva/term/inertia_term.hpp"

using namespace visviva;

// One term of one element: forms y = x - pivot (the identity), strains and law as given.
static std::shared_ptr<Term> term(StrainShape shape, std::vector<int> index, double constant,
                                  std::vector<double> par) {
    shape.n_x = shape.n_y = 3, shape.n_e = 1;
    shape.form_row = shape.form_col = {0, 1, 2};
    const std::vector<double> weight(3, 1.0), pivot(3, 0.0);
    const int no_signal = -1;
    auto t = std::make_shared<StrainTerm>(shape, 1, index.data(), weight.data(), pivot.data(), &constant,
                                          par.data(), static_cast<int>(par.size()), &no_signal);
    t->account = {0}, t->component = {0};
    return t;
}

int main() {
    const double mass = 2, gravity = 9.81, length = 1, h = 0.01;
    System system({2, 2, 2, 0}, {0, 0, 0, 0}, {1, 1, 1, 0});  // position and the multiplier of the rod

    const int index[3] = {0, 1, 2};
    auto inertia =
        std::make_shared<InertiaTerm>(2, 1, 3, 1, std::vector<int>{0, 0}, &mass, index, std::vector<char>{1});
    inertia->account = {0}, inertia->component = {0};
    system.add(inertia);

    StrainShape weight;  // W = m g z
    weight.law = LawKind::linear, weight.lin_e = {0}, weight.lin_a = {2}, weight.lin_coef = {1};
    system.add(term(weight, {0, 1, 2}, 0, {mass * gravity, 0}));

    StrainShape rod;  // (|x|^2 - length^2) / 2 = 0
    rod.law = LawKind::constraint, rod.n_m = 1;
    rod.quad_e = {0, 0, 0}, rod.quad_a = rod.quad_b = {0, 1, 2}, rod.quad_coef = {0.5, 0.5, 0.5};
    system.add(term(rod, {0, 1, 2, 3}, -0.5 * length * length, {0, 0}));

    system.set_accounts(1, 1);
    system.finalize();
    system.set_solver(make_sparse_lu());
    system.x[0] = length;  // horizontal, at rest

    Step step;  // energy-momentum: midpoint with discrete gradients
    step.theta = step.theta_g = 0.5, step.stress = Stress::discrete_gradient;
    step.motion[0][0] = 1 / h;
    step.motion[1][0] = 2 / (h * h), step.motion[1][1] = -2 / h;
    step.motion[2][0] = 2 / h, step.motion[2][1] = -1;
    step.h = h;

    double worst = 0;
    for (int k = 0; k < 1000; ++k) {
        step.t0 = k * h, step.t1 = (k + 1) * h, step.te = (k + 0.5) * h;
        const Report report = system.advance(step, {}, {});
        if (!report.converged) {
            std::printf("step %d failed: %s\n", k, report.reason.c_str());
            return 1;
        }
        worst = std::fmax(worst, std::fabs(system.sums.energy[0]));
        worst = std::fmax(worst, std::fabs(std::hypot(system.x[0], system.x[1], system.x[2]) - length));
    }
    std::printf("1000 steps: largest error of energy and length %.1e\n", worst);
    return worst < 1e-10 ? 0 : 1;
}
