// Rates at the end of a step that satisfy the time derivatives of the constraints.
//
// With the gradients G at the end and the mass M they are, from those v* that the scheme gave,
//     M v1 + G^T mu = M v* + p,    G v1 = -d Phi/dt,
// where p = (h/2) G_0^T lambda for gradients taken at the start of the step (position-momentum form of the
// variational midpoint rule) and 0 otherwise. What a scheme remembers besides the rates changes along, as if
// by an increment of the coordinates that leaves the positions alone, and so do the multipliers: that is the
// stabilised index-2 form of generalised alpha (Arnold, Bruels & Cardona 2015), in the order position, then
// rates.
#include <algorithm>

#include "system.hpp"

namespace visviva {

void System::set_rate_solver(std::unique_ptr<LinearSolver> solver, std::vector<char> constraint) {
    rate_solver_ = std::move(solver);
    constraint_ = std::move(constraint);
    rate_revision_ = -1;
}

bool System::projects_rates() const { return rate_solver_ && !condensation_ && !elimination_ && !exchange_; }

// Entries of unknowns that are neither coordinates nor constraints become those of the identity.
void System::analyze_rates() {
    auto takes_part = [&](int u) { return !fixed_[u] && (order_[u] > 0 || constraint_[u]); };
    rate_zero_.clear(), rate_one_.clear();
    for (int i = 0; i < csr_.n; ++i)
        for (auto k = csr_.row[i]; k < csr_.row[i + 1]; ++k) {
            const int u = csr_.unknown[i], v = csr_.unknown[csr_.col[k]];
            if (takes_part(u) && takes_part(v)) continue;
            (u == v ? rate_one_ : rate_zero_).push_back(k);
        }
    rate_solver_->analyze(csr_, blocks_);
    rate_revision_ = revision_;
}

// The partial time derivative of the constraints at the end, by prescribed unknowns and functions of time;
// central differences are exact, for constraints are quadratic in them.
void System::drift(const Context& c, std::vector<double>& d) {
    d.assign(n_ + 1, 0.0);
    const bool moves =
        std::any_of(prescribed_.begin(), prescribed_.end(), [&](int u) { return v_next_[u] != 0; });
    const bool turns =
        std::any_of(c.signals.rate1, c.signals.rate1 + n_signals_, [](double s) { return s != 0; });
    if (!moves && !turns) return;
    std::vector<double> at1(n_signals_);
    const Signals moved{c.signals.at0, c.signals.ate, at1.data(), c.signals.rate1};
    const std::vector<double> x1 = x1_;
    for (const double way : {1.0, -1.0}) {
        for (int u : prescribed_) x1_[u] = x1[u] + way * v_next_[u];
        for (std::size_t k = 0; k < n_signals_; ++k) at1[k] = c.signals.at1[k] + way * c.signals.rate1[k];
        evaluate_residual({c.step, c.vectors, moved}, true);
        for (int u = 0; u < n_; ++u) d[u] += 0.5 * way * r_[u];
    }
    x1_ = x1;
}

bool System::project_rates(const Context& c) {
    if (rate_revision_ != revision_) analyze_rates();
    const std::vector<double> x1 = x1_;
    for (int u = 0; u < n_; ++u)
        if (constraint_[u]) x1_[u] = 0;
    std::vector<double> impulse(n_ + 1, 0.0), change;
    if (c.step.theta_g == 0) {  // what is left of the balance without multipliers
        evaluate_residual(c, true);
        for (int u = 0; u < n_; ++u) impulse[u] = -0.5 * c.step.h * r_[u];
    }
    drift(c, change);
    Step instant = c.step;
    instant.theta = 0, instant.theta_g = 1, instant.stress = Stress::at_theta;
    std::fill(&instant.motion[0][0], &instant.motion[0][0] + 20, 0.0);
    std::fill(&instant.transport[0][0], &instant.transport[0][0] + 20, 0.0);
    instant.motion[1][0] = instant.transport[0][0] = 1;
    evaluate_tangent({instant, c.vectors, c.signals}, rate_solver_->keeps_rigidity(), false);
    for (auto k : rate_zero_) values_[k] = 0;
    for (auto k : rate_one_) values_[k] = 1;
    std::fill(r_.begin(), r_.end(), 0.0);
    for (int i = 0; i < csr_.n; ++i) {
        const int u = csr_.unknown[i];
        if (constraint_[u]) r_[u] = change[u];
        if (order_[u] == 0 || fixed_[u]) continue;
        r_[u] = -impulse[u];
        for (auto k = csr_.row[i]; k < csr_.row[i + 1]; ++k)
            if (const int v = csr_.unknown[csr_.col[k]]; order_[v] > 0) r_[u] -= values_[k] * v_next_[v];
    }
    const Place end = place(instant);
    if (solver_->n_redundant() > 0) rate_solver_->find_redundant(true);
    const bool solved =
        rate_solver_->factor(values_.data(), end) && rate_solver_->solve_rates(r_.data(), end, d_.data());
    x1_ = x1;
    if (solved) take_rates(c.step);
    return solved;
}

// The projected rates, and with them the histories and multipliers of schemes that have some.
void System::take_rates(const Step& step) {
    const auto& t = step.motion;
    const bool remembers = step.uses_history();
    for (int i = 0; i < csr_.n; ++i) {
        const int u = csr_.unknown[i];
        if (fixed_[u]) continue;
        if (constraint_[u] && remembers) x1_[u] += t[1][0] / t[2][0] * d_[u];
        if (order_[u] == 0) continue;
        if (order_[u] == 2 && remembers) {
            a_next_[u] += t[3][0] / t[2][0] * (d_[u] - v_next_[u]);
            w_next_[u] += t[4][0] / t[2][0] * (d_[u] - v_next_[u]);
        }
        v_next_[u] = d_[u];
    }
}

}  // namespace visviva
