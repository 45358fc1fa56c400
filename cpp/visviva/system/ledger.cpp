// Contribution of a step to the ledger: energies, works, momenta, defects, and the losses of impacts.
#include <algorithm>
#include <limits>
#include <numeric>

#include "visviva/system/system.hpp"

namespace visviva {

void System::set_accounts(int n_accounts, int n_components, std::vector<char> of_heat) {
    heat_account_ = std::move(of_heat), heat_account_.resize(n_accounts);
    sums.energy.assign(n_accounts, 0.0), sums.work.assign(n_accounts, 0.0);
    sums.momentum.assign(6 * static_cast<std::size_t>(n_components), 0.0);
    sums.defect.assign(2 * static_cast<std::size_t>(n_components), 0.0);
    sums.release.assign(n_, 0.0);
    sums.entropy.assign(n_accounts, 0.0);
}

void System::clear_sums() {
    for (auto* s : {&sums.energy, &sums.work, &sums.momentum, &sums.defect, &sums.release, &sums.entropy})
        std::fill(s->begin(), s->end(), 0.0);
    sums.impacts.clear();
}

// In a step with an impact dissipating schemes take a part of the kinetic energy that does not vanish with
// its length: it is lost by the impact, with what other forces and constraints do as the velocities jump.
void System::book_impacts(const Context& c, const double* v1) {
    if (island_.empty() || !searching(!sums.impacts.empty())) return;
    const std::size_t n_accounts = sums.work.size(), n = static_cast<std::size_t>(n_);
    // pressed by account, what is hit by island, and what was booked
    std::vector<double> known(n_accounts + n + 1, 0.0), momentum(n + 1, 0.0);
    for (const Impact& i : sums.impacts) {
        for (int u : i.unknowns) known[n_accounts + island_[u]] = 1;
        known[i.account] += i.pressed, known.back() += i.pressed + i.rubbed;
    }
    total(known);
    const double *pressed = known.data(), *hit = pressed + n_accounts;
    const double all = std::accumulate(pressed, hit, 0.0);
    if (all <= 0) return;
    std::vector<double> jump(n + 1, 0.0);
    for (int u = 0; u < n_; ++u)
        if (order_[u] == 2 && hit[island_[u]] > 0) jump[u] = v1[u] - v[u];
    const Vectors vectors{x.data(), x1_.data(), still_.data(), jump.data(), still_.data()};
    add_up(momentum, attempt([&] {
               for (const auto& [term, can] : terms_)
                   if (term->is_inertia) term->residual({c.step, vectors, c.signals}, momentum.data());
           }));
    double lost = 0;
    for (int u = 0; u < n_; ++u) lost += 0.5 * jump[u] * momentum[u];
    for (std::size_t k = 0; k < constraint_account_.size(); ++k)
        if (hit[account_island_[k]] > 0) lost -= sums.work[constraint_account_[k]];
    for (std::size_t k = 0; k < n_accounts; ++k) sums.work[k] -= (lost - known.back()) * pressed[k] / all;
}

void System::book(const Context& c, const double* v1) {
    clear_sums();
    add_up(sums, for_each_term([&](const Part& part) { part.term->ledger(c, v1, sums); }));
}

// Entropy by account: what equations that balance it get of every term, less what is stored.
std::vector<double> System::brought_entropy(const Context& c) {
    std::vector<double> brought(sums.entropy.size(), 0.0), r(n_, 0.0);
    if (c.step.h == 0 || c.step.transport[0][0] == 0) return brought;
    for (const auto& [term, can] : terms_) {
        if (term->entropy_account < 0) continue;
        for (int u : entropy_.tested) r[u] = 0;
        term->residual(c, r.data());
        for (int u : entropy_.tested) brought[term->entropy_account] -= c.step.h * r[u];
    }
    total(brought);
    for (std::size_t k = 0; k < entropy_.unknown.size(); ++k)
        if (entropy_.account[k] >= 0)
            brought[entropy_.account[k]] +=
                c.step.h * entropy_.weight[k] * c.vectors.rate[entropy_.unknown[k]];
    return brought;
}

// Rates with which a first step ends are those that balance there: without the entropy into which its excess
// of energy goes, see PointElement::find_excess. A history, of which nothing counts, leaves that out.
void System::take_off_excess(const Context& c) {
    Step plain = c.step;
    plain.transport[0][2] = std::numeric_limits<double>::min();
    evaluate_residual({plain, c.vectors, c.signals}, true);
    const Unknowns without = r_;
    evaluate_residual(c, true);
    std::vector<char> tested(n_, 0);
    for (int u : entropy_.tested) tested[u] = 1;
    for (std::size_t k = 0; k < entropy_.unknown.size(); ++k) {
        const int u = entropy_.unknown[k];
        if (!tested[u] || entropy_.light[k]) continue;  // slopes across a shell, whose sum is none
        const double more = (r_[u] - without[u]) / entropy_.weight[k];
        for (auto* next : {&v_next_, &a_next_, &w_next_}) (*next)[u] += more;
    }
}

// The same with the work of prescribed motion, which goes along dx or against it.
void System::book_step(const Context& c, const double* v1, double direction) {
    // before the terms go on to the end; on the way back they find their branches there
    if (!prescribed_.empty() || c.backwards) evaluate_residual(c, true);
    std::vector<double> entropy;
    if (!entropy_.tested.empty()) entropy = brought_entropy(c);
    book(c, v1);
    if (!entropy.empty()) sums.entropy = std::move(entropy);
    book_impacts(c, v1);
    for (std::size_t k = 0; k < prescribed_.size(); ++k) {
        const int u = prescribed_[k];
        const double h = c.step.h, *x0 = c.vectors.x0, *x1 = c.vectors.x1;
        const double through = supply_[k] == Supply::work    ? direction * dx[u]
                               : supply_[k] == Supply::power ? h * (x0[u] + c.step.theta * (x1[u] - x0[u]))
                                                             : h;
        sums.work[prescribed_account_[k]] += r_[u] * through;
    }
}

// Statics and schemes with a history balance forces at the end of a step alone, and loads and drives do work
// all along it. Forces at its beginning are those at the end of the step backwards: half of the work there
// and half of the work back, taken off, is the trapezoidal rule along the path.
void System::book_path(const Context& c) {
    LedgerSums there = sums;
    Step back = c.step;
    back.t0 = c.step.t1, back.t1 = back.te = c.step.t0, back.h = -c.step.h;
    const bool moves = c.step.uses_history();
    const Vectors vectors{c.vectors.x1, c.vectors.x0, moves ? v.data() : c.vectors.rate,
                          moves ? w.data() : c.vectors.second_rate, c.vectors.v0};
    const Signals signals{c.signals.at1, c.signals.at0, c.signals.at0, c.signals.rate1};
    for (const auto& [term, can] : terms_) term->begin(c.vectors.x1);
    book_step({back, vectors, signals, true}, still_.data(), -1);
    // What fields of order 1 take in a first step is what flows at its end: at its start that may be
    // anything.
    const bool begins = c.step.begins_transport();
    for (std::size_t k = 0; k < there.work.size(); ++k) {
        if (!(begins && heat_account_[k])) there.work[k] = 0.5 * (there.work[k] - sums.work[k]);
        if (!begins) there.entropy[k] = 0.5 * (there.entropy[k] - sums.entropy[k]);
    }
    // Where a run starts out of equilibrium, what held it there is let go in the first step, and does work.
    for (int i = 0; i < n_; ++i) there.release[i] = fixed_[i] ? 0.0 : 0.5 * r_[i] * dx[i];
    sums = std::move(there);
}

void System::evaluate_ledger(const Step& step, const Signals& signals, bool moves) {
    std::fill(dx.begin(), dx.end(), 0.0);
    for (const auto& [term, can] : terms_) term->begin(x.data());
    stale_begin_ = false;
    update_vectors(step);
    const Vectors vectors{x.data(), x1_.data(), v.data(), a.data(), v.data()};
    book({step, vectors, signals}, moves ? v.data() : still_.data());
}

std::vector<double> System::trial_energies(const Step& step, const Signals& signals) {
    update_vectors(step);
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    LedgerSums kept = sums;
    book({step, vectors, signals}, still_.data());
    std::swap(sums, kept);
    return kept.energy;
}

}  // namespace visviva
