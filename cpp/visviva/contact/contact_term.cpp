#include "visviva/contact/contact_term.hpp"

#include <algorithm>
#include <cmath>

#include "visviva/base/parallel.hpp"
#include "visviva/base/stopwatch.hpp"

namespace visviva {

namespace {

// Part of the reach by which the end of a step may move until stencils are made again.
constexpr double moved = 0.03;

}  // namespace

ContactTerm::ContactTerm(std::shared_ptr<Gaps> gaps, ContactOptions options, double reach)
    : TermMemory("contact", 5),
      gaps_(std::move(gaps)),
      options_(std::move(options)),
      search_(reach),
      active_(gaps_->n()),
      scatter_(gaps_, options_.multiplier, options_.friction.multiplier) {
    is_lasting = false, is_rigid_pair_ = is_rigid_pair();
    const std::size_t n = gaps_->n();
    for (auto* a : {&gap0_, &area0_, &gap1_, &area1_, &gapt_, &rate0_, &S_, &dS_gap_, &R_}) a->assign(n, 0.0);
    for (auto* a : {&slips_, &slips_at_tangent_, &covered_}) a->assign(n, 0);
    if (has_multipliers()) gaps_->keep_sides();
    if (rebounds()) landings_.resize(gaps_->skin().constant.size(), n, in_flight);
    if (sags()) pressed_.resize(gaps_->skin().constant.size(), n, 0);
    at_start_.resize(n), at_theta_.resize(n), at_end_.resize(n), masses_.resize(n);
    if (!has_friction()) return;
    const Eigen::Vector2d none = Eigen::Vector2d::Zero();
    grips_.resize(n), traction_.resize(n), base_.assign(n, none), free_.assign(n, none);
    carried_.assign(n, 0.0), rests_.assign(n, 0);
    if (keeps_slides()) slid_.resize(gaps_->skin().constant.size(), n, 0);
    elastic_.resize(gaps_->skin().constant.size(), 2 * n, 0.0), stored_.assign(n, 0.0);
}

void ContactTerm::couple(Pattern& pattern) const { scatter_.couple(pattern); }
void ContactTerm::connect(const Pattern& pattern) { scatter_.connect(pattern); }

bool ContactTerm::find_neighbours(const Way& way) {
    const Stopwatch watch(costs_.search);
    active_.begin_step();
    gaps_->skin().positions(way.x0, X0_), gaps_->skin().positions(way.x1, X1_);
    bool changed = false;
    if (search_.is_due(X0_) || search_.is_due(X1_)) {
        known_.clear(), forget_gradients();
        changed = search_.find_neighbours(*gaps_, X0_, X1_);
    }
    narrow();
    if (way.h > 0) note_attempt(way.h);
    return changed;
}

void ContactTerm::note_attempt(double h) {
    retried_ = h < tried_ && X0_ == tried_at_;
    if (!retried_) tried_ = h, tried_at_ = X0_;
}

// Stencils for the present step.
void ContactTerm::narrow() {
    if (gaps_->narrow(X0_.data(), X1_.data())) forget_gradients();
    narrowed_ = X1_;
}

void ContactTerm::write_memory(std::vector<double>& m) const {
    active_.write(m);
    m.push_back((pushed_out_ ? 1 : 0) + (is_balance_ ? 2 : 0));
    search_.write(m);
    gaps_->write_memory(m);
    if (rebounds()) landings_.write(m);
    if (sags()) pressed_.write(m);
    if (keeps_slides()) slid_.write(m);
    if (has_history()) elastic_.write(m);
    if (!has_multipliers()) m.push_back(let_go_);
    if (piercing_) piercing_->write(m);
}

bool ContactTerm::read_memory(const double*& m) {
    active_.read(m);
    const int before = static_cast<int>(*m++);
    pushed_out_ = before % 2 == 1, is_balance_ = before >= 2;
    forget_gradients(), known_.clear();
    gaps_->set_static(is_balance_);
    const bool changed = search_.read(m, *gaps_);
    gaps_->read_memory(m);
    if (rebounds()) landings_.read(m);
    if (sags()) pressed_.read(m);
    if (keeps_slides()) slid_.read(m);
    if (has_history()) elastic_.read(m);
    if (!has_multipliers()) let_go_ = *m++;
    if (piercing_) piercing_->read(m);
    return changed;
}

std::any ContactTerm::evaluation() const {
    return Evaluation{S_,     gap1_,  area1_,   forces_, friction_forces_, active_.flags(),
                      slips_, grips_, traction_};
}

void ContactTerm::restore_evaluation(const std::any& kept) {
    const auto& e = std::any_cast<const Evaluation&>(kept);
    S_ = e.S, gap1_ = e.gap1, area1_ = e.area1, forces_ = e.forces, friction_forces_ = e.friction_forces;
    active_.set_flags(e.active), slips_ = e.slips, grips_ = e.grips, traction_ = e.traction;
    known_.clear();
}

void ContactTerm::begin(const double* x0) {
    active_.begin_step(), known_at_.clear();
    gaps_->covers().begin(x0);
    gaps_->skin().positions(x0, X0_);
    settle();
    if (X0_ == known_) {
        gap0_ = gap1_, area0_ = area1_;
    } else {
        const Stopwatch watch(costs_.segments);
        gaps_->values(X0_.data(), gap0_.data(), area0_.data());
    }
    if (sags()) pressed_.begin_step(X0_);
    if (lies_beside()) find_sags();
    if (rebounds()) landings_.begin_step(X0_);
    if (keeps_slides()) slid_.begin_step(X0_);
    if (has_history()) elastic_.begin_step(X0_);
}

// Where the step begins as deep as they are, or as the pressure that a penalty had in the last step makes
// them, where steps are longer than bodies swing.
void ContactTerm::find_sags() {
    const Stopwatch watch(costs_.segments);
    std::vector<double> pressed(gaps_->n(), 0.0);
    for (int A = 0; sags() && A < gaps_->n(); ++A)
        pressed[A] = pressed_.at_start()[A] / options_.stiffness[A];
    sags_->start = sags_at(X0_, gap0_, area0_, pressed);
    sags_->landing = {}, landed_in_ = 0;
}

// Of rigid bodies, along the force on the first one.
Sags ContactTerm::sags_at(const std::vector<double>& X, const std::vector<double>& gap,
                          const std::vector<double>& area, const std::vector<double>& pressed) {
    Sags found;
    std::vector<char> closed(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A)
        closed[A] = area[A] > 0 && (gap[A] < 0 || pressed[A] > 0 || gaps_->offset(A) > 0);
    std::vector<Gap> gaps(gaps_->n());
    gaps_->gradients(X.data(), closed, gaps);
    for (int A = 0; A < gaps_->n(); ++A) {
        if (!closed[A]) continue;
        const auto& stencil = gaps_->stencil(A);
        Eigen::Vector3d push = Eigen::Vector3d::Zero();
        for (std::size_t v = 0; v < stencil.size(); ++v)
            if (stencil[v] < gaps_->n_first())
                push += Eigen::Map<const Eigen::Vector3d>(&gaps[A].gradient[3 * v]);
        found.add(push, gaps_->offset(A) + std::max(-gap[A], pressed[A]) / area[A]);
    }
    return found;
}

// As deep as bodies would be at the end if they went on as they came, over what they are where the step
// begins.
void ContactTerm::find_landing(const Context& c) {
    landed_in_ = c.step.h;
    std::vector<double> along, gap = gap0_, none(gaps_->n(), 0.0);
    gaps_->skin().increments(c.vectors.v0, along);
    std::vector<char> near(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A) near[A] = area0_[A] > 0;
    std::vector<Gap> gaps(gaps_->n());
    gaps_->gradients(X0_.data(), near, gaps);
    for (int A = 0; A < gaps_->n(); ++A)
        if (near[A]) gap[A] += c.step.h * as_vector(gaps[A].gradient).dot(stencil_of(A, along));
    sags_->landing = sags_at(X0_, gap, area0_, none);
}

// Once all contacts have begun the step.
void ContactTerm::share_sags() {
    shared_sags_ = X0_;
    Sags all;
    for (const auto& other : fellows_) all.add(other->start);
    if (gaps_->lie(std::move(all))) known_.clear(), forget_gradients();
}

void ContactTerm::settle() {
    const Stopwatch watch(costs_.segments);
    const bool other = beside_ && gaps_->set_flush(beside_->gaps_->flush());
    const bool changed = gaps_->settle(X0_.data()) || other;
    // over what covers others gaps go by where steps begin
    if (changed || gaps_->covers().has_any()) known_.clear(), forget_gradients();
}

void ContactTerm::find_gaps() {
    if (X1_ == known_) return;
    segments([&] { gaps_->values(X1_.data(), gap1_.data(), area1_.data()); });
    if (lies_beside() && sags())
        segments([&] { sags_->end = sags_at(X1_, gap1_, area1_, std::vector<double>(gaps_->n(), 0.0)); });
    known_ = X1_;
}

// Line searches and books come back to where gradients are known.
void ContactTerm::find_gradients() {
    if (known_at_ == Xt_ && known_of_ == active_.flags()) return;
    segments([&] { gaps_->gradients(Xt_.data(), active_.flags(), at_theta_); });
    known_at_ = Xt_, known_of_ = active_.flags();
}

void ContactTerm::evaluate(const Context& c, bool chooses, bool gradients) {
    const Skin& skin = gaps_->skin();
    skin.positions(c.vectors.x0, X0_), skin.positions(c.vectors.x1, X1_);
    bool stays = narrowed_.size() == X1_.size();
    for (std::size_t i = 0; stays && i < X1_.size(); ++i)
        stays = std::abs(X1_[i] - narrowed_[i]) < moved * search_.reach();
    if (!stays) narrow();
    const bool exact = !has_multipliers() && is_discrete(c.step) && !c.step.is_static();
    // looks see gaps as the step before them did
    if (std::abs(c.step.h) > Step::no_length) is_balance_ = c.step.is_static();
    const bool starts = gaps_->set_static(is_balance_);
    if (gaps_->set_exact(exact) || starts) {
        known_.clear(), forget_gradients();
        // a balance holds nothing in valleys
        segments([&] { gaps_->values(X0_.data(), gap0_.data(), area0_.data()); });
    }
    if (lies_beside() && X0_ != shared_sags_) share_sags();
    if (lies_beside() && sags() && !c.step.is_static() && c.step.h != landed_in_) find_landing(c);
    find_gaps();
    // Also with multipliers: what was closed at the start and opens, or slides on, has no multiplier at the
    // end to take the other half of its impulse there, as lasting constraints have (rates.cpp), and the whole
    // of it at the start would have a lever of half the increment.
    const double t = c.step.theta;
    Xt_.resize(X0_.size()), D_.resize(X0_.size());
    for (std::size_t i = 0; i < X0_.size(); ++i)
        Xt_[i] = (1 - t) * X0_[i] + t * X1_[i], D_[i] = X1_[i] - X0_[i];
    const bool at_theta = !has_multipliers() && !is_discrete(c.step);
    std::vector<double> area(gap1_.size());
    if (at_theta) segments([&] { gaps_->values(Xt_.data(), gapt_.data(), area.data()); });
    if (rebounds() && holds(c)) find_rates(c);
    if (chooses && has_multipliers()) update_active_set(c);
    for (int A = 0; A < gaps_->n(); ++A) press(A, c, gapt_[A]);
    if (is_discrete(c.step)) segments([&] { find_masses(gradients); });
    if (!has_friction()) return;
    find_resting(c);
    find_rubbed(c);
    segments([&] { gaps_->grips(Xr_.data(), active_.flags(), gradients, grips_); });
    parallel_for(gaps_->n(), [&](int A) { find_traction(A, c); });
}

void ContactTerm::residual(const Context& c, double* r) {
    const Stopwatch watch(costs_.forces);
    evaluate(c, true);
    if (c.step.is_static()) find_roaming();
    unsettled_gaps_.clear();
    for (int A = 0; A < gaps_->n(); ++A)
        if (active_.is_outdated(A) || slips_[A] != slips_at_tangent_[A]) unsettled_gaps_.push_back(A);
    find_gradients();
    Eigen::VectorXd f;
    for (int A = 0; A < gaps_->n(); ++A) {
        if (has_multipliers()) r[options_.multiplier[A]] += R_[A];
        for (int i = 0; i < scatter_.n_tangential(); ++i)
            r[options_.friction.multiplier[A] + i] +=
                (traction_[A].value[i] - base_[A][i]) / tangential(A, c);
        if (!active_[A]) continue;
        force(A, c, f);
        const auto& stencil = gaps_->stencil(A);
        f *= -S_[A];
        if (has_friction()) f += sliding(A).force(traction_[A].value);
        for (std::size_t v = 0; v < stencil.size(); ++v)
            gaps_->skin().add_force(stencil[v], f.data() + 3 * v, 1.0, r);
    }
    subtract_idle(c, r);
}

void ContactTerm::find_roaming() {
    std::vector<int> found;
    for (int A = 0; A < gaps_->n(); ++A)
        if (active_[A] && gaps_->roams(X1_.data(), A)) found.push_back(A);
    if (!found.empty()) roaming_ = std::move(found);
}

void ContactTerm::tangent(const Context& c, double* values) {
    const bool mass_alone = c.step.theta == 0 && c.step.theta_g == 0 && c.step.is_static();
    if (mass_alone) return;  // at an instant, where the augmentation of closed gaps would be taken for mass
    const Stopwatch watch(costs_.forces);
    // a restart makes this tangent again
    gaps_->skin().positions(c.vectors.x0, X0_), gaps_->skin().positions(c.vectors.x1, X1_);
    narrow();
    evaluate(c, false, true);
    active_.mark_tangent(), slips_at_tangent_ = slips_;
    gaps_->mark_tangent();
    if (rebounds()) landings_.mark_tangent(X0_);
    if (sags()) pressed_.mark_tangent(X0_);
    if (keeps_slides()) slid_.mark_tangent(X0_);
    if (has_history()) elastic_.mark_tangent(X0_);
    std::vector<char> unpressed(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A) unpressed[A] = active_[A] && S_[A] == 0;
    const bool at_theta = (!has_multipliers() && !is_discrete(c.step)) || c.step.theta == 1;
    segments([&] {
        if (std::any_of(unpressed.begin(), unpressed.end(), [](char u) { return u; }))
            gaps_->gradients(Xt_.data(), unpressed, at_theta_);
        gaps_->seconds(Xt_.data(), S_, is_discrete(c.step) ? D_.data() : nullptr, at_theta_);
        if (!at_theta) gaps_->gradients(X1_.data(), active_.flags(), at_end_);
    });
    known_at_ = Xt_, known_of_ = active_.flags();
    scatter_.forget_borders();
    std::vector<Border> borders(gaps_->n());
    parallel_for(gaps_->n(), [&](int A) {
        Eigen::VectorXd g1, f;
        if (active_[A]) {
            g1 = as_vector((at_theta ? at_theta_ : at_end_)[A].gradient);
            if (at_theta) g1 *= c.step.theta;
            force(A, c, f);
        }
        borders[A] = border(A, c, g1, f);
        if (!active_[A]) return;
        Eigen::Map<Matrix> K = stiffness(A, c, g1, f);
        if (has_friction()) add_friction(A, c, g1, K, borders[A]);
    });
    for (int A = 0; A < gaps_->n(); ++A) {
        if (active_[A]) scatter_.subtract_stiffness(A, at_theta_[A].hessian.data(), values);
        scatter_.add_border(A, borders[A], active_[A], values);
    }
}

// Where the active set alone has changed in a time step, only rows and columns of multipliers have.
bool ContactTerm::update_tangent(const Context& c, double* values) {
    if (!has_multipliers() || has_friction() || c.step.is_static()) return false;
    const Stopwatch watch(costs_.forces);
    active_.mark_tangent();
    segments([&] { gaps_->gradients(X1_.data(), active_.flags(), at_end_); });
    scatter_.clear_borders(values);
    Eigen::VectorXd g1, f;
    for (int A = 0; A < gaps_->n(); ++A) {
        if (active_[A]) g1 = as_vector(at_end_[A].gradient), force(A, c, f);
        scatter_.add_border(A, border(A, c, g1, f), active_[A], values);
    }
    return true;
}

void ContactTerm::accept(const Context& c) {
    roaming_.clear();
    if (c.step.balances_ends()) {  // the books have gone back along the path
        gaps_->skin().positions(c.vectors.x0, X0_);
        settle();
        evaluate(c, true);
    }
    if (!c.step.is_static()) pushed_out_ = true;
    tried_ = 0;
    if (has_history()) {
        evaluate(c, false);
        std::vector<double> tractions;
        for (const Traction& t : traction_) tractions.insert(tractions.end(), t.value.begin(), t.value.end());
        elastic_.end_step(X0_, X1_, std::move(tractions));
    }
    if (rebounds()) keep_landings();
    if (sags()) pressed_.end_step(X0_, X1_, S_);
    if (keeps_slides()) keep_slides();
    const std::vector<double> gap = gap1_, area = area1_;
    const std::vector<Hold> held = hands_over() ? this->held() : std::vector<Hold>();
    std::vector<long> places(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A) places[A] = gaps_->place(A);
    begin(c.vectors.x1);
    if (rebounds()) carry_landings(places, gap, area);
    let_go_ = 0;
    for (int A = 0; !has_multipliers() && A < gaps_->n(); ++A)
        if (gaps_->has_left(A)) let_go_ += potential(A, gap[A]);
    if (has_history() && !gaps_->are_of_vertices()) carry_tractions(places);
    if (hands_over()) let_go_of(held), find_come();
    if (hands_over() && beside_) hand_over();
}

// Elastic tractions go with the pair of edges that has them. Those of vertices stay with these, whatever they
// slide on.
void ContactTerm::carry_tractions(const std::vector<long>& places) {
    const std::vector<double>& before = elastic_.at_start();
    std::vector<double> tractions(before.size(), 0.0);
    for (int A = 0; A < gaps_->n(); ++A)
        for (int B = 0; B < gaps_->n(); ++B)
            if (places[B] == gaps_->place(A)) std::copy_n(&before[2 * B], 2, &tractions[2 * A]);
    elastic_.amend(std::move(tractions));
}

}  // namespace visviva
