// What a restart needs beside the state: the predictor's history and where the kept factorisation was made.
// Looks that leave no trace restart the system as well, and bring back what else they may have changed.
#include "visviva/base/at_exit.hpp"
#include "visviva/system/system.hpp"

namespace visviva {

std::vector<double> System::memory() const {
    std::vector<double> m = {contraction_, noise_, static_cast<double>(iterations_last_),
                             stale_factor_ ? 1.0 : 0.0};
    const SolverSequence* sequence = solver_->capabilities().sequence;
    const std::vector<double> solver = sequence ? sequence->state() : std::vector<double>();
    m.insert(m.end(), solver.begin(), solver.end());
    predictor_.write(m);
    m.push_back(static_cast<double>(mean_.size()));
    m.insert(m.end(), mean_.begin(), mean_.end());
    for (const auto& [term, can] : terms_)
        if (can.memory) can.memory->write_memory(m);
    if (stale_factor_) return m;
    const Step& s = factored_;
    for (double value : {s.t0, s.t1, s.te, s.h, s.theta, s.theta_g, static_cast<double>(s.stress)})
        m.push_back(value);
    m.insert(m.end(), &s.motion[0][0], &s.motion[0][0] + 20);
    m.insert(m.end(), &s.transport[0][0], &s.transport[0][0] + 20);
    m.insert(m.end(), factored_state_.begin(), factored_state_.end());
    m.insert(m.end(), factored_signals_.begin(), factored_signals_.end());
    return m;
}

void System::restore(const std::vector<double>& memory) {
    recall(memory);
    mark_state();
}

void System::recall(const std::vector<double>& memory) {
    const double* m = memory.data();
    forget();
    const double contraction = m[0];
    const double noise = m[1];
    const int iterations_last = static_cast<int>(m[2]);
    const bool stale = m[3] != 0;
    SolverSequence* sequence = solver_->capabilities().sequence;
    std::vector<double> solver(m + 4, m + 4 + (sequence ? sequence->state().size() : 0));
    m = predictor_.read(m + 4 + solver.size());
    const auto n_mean = static_cast<std::size_t>(*m++);
    mean_.assign(m, m + n_mean), m += n_mean;
    bool changed = false;
    for (const auto& [term, can] : terms_)
        if (can.memory && can.memory->read_memory(m)) changed = true;
    if (changed) rewire();
    if (sequence) sequence->set_state(solver);
    solver_->forget();
    updated_ = false;
    if (!stale) {
        make_again(m);
        if (sequence) sequence->set_state(solver);  // making the factorisation again has counted
        stale_factor_ = false;
    }
    stale_begin_ = true;
    noise_ = noise, contraction_ = contraction, iterations_last_ = iterations_last;
}

// The kept factorisation, where it was made.
void System::make_again(const double* m) {
    Step s;
    s.t0 = m[0], s.t1 = m[1], s.te = m[2], s.h = m[3], s.theta = m[4], s.theta_g = m[5];
    s.stress = static_cast<Stress>(static_cast<int>(m[6]));
    std::copy(m + 7, m + 27, &s.motion[0][0]);
    std::copy(m + 27, m + 47, &s.transport[0][0]);
    m += 47;
    const std::vector<double> now[5] = {x, dx, v, a, w};
    const AtExit back([&] { x = now[0], dx = now[1], v = now[2], a = now[3], w = now[4]; });
    std::vector<std::vector<double>*> kept = {&x, &dx, &v};
    if (s.uses_history()) kept.insert(kept.end(), {&a, &w});
    for (auto* u : kept) {
        std::copy(m, m + u->size(), u->begin());
        m += u->size();
    }
    for (const auto& [term, can] : terms_) term->begin(x.data());
    set_base_rates(s);
    update_vectors(s);
    const std::size_t k = n_signals_;
    const Signals signals{m, m + k, m + 2 * k, m + 3 * k};
    refactor({s, {x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()}, signals}, s);
}

std::vector<std::any> System::evaluations() const {
    std::vector<std::any> all;
    all.reserve(terms_.size());
    for (const auto& [term, can] : terms_) all.push_back(can.memory ? can.memory->evaluation() : std::any());
    return all;
}

void System::restore_evaluations(const std::vector<std::any>& all) {
    for (std::size_t k = 0; k < all.size(); ++k)
        if (all[k].has_value()) terms_[k].can.memory->restore_evaluation(all[k]);
}

std::vector<std::vector<double>*> System::looked_at() {
    std::vector<std::vector<double>*> all = {&x, &dx, &v, &a, &w};
    all.insert(all.end(), {&x1_, &rate_, &second_rate_, &base_rate_, &base_second_, &r_});
    for (auto& u : last_) all.push_back(&u);
    for (auto& u : marked_) all.push_back(&u);
    return all;
}

Snapshot System::snapshot() {
    Snapshot s;
    for (const auto* u : looked_at()) s.vectors.push_back(*u);
    s.memory = memory(), s.evaluated = evaluations();
    s.accepted = accepted_, s.stale_begin = stale_begin_;
    return s;
}

void System::restore_snapshot(const Snapshot& s) {
    const auto vectors = looked_at();
    const auto bring_back = [&] {
        for (std::size_t k = 0; k < vectors.size(); ++k) *vectors[k] = s.vectors[k];
    };
    bring_back();
    accepted_ = s.accepted;
    recall(s.memory);
    bring_back();
    for (const auto& [term, can] : terms_)
        if (!s.stale_begin) term->begin(x.data());
    stale_begin_ = s.stale_begin;
    restore_evaluations(s.evaluated);
}

}  // namespace visviva
