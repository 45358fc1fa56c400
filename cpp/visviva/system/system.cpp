#include "visviva/system/system.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "visviva/base/aligned.hpp"
#include "visviva/base/at_exit.hpp"
#include "visviva/base/parallel.hpp"
#include "visviva/base/vector_dispatch.hpp"
#include "visviva/linear/asymmetry.hpp"
#include "visviva/linear/block_rows.hpp"
#include "visviva/term/pattern.hpp"

namespace visviva {

System::System(std::vector<int> order, std::vector<char> fixed, std::vector<double> scale,
               const std::vector<char>& flows)
    : n_(static_cast<int>(order.size())), order_(std::move(order)), fixed_(std::move(fixed)) {
    // One entry more than unknowns: element slots of nothing may point there.
    for (auto* u : {&x, &dx, &v, &a, &w, &x1_, &rate_, &second_rate_, &base_rate_, &base_second_, &r_,
                    &v_next_, &a_next_, &w_next_, &still_})
        *u = Unknowns(n_ + 1);
    d_.assign(n_ + 1, 0.0);
    for (int i = 0; i < n_; ++i)
        if (const bool flow = !flows.empty() && flows[i];
            segments_.empty() || segments_.back().order != order_[i] || segments_.back().flows != flow)
            segments_.push_back({i, i + 1, order_[i], flow});
        else
            segments_.back().end = i + 1;
    inverse_scale_.resize(n_);
    for (int i = 0; i < n_; ++i) inverse_scale_[i] = scale[i] > 0 && !fixed_[i] ? 1 / scale[i] : 0;
}

void System::finalize() {
    if (revision_ == 0) monotone_.resize(n_ + 1);
    needs_rates_ =
        std::any_of(terms_.begin(), terms_.end(), [](const Part& p) { return p.term->needs_rates; });
    constraint_weight_.assign(n_, 0.0);
    if (blocks_.multiplier.empty()) blocks_.multiplier.assign(n_, 0);
    n_fixed_ = static_cast<int>(std::count(fixed_.begin(), fixed_.end(), 1));
    if (node_.empty()) {
        node_.resize(n_);
        std::iota(node_.begin(), node_.end(), 0);
    }
    Pattern pattern(node_, fixed_);
    for (const auto& [term, can] : terms_) term->couple(pattern);
    if (processes_) pattern.leave_uncoupled();
    pattern.finish(csr_);
    meet();
    ++revision_;
    assign_with_room(values_, csr_.col.size() + 1, 0.0);  // the last one is for entries of fixed unknowns
    for (const auto& [term, can] : terms_) term->connect(pattern);
    std::vector<char> cleared(pattern.n_nodes(), 0);
    for (const auto& [term, can] : terms_)
        if (can.mesh) can.mesh->clear_rows(pattern, cleared);
    zeros_.clear();
    for (int u : csr_.unknown)
        if (const auto rows = pattern.rows(u); !cleared[rows.node]) {
            cleared[rows.node] = 1;
            zeros_.emplace_back(rows.begin, rows.end);
        }
    find_held(pattern);
    const Csr* left = &csr_;
    for (const auto& reduction : reductions_) {
        reduction->analyze(*left, fixed_, node_);
        left = &reduction->left();
    }
}

// Rows that terms on meshes do not set to zero themselves
void System::clear_values() {
    for (const auto& [begin, end] : zeros_) std::fill(values_.begin() + begin, values_.begin() + end, 0.0);
    values_.back() = 0;
}

// Fixed unknowns that share a node with free ones stay in the matrix: their rows and columns become those of
// the identity.
void System::find_held(const Pattern& pattern) {
    std::vector<char> is_held(csr_.n, 0);
    held_.clear(), held_zero_.clear(), held_one_.clear();
    for (int i : pattern.held()) is_held[i] = 1, held_.push_back(csr_.unknown[i]);
    for (int i = 0; i < csr_.n && !held_.empty(); ++i)
        for (auto k = csr_.row[i]; k < csr_.row[i + 1]; ++k) {
            const int j = csr_.col[k];
            if (is_held[i] && i == j)
                held_one_.push_back(k);
            else if (is_held[i] || is_held[j])
                held_zero_.push_back(k);
        }
}

void System::discard() {
    monotone_.discard();
    std::fill(dx.begin(), dx.end(), 0.0);
    restore_evaluations(accepted_);
}

// Prescribed unknowns are set from outside, directors turn, and a solver that keeps bodies rigid finds the
// multipliers for that.
void System::prepare_predictor() {
    std::vector<char> apart = fixed_;
    for (const RigidUnknowns& body : blocks_.rigid) {
        for (int k = 3; k < 12; ++k) apart[body.q[k]] = 1;
        for (int k = 0; rigid_ && k < 6; ++k) apart[body.multiplier[k]] = 1;
    }
    std::vector<int> coordinates, multipliers;
    std::vector<double> weight;
    for (int i = 0; i < n_; ++i) {
        if (apart[i]) continue;
        (order_[i] > 0 ? coordinates : multipliers).push_back(i);
        if (order_[i] > 0) weight.push_back(inverse_scale_[i]);
    }
    const bool moves = std::find(order_.begin(), order_.end(), 2) != order_.end();
    predictor_.resize(std::move(coordinates), std::move(weight), !any(moves), std::move(multipliers),
                      blocks_.rigid);
}

// The start of the iteration: motion extrapolated, prescribed unknowns as set. Cracks would grow by what
// motion goes too far where a load stops to grow, and balance there as well, with more energy.
void System::predict(const Step& step) {
    for (int i = 0; i < n_; ++i)
        if (!fixed_[i]) dx[i] = 0;
    if (!step.is_static()) predictor_.predict(step.h, x.data(), v.data(), !starts_still(step), dx.data());
    if (step.is_static() || !starts_still(step)) predictor_.predict_multipliers(step.h, dx.data());
    for (std::size_t k = 0; k < guessed_.size(); ++k)
        if (!fixed_[guessed_[k]]) dx[guessed_[k]] = guess_[k];
    guessed_.clear();
    set_base_rates(step);
}

// Zeros that are there already are not written: untouched they take no memory.
static void put(double value, double& place) {
    if (place != value) place = value;
}

void System::set_base_rates(const Step& step) {
    for (const Segment& s : segments_) {
        if (s.order == 0) continue;
        const auto& t = s.table(step);
        const bool history = t[0][2] != 0 || t[0][3] != 0 || t[1][2] != 0 || t[1][3] != 0;
        for (int i = s.begin; i < s.end; ++i) {
            put(t[0][1] * v[i], base_rate_[i]);
            put(t[1][1] * v[i], base_second_[i]);
        }
        for (int i = s.begin; history && i < s.end; ++i) {
            base_rate_[i] += t[0][2] * a[i] + t[0][3] * w[i];
            base_second_[i] += t[1][2] * a[i] + t[1][3] * w[i];
        }
    }
}

void System::update_vectors(const Step& step) {
    vector_kernels().affine(n_, 1.0, dx.data(), x.data(), x1_.data());
    update_rates(step);
}

void System::update_rates(const Step& step) {
    const VectorKernels& k = vector_kernels();
    for (const Segment& s : segments_) {
        if (s.order == 0) continue;
        const int i = s.begin, n = s.end - s.begin;
        const auto& t = s.table(step);
        const auto add = [&](double factor, const Unknowns& base, Unknowns& rate) {
            if (factor != 0) return k.affine(n, factor, &dx[i], &base[i], &rate[i]);
            for (int j = i; j < s.end; ++j) put(base[j], rate[j]);
        };
        if (needs_rates_) add(t[0][0], base_rate_, rate_);
        if (s.order == 2) add(t[1][0], base_second_, second_rate_);
    }
}

// Add the increment; its largest entry relative to the unknowns' scales.
double System::limit_correction() {
    double share = 1;
    for (const auto& [term, can] : terms_)
        if (can.limit) share = std::min(share, can.limit->share(x1_.data(), d_.data()));
    share = -largest(-share);
    for (int i = 0; share < 1 && i < n_; ++i) d_[i] *= share;
    return share;
}

double System::iterate(const Step& step) {
    const double size =
        vector_kernels().update(n_, d_.data(), inverse_scale_.data(), x.data(), dx.data(), x1_.data());
    update_rates(step);
    return size;
}

void System::evaluate_residual(const Context& c, bool all, bool with_mesh_tangents) {
    std::fill(r_.begin(), r_.end(), 0.0);
    if (with_mesh_tangents) clear_values(), stale_factor_ = true;
    add_up(r_, for_each_term([&](const Part& part) {
               const Lap lap(timed(part));
               if (with_mesh_tangents && part.can.mesh)
                   part.can.mesh->linearise(c, r_.data(), values_.data());
               else if (all || !part.term->is_rigidity)
                   part.term->residual(c, r_.data());
           }));
}

void System::evaluate_tangent(const Context& c, bool has_mesh_tangents) {
    stale_factor_ = true;  // until it is factorised
    if (!has_mesh_tangents) {
        clear_values();
    }
    std::exception_ptr first;
    for (const bool on_mesh : {true, false}) {
        const auto failure = for_each_term([&](const Part& part) {
            const Lap lap(timed(part));
            const bool is_due = part.can.mesh ? on_mesh && !has_mesh_tangents : !on_mesh;
            if (is_due) part.term->tangent(c, values_.data());
        });
        if (!first) first = failure;
    }
    if (first) std::rethrow_exception(first);
}

bool System::refactor(const Context& c, const Step& step, bool has_mesh_tangents) {
    const auto failure = attempt([&] {
        evaluate_tangent({c.step, c.vectors, c.signals, c.backwards, rigid_ != nullptr}, has_mesh_tangents);
    });
    agree(failure, any(failure != nullptr));
    for (auto k : held_zero_) values_[k] = 0;
    for (auto k : held_one_) values_[k] = 1;
    if (monotone_.any()) monotone_.release(r_.data(), diagonal().data(), csr_, [this](auto& v) { total(v); });
    monotone_.mask(csr_, values_.data());
    weigh_constraints();
    factored_ = step, factored_revision_ = revision_;
    factored_state_.clear();
    std::vector<const Unknowns*> kept = {&x, &dx, &v};
    if (step.uses_history()) kept.insert(kept.end(), {&a, &w});
    for (const auto* u : kept) factored_state_.insert(factored_state_.end(), u->begin(), u->end());
    factored_signals_.clear();
    for (const double* u : {c.signals.at0, c.signals.ate, c.signals.at1, c.signals.rate1})
        factored_signals_.insert(factored_signals_.end(), u, u + n_signals_);
    return factor(step);
}

// Of the tangent, by unknown.
std::vector<double> System::diagonal() const {
    std::vector<double> found(n_, 0.0);
    for (int i = 0; i < csr_.n; ++i)
        for (auto k = csr_.row[i]; k < csr_.row[i + 1]; ++k)
            if (csr_.col[k] == i) found[csr_.unknown[i]] = values_[k];
    total(found);
    return found;
}

bool System::factor(const Step& step) {
    const Lap lap(timed(&Phases::factorisation));
    return factor_by(*solver_, step);
}

// From the residual to the increment.
bool System::solve_increment(const Step& step, double tolerance) {
    const Lap lap(timed(&Phases::solution));
    const bool solved = solve_for(*solver_, step, tolerance);
    ++phases_.n_solutions, phases_.n_iterations += solver_->report().n_iterations;
    return solved;
}

// Size of the predicted step, or of the last where that predicts none, relative to the unknowns' scales; 1
// where nothing is known.
double System::extent(double h) const {
    double largest = 0;
    for (const Segment& s : segments_)
        if (s.order > 0)
            largest = std::max(
                largest, vector_kernels().largest(s.end - s.begin, &dx[s.begin], &inverse_scale_[s.begin]));
    if (largest == 0) largest = predictor_.largest(h);
    return largest > 0 ? largest : 1;
}

int System::worst() const {
    double largest = 0;
    int worst = -1;
    for (int i = 0; i < n_; ++i) {
        const double s = std::abs(d_[i]) * inverse_scale_[i];
        if (std::isnan(s)) return i;
        if (s > largest) largest = s, worst = i;
    }
    return worst;
}

Report System::accept(const Step& step, const Signals& signals, bool ledger) {
    monotone_.clip(dx.data());
    update_vectors(step);
    Report solved;
    solved.converged = true;
    return finish(std::move(solved), step, signals, ledger);
}

Report System::advance(const Step& step, const Signals& signals, const NewtonOptions& options) {
    Report report = solve(step, signals, options);
    return report.converged ? finish(std::move(report), step, signals, true) : report;
}

// Row k of the scheme's tables: rates or history at the end of the step. False where no unknown has any.
bool System::end_of_step(const Step& step, int k, const Unknowns& now, Unknowns& next) {
    auto used = [k](const double table[5][4]) {
        return std::any_of(table[k], table[k] + 4, [](double c) { return c != 0; });
    };
    if (!used(step.motion) && !used(step.transport) && !used(step.flow)) return false;
    std::copy(now.begin(), now.end(), next.begin());
    for (const Segment& s : segments_) {
        const auto& t = s.table(step);
        if (s.order == 0 || !used(t)) continue;
        for (int i = s.begin; i < s.end; ++i) next[i] = t[k][0] * dx[i] + t[k][1] * v[i];
        const bool history = t[k][2] != 0 || t[k][3] != 0;
        for (int i = s.begin; history && i < s.end; ++i) next[i] += t[k][2] * a[i] + t[k][3] * w[i];
    }
    return true;
}

// Midpoint rules turn velocities about the mean of the step: what is wrong in them swings for good.
void System::record_mean(const Step& step) {
    mean_.clear();
    if (step.motion[2][1] != -1 || step.h <= 0) return;
    mean_.assign(dx.begin(), dx.end());
    for (double& rate : mean_) rate /= step.h;
}

Report System::finish(Report report, const Step& step, const Signals& signals, bool ledger) {
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    const Context context{step, vectors, signals};
    const bool new_v = end_of_step(step, 2, v, v_next_), new_a = end_of_step(step, 3, a, a_next_),
               new_w = end_of_step(step, 4, w, w_next_);
    if (step.begins_transport() && !entropy_.unknown.empty()) take_off_excess(context);
    stale_begin_ = true;
    drive_work_.assign(drives_.size(), 0.0);
    if (step.projects_rates && projects_rates() && !project_rates(context))
        return failed(std::move(report),
                      "no rates satisfy the constraints at the end of the step, where what constraints alone "
                      "hold needs mass (give it some, or take EnergyMomentum() or BDF2())",
                      rate_solver_->report().singular_unknown);
    // Functions from outside may throw in here; the accepted state is still the old one then.
    const bool path = ledger && step.balances_ends();
    {
        const Lap lap(timed(&Phases::ledger));
        if (ledger)
            book_step(context, step.is_static() ? still_.data() : new_v ? v_next_.data() : v.data(), 1);
        if (path) book_path(context);
    }
    for (std::size_t k = 0; ledger && k < drives_.size(); ++k) sums.work[drive_account_[k]] += drive_work_[k];
    const auto failure = attempt([&] {
        for (const bool from_outside : {true, false})  // no term accepts what another one refuses
            for (const auto& [term, can] : terms_)
                if (term->sees_clock == from_outside) term->accept(context);
    });
    agree(failure, any(failure != nullptr));
    predictor_.record(x.data(), dx.data(), step.h);
    last_[0] = x, last_[1] = dx, last_[2] = v;
    last_[3].clear(), last_[4].clear();
    record_mean(step);
    if (new_a) last_[3] = a;
    if (new_w) last_[4] = w;
    if (new_v) std::copy(v_next_.begin(), v_next_.end(), v.begin());
    if (new_a) std::copy(a_next_.begin(), a_next_.end(), a.begin());
    if (new_w) std::copy(w_next_.begin(), w_next_.end(), w.begin());
    std::copy(x1_.begin(), x1_.end(), x.begin());
    for (const auto& [term, can] : terms_) term->finish_step(step, x.data());
    std::fill(dx.begin(), dx.end(), 0.0);
    accepted_ = evaluations();
    mark_state();
    stale_begin_ = !ledger || path;  // booking leaves the terms at the end of the step
    monotone_.accept();
    return report;
}

int System::find_redundant(const Step& step, const Signals& signals, bool on) {
    if (rigid_) rigid_->find_redundant(on);
    stale_factor_ = true;
    if (!on) return 0;
    std::vector<double> residual(n_);
    assemble(step, signals, residual.data(), nullptr);
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    return refactor({step, vectors, signals}, step) ? solver_->report().n_redundant : -1;
}

void System::forces(const Step& step, const Signals& signals, double* residual) {
    if (last_[0].empty()) throw std::logic_error("no step was taken yet");
    const std::vector<std::any> evaluated = evaluations();
    restore_evaluations(accepted_);  // those of the step, and not of looks or failed steps since then
    const auto exchange = [&] {
        x.swap(last_[0]), dx.swap(last_[1]), v.swap(last_[2]);
        if (!last_[3].empty()) a.swap(last_[3]);
        if (!last_[4].empty()) w.swap(last_[4]);
    };
    const std::vector<double> known = histories();
    exchange(), return_to(Past::step);
    const AtExit back([&] {
        exchange(), restore_histories(known), restore_evaluations(evaluated);
        stale_begin_ = true;
    });
    assemble(step, signals, residual, nullptr);
}

void System::evaluate(const Step& step, const Signals& signals, bool with_mesh_tangents) {
    for (const auto& [term, can] : terms_) term->begin(x.data());
    stale_begin_ = false;
    set_base_rates(step);
    update_vectors(step);
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    evaluate_residual({step, vectors, signals}, true, with_mesh_tangents);
}

void System::assemble(const Step& step, const Signals& signals, double* residual, double* values) {
    // A solver may have those of its own tangent from where they are.
    std::vector<double> looked_at;
    const bool apart = values && !factored_state_.empty();
    if (apart) looked_at.resize(values_.size()), values_.swap(looked_at);
    const AtExit back([&] {
        if (apart) values_.swap(looked_at);
    });
    evaluate(step, signals, values != nullptr);
    std::copy(r_.begin(), r_.begin() + n_, residual);
    if (!values) return;
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    evaluate_tangent({step, vectors, signals}, true);
    std::copy(values_.begin(), values_.end() - 1, values);
}

double System::asymmetry() const {
    return visviva::asymmetry(csr_.row, csr_.col, {values_.data(), csr_.col.size()}).size;
}

}  // namespace visviva
