// Rates at the end of a step that satisfy the time derivatives of the constraints.
//
// With the gradients G at the end and the mass M they are, from those v* that the scheme gave,
//     M v1 + G^T mu = M v* + p,    G v1 = -d Phi/dt,
// where p is half of the impulse of the multipliers in the step, (h/2) G_0^T lambda, for gradients taken at
// its start (position-momentum form of the variational midpoint rule) and 0 otherwise. What a scheme
// remembers besides the rates changes along, as if by an increment of the coordinates that leaves the
// positions alone, and so do the multipliers: that is the stabilised index-2 form of generalised alpha
// (Arnold, Bruels & Cardona 2015), in the order position, then rates.
#include <algorithm>

#include "visviva/base/at_exit.hpp"
#include "visviva/system/system.hpp"

namespace visviva {

void System::set_rate_solver(std::unique_ptr<LinearSolver> solver, std::vector<char> constraint) {
    rate_solver_ = std::move(solver);
    rate_rigid_ = rate_solver_->capabilities().rigid;
    constraint_ = std::move(constraint);
    rate_revision_ = -1;
}

bool System::projects_rates() const { return rate_solver_ != nullptr; }

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

namespace {

// What `length` stands for an instant at the end of a step: no clock notices it, and users may divide by it.
Step instant_after(const Step& step) {
    constexpr double length = Step::no_length;
    Step instant;
    instant.t0 = instant.t1 = instant.te = step.t1, instant.h = length;
    instant.theta = 0, instant.theta_g = 1;
    instant.motion[1][0] = instant.transport[0][0] = instant.flow[0][0] = 1;
    return instant;
}

}  // namespace

// What acts for a moment, as contact does, has no part in the rates, and keeps its branch.
void System::evaluate_lasting(const Context& c) {
    std::fill(r_.begin(), r_.end(), 0.0);
    add_up(r_, for_each_term([&](const Part& part) {
               if (part.term->is_lasting) part.term->residual(c, r_.data());
           }));
}

// With entries of unknowns that take no part.
void System::evaluate_rate_matrix(const Context& c) {
    clear_values();
    const Context seen{c.step, c.vectors, c.signals, c.backwards, rate_rigid_ != nullptr};
    for (const bool on_meshes : {true, false})
        for (const auto& [term, can] : terms_)
            if (term->is_lasting && (can.mesh != nullptr) == on_meshes) term->tangent(seen, values_.data());
    for (auto k : rate_zero_) values_[k] = 0;
    for (auto k : rate_one_) values_[k] = 1;
    keep_weightless();
}

// What has no mass and meets no constraint keeps its rates: its rows are zero. Solvers that keep bodies rigid
// leave constraints of directors out: one director without mass turns with the others, and only all without
// keep theirs.
void System::keep_weightless() {
    std::vector<double> entries(n_, 0.0);  // other than zero, in the rows of all processes
    for (int i = 0; i < csr_.n; ++i)
        entries[csr_.unknown[i]] =
            std::any_of(values_.begin() + csr_.row[i], values_.begin() + csr_.row[i + 1],
                        [](double value) { return value != 0; });
    total(entries);
    std::vector<char> weightless(n_, 0);
    for (int u : csr_.unknown) weightless[u] = entries[u] == 0;
    for (const RigidUnknowns& body : blocks_.rigid) {
        const auto begin = body.q + 3, end = body.q + 12;
        const bool all = std::all_of(begin, end, [&](int u) { return weightless[u] || fixed_[u]; });
        if (rate_rigid_ != nullptr && !all) std::for_each(begin, end, [&](int u) { weightless[u] = 0; });
    }
    for (int i = 0; i < csr_.n; ++i)
        for (auto k = csr_.row[i]; k < csr_.row[i + 1]; ++k)
            if (const int u = csr_.unknown[i]; weightless[u] && is_own(u) && csr_.col[k] == i) values_[k] = 1;
}

// Adds a factor times the constraints, later by some time, as those see it that look at the clock themselves.
void System::add_later(const Context& c, double later, double factor, Unknowns& d) {
    Step moved = c.step;
    moved.t0 += later, moved.t1 += later, moved.te += later;
    std::fill(r_.begin(), r_.end(), 0.0);
    add_up(r_, for_each_term([&](const Part& part) {
               if (part.term->sees_clock) part.term->residual({moved, c.vectors, c.signals}, r_.data());
           }));
    for (int u = 0; u < n_; ++u) d[u] += factor * r_[u];
}

// The partial time derivative of the constraints at the end, by prescribed unknowns and functions of time,
// for which central differences are exact, as constraints are quadratic in them, and by the clock. Over a
// step of length h, so that their change is not lost in rounding.
void System::drift(const Context& c, double h, Unknowns& d) {
    constexpr double part = 0.1;  // of the step, for differences by the clock
    d.assign(n_ + 1, 0.0);
    if (any(std::any_of(terms_.begin(), terms_.end(), [](const Part& p) { return p.term->sees_clock; }))) {
        const double apart = part * h;
        for (const double way : {1.0, -1.0}) {
            add_later(c, way * apart, 8 * way / (12 * apart), d);
            add_later(c, 2 * way * apart, -way / (12 * apart), d);
        }
    }
    const bool moves =
        std::any_of(prescribed_.begin(), prescribed_.end(), [&](int u) { return v_next_[u] != 0; });
    const bool turns =
        std::any_of(c.signals.rate1, c.signals.rate1 + n_signals_, [](double s) { return s != 0; });
    if (!moves && !turns) return;
    std::vector<double> at1(n_signals_);
    const Signals moved{c.signals.at0, c.signals.ate, at1.data(), c.signals.rate1};
    const Unknowns x1 = x1_;
    const AtExit back([&] { x1_ = x1; });
    for (const double way : {h, -h}) {
        for (int u : prescribed_) x1_[u] = x1[u] + way * v_next_[u];
        for (std::size_t k = 0; k < n_signals_; ++k) at1[k] = c.signals.at1[k] + way * c.signals.rate1[k];
        evaluate_lasting({c.step, c.vectors, moved});
        for (int u = 0; u < n_; ++u) d[u] += 0.5 / way * r_[u];
    }
}

// (h/2) G_0^T lambda: half of what the multipliers add to the balance, times the step.
Unknowns System::constraint_impulse(const Context& c, const Unknowns& without) {
    evaluate_lasting(c);
    Unknowns impulse(n_);
    for (int u = 0; u < n_; ++u) impulse[u] = 0.5 * c.step.h * r_[u];
    x1_ = without;
    evaluate_lasting(c);
    for (int u = 0; u < n_; ++u) impulse[u] -= 0.5 * c.step.h * r_[u];
    return impulse;
}

// The right-hand side, as a residual, of the equations whose matrix is in `values_`; the share of this
// process.
void System::evaluate_rate_residual(const Unknowns& impulse, const Unknowns& change) {
    std::fill(r_.begin(), r_.end(), 0.0);
    for (int i = 0; i < csr_.n; ++i) {
        const int u = csr_.unknown[i];
        if (constraint_[u]) r_[u] = is_own(u) ? change[u] : 0.0;
        if (order_[u] == 0 || fixed_[u]) continue;
        r_[u] = is_own(u) ? -impulse[u] : 0.0;
        for (auto k = csr_.row[i]; k < csr_.row[i + 1]; ++k)
            if (const int v = csr_.unknown[csr_.col[k]]; order_[v] > 0) r_[u] -= values_[k] * v_next_[v];
    }
}

// G v at some place, by central differences over a step of length h, exact as constraints are quadratic.
std::vector<double> System::constraint_rates(const Context& c, double h, const Unknowns& at,
                                             const Unknowns& rates) {
    std::vector<double> found(drives_.size(), 0.0);
    const Unknowns x1 = x1_;
    const AtExit back([&] { x1_ = x1; });
    for (const double way : {h, -h}) {
        for (int u = 0; u < n_; ++u) x1_[u] = constraint_[u] ? 0.0 : at[u] + way * rates[u];
        evaluate_lasting(c);
        for (std::size_t k = 0; k < drives_.size(); ++k) found[k] += 0.5 / way * r_[drives_[k]];
    }
    return found;
}

// The work of what is driven by functions of time while rates change from v* to v1: that of its share of the
// impulses p - G^T mu along the mean of both rates. `rates` are those before.
void System::book_drives(const Context& c, const Context& end, const Unknowns& rates) {
    if (drives_.empty()) return;
    Unknowns mean(n_ + 1, 0.0);
    for (int u = 0; u < n_; ++u)
        if (order_[u] > 0 && !fixed_[u]) mean[u] = 0.5 * (rates[u] + v_next_[u]);
    const std::vector<double> at_end = constraint_rates(end, c.step.h, Unknowns(x1_), mean);
    for (std::size_t k = 0; k < drives_.size(); ++k) drive_work_[k] = -d_[drives_[k]] * at_end[k];
    if (c.step.theta_g != 0) return;
    const std::vector<double> at_start = constraint_rates(end, c.step.h, x, mean);
    for (std::size_t k = 0; k < drives_.size(); ++k)
        drive_work_[k] += 0.5 * c.step.h * x1_[drives_[k]] * at_start[k];
}

// The rates and multipliers at an instant at the end of a step.
bool System::solve_rates(const Context& c, const Context& instant) {
    const Unknowns x1 = x1_;
    Unknowns without = x1_, impulse(n_), change;
    for (int u = 0; u < n_; ++u)
        if (constraint_[u]) without[u] = 0;
    // parts of the kept tangent may be written anew in steps to come
    rate_values_.resize(values_.size());
    values_.swap(rate_values_);
    const AtExit back([&] { values_.swap(rate_values_), x1_ = x1; });
    if (c.step.theta_g == 0) impulse = constraint_impulse(c, without);
    x1_ = without;
    drift(instant, c.step.h, change);
    evaluate_rate_matrix(instant);
    evaluate_rate_residual(impulse, change);
    if (rate_rigid_ && solver_->report().n_redundant > 0) rate_rigid_->find_redundant(true);
    const Place end = place(instant.step);
    rate_solver_->forget();  // a restart has not seen the values of earlier steps
    return factor_by(*rate_solver_, instant.step) &&
           (rate_rigid_ ? rate_rigid_->solve_rates(r_.data(), end, d_.data())
                        : share(rate_solver_->solve(r_.data(), end, d_.data(), 0)));
}

// M a + G^T mu = -r, G a = -r at the present state: rates or accelerations and multipliers `a` from
// residuals.
bool System::solve_instant(const Step& now, const Signals& signals, const double* residual, double* a) {
    if (rate_revision_ != revision_) analyze_rates();
    const Unknowns x1 = x1_;
    std::copy_n(x.begin(), n_, x1_.begin());
    rate_values_.resize(values_.size());
    values_.swap(rate_values_);
    const AtExit back([&] { values_.swap(rate_values_), x1_ = x1, stale_begin_ = true; });
    const Step step = instant_after(now);
    const Vectors here{x1_.data(), x1_.data(), still_.data(), still_.data(), still_.data()};
    evaluate_rate_matrix({step, here, signals});
    for (int u = 0; u < n_; ++u) r_[u] = !fixed_[u] && (order_[u] > 0 || constraint_[u]) ? residual[u] : 0.0;
    if (rate_rigid_ && solver_->report().n_redundant > 0) rate_rigid_->find_redundant(true);
    rate_solver_->forget();
    if (!factor_by(*rate_solver_, step)) return false;
    const bool solved = rate_rigid_ ? rate_rigid_->solve_rates(r_.data(), place(step), d_.data())
                                    : solve_for(*rate_solver_, step, 0);
    for (int u = 0; u < n_; ++u) a[u] = fixed_[u] ? 0.0 : d_[u];
    return solved;
}

bool System::project_rates(const Context& c) {
    if (rate_revision_ != revision_) analyze_rates();
    const Step step = instant_after(c.step);
    const Vectors end_of_step{x1_.data(), x1_.data(), still_.data(), still_.data(), still_.data()};
    const Context instant{step, end_of_step, c.signals};
    if (!solve_rates(c, instant)) return false;
    const Unknowns rates = v_next_;
    take_rates(c.step);
    if (!c.step.uses_history()) book_drives(c, instant, rates);  // else in the multipliers
    return true;
}

// The projected rates, and with them the histories and multipliers of schemes that have some.
void System::take_rates(const Step& step) {
    const auto& t = step.motion;
    const bool remembers = step.uses_history();
    for (int u = 0; u < n_; ++u) {
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
