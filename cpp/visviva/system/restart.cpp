// Restart data beside the state: the predictor's history and where the kept factorisation was made.
// Looks that leave no trace restart the system as well, and bring back what else they may have changed.
#include "visviva/base/at_exit.hpp"
#include "visviva/system/system.hpp"

namespace visviva {

// The kept factorisation can be missing.
static const std::string tangent_name = "tangent";
static constexpr int tangent_version = 2;
// Looks keep the predictor itself.
static const std::string predictor_name = "predictor";

// Terms are told apart by their place.
std::string System::memory_name(std::size_t term) const {
    return terms_[term].can.memory->record_name + " " + std::to_string(term);
}

std::vector<Record> System::memory() const {
    std::vector<Record> all = memory_of_parts();
    predictor_.write(all.emplace_back(Record{predictor_name, 1, {}}).numbers);
    return all;
}

std::vector<Record> System::memory_of_parts() const {
    std::vector<Record> all;
    all.push_back({"iterations",
                   2,
                   {contraction_, contraction_of_forces_, noise_, static_cast<double>(iterations_last_)}});
    if (const SolverSequence* sequence = solver_->capabilities().sequence)
        all.push_back({"solver", 1, sequence->state()});
    all.push_back({"mean rates", 1, mean_});
    if (monotone_.any()) all.push_back({"monotone", 1, monotone_.flags()});
    for (std::size_t k = 0; k < terms_.size(); ++k)
        if (const TermMemory* term = terms_[k].can.memory)
            term->write_memory(all.emplace_back(Record{memory_name(k), term->record_version, {}}).numbers);
    if (!stale_factor_) all.push_back(tangent_record());
    return all;
}

Record System::tangent_record() const {
    Record tangent{tangent_name, tangent_version, {}};
    std::vector<double>& m = tangent.numbers;
    const Step& s = factored_;
    for (double value : {s.t0, s.t1, s.te, s.h, s.theta, s.theta_g, static_cast<double>(s.stress)})
        m.push_back(value);
    m.insert(m.end(), &s.motion[0][0], &s.motion[0][0] + 20);
    m.insert(m.end(), &s.transport[0][0], &s.transport[0][0] + 20);
    m.insert(m.end(), &s.flow[0][0], &s.flow[0][0] + 20);
    m.insert(m.end(), factored_state_.begin(), factored_state_.end());
    m.insert(m.end(), factored_signals_.begin(), factored_signals_.end());
    return tangent;
}

// Before anything is changed.
void System::refuse_unknown(const std::vector<Record>& memory) const {
    std::vector<Record> own = this->memory();
    if (!record_named(own, tangent_name)) own.push_back({tangent_name, tangent_version, {}});
    for (const Record& record : memory) {
        const Record* known = record_named(own, record.name);
        if (!known || !are_alike(*known, record))
            throw std::invalid_argument("the record " + record.titled() + " is unknown to this system");
    }
    for (const Record& record : own)
        if (record.name != tangent_name && !record_named(memory, record.name))
            throw std::invalid_argument("the record " + record.titled() + " is missing");
    if (const Record* iterations = record_named(memory, "iterations"))
        iterations->end(iterations->numbers.data() + 4);
}

// Records of the terms alone.
std::vector<double> System::histories() const {
    std::vector<double> m;
    for (const auto& [term, can] : terms_)
        if (can.history) can.history->write_history(m);
    return m;
}

void System::restore_histories(const std::vector<double>& histories) {
    const double* m = histories.data();
    for (const auto& [term, can] : terms_)
        if (can.history) can.history->read_history(m);
}

void System::return_to(Past past) {
    for (const auto& [term, can] : terms_)
        if (can.history) can.history->return_to(past);
}

void System::restore(const std::vector<Record>& memory) {
    refuse_unknown(memory);
    recall(memory);
    mark_state();
}

void System::recall(const std::vector<Record>& memory) {
    forget();
    const std::vector<double>& iterations = record_named(memory, "iterations")->numbers;
    SolverSequence* sequence = solver_->capabilities().sequence;
    const std::vector<double> solver =
        sequence ? record_named(memory, "solver")->numbers : std::vector<double>();
    if (const Record* predictor = record_named(memory, predictor_name))
        predictor->end(predictor_.read(predictor->numbers.data()));
    mean_ = record_named(memory, "mean rates")->numbers;
    if (monotone_.any()) monotone_.set_flags(record_named(memory, "monotone")->numbers);
    bool changed = false;
    for (std::size_t k = 0; k < terms_.size(); ++k) {
        if (!terms_[k].can.memory) continue;
        const Record& record = *record_named(memory, memory_name(k));
        const double* m = record.numbers.data();
        if (terms_[k].can.memory->read_memory(m)) changed = true;
        record.end(m);
    }
    if (searching(changed)) rewire();
    if (sequence) sequence->set_state(solver);
    solver_->forget();
    updated_ = false;
    if (const Record* tangent = record_named(memory, tangent_name)) {
        make_again(*tangent);
        if (sequence) sequence->set_state(solver);  // making the factorisation again has counted
        stale_factor_ = false;
    }
    stale_begin_ = true;
    contraction_ = iterations[0], contraction_of_forces_ = iterations[1], noise_ = iterations[2];
    iterations_last_ = static_cast<int>(iterations[3]);
}

// The kept factorisation, where it was made.
void System::make_again(const Record& tangent) {
    const double* m = tangent.numbers.data();
    Step s;
    s.t0 = m[0], s.t1 = m[1], s.te = m[2], s.h = m[3], s.theta = m[4], s.theta_g = m[5];
    s.stress = static_cast<Stress>(static_cast<int>(m[6]));
    std::copy(m + 7, m + 27, &s.motion[0][0]);
    std::copy(m + 27, m + 47, &s.transport[0][0]);
    std::copy(m + 47, m + 67, &s.flow[0][0]);
    m += 67;
    const Unknowns now[5] = {x, dx, v, a, w};
    const std::vector<double> known = histories();
    return_to(Past::tangent);
    const AtExit back([&] {
        x = now[0], dx = now[1], v = now[2], a = now[3], w = now[4];
        restore_histories(known);
    });
    std::vector<Unknowns*> kept = {&x, &dx, &v};
    if (s.uses_history()) kept.insert(kept.end(), {&a, &w});
    for (auto* u : kept) {
        std::copy(m, m + u->size(), u->begin());
        m += u->size();
    }
    for (const auto& [term, can] : terms_) term->begin(x.data());
    set_base_rates(s);
    update_vectors(s);
    const std::size_t k = n_signals_;
    tangent.end(m + 4 * k);
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

std::vector<Unknowns*> System::looked_at() {
    std::vector<Unknowns*> all = {&x, &dx, &v, &a, &w};
    all.insert(all.end(), {&x1_, &rate_, &second_rate_, &base_rate_, &base_second_, &r_});
    for (auto& u : last_) all.push_back(&u);
    for (auto& u : marked_) all.push_back(&u);
    return all;
}

Snapshot System::snapshot() {
    Snapshot s;
    for (const auto* u : looked_at()) s.vectors.emplace_back(*u);
    s.predictor = predictor_;
    s.memory = memory_of_parts(), s.evaluated = evaluations();
    s.accepted = accepted_, s.stale_begin = stale_begin_;
    return s;
}

void System::restore_snapshot(const Snapshot& s) {
    const auto vectors = looked_at();
    const auto bring_back = [&] {
        for (std::size_t k = 0; k < vectors.size(); ++k) s.vectors[k].bring_back(*vectors[k]);
    };
    bring_back();
    accepted_ = s.accepted;
    recall(s.memory);
    predictor_ = s.predictor;
    bring_back();
    for (const auto& [term, can] : terms_)
        if (!s.stale_begin) term->begin(x.data());
    stale_begin_ = s.stale_begin;
    restore_evaluations(s.evaluated);
}

}  // namespace visviva
