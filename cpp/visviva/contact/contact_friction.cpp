// Friction of a contact: tractions, their tangent, memory and books.
#include <algorithm>

#include "visviva/contact/contact_term.hpp"

namespace visviva {

// Slip is a rate, not the derivative of a gap: it belongs to the place where the scheme takes rates.
void ContactTerm::find_rubbed(const Context& c) {
    const double t = c.step.theta;
    Xr_.resize(X0_.size());
    for (std::size_t i = 0; i < X0_.size(); ++i) Xr_[i] = (1 - t) * X0_[i] + t * X1_[i];
}

// The traction at a gap: elastic or a multiplier within Coulomb's limit; that at the start of a step that the
// books of statics go back.
void ContactTerm::find_traction(int A, const Context& c) {
    const FrictionOptions& o = options_.friction;
    base_[A] = Eigen::Vector2d::Map(&elastic_.at_start()[2 * A]);
    for (int i = 0; has_tangential() && i < 2; ++i)
        base_[A][i] = i + 1 < gaps_->skin().dim ? c.vectors.x1[o.multiplier[A] + i] : 0.0;
    traction_[A] = {}, slips_[A] = 0;
    if (!active_[A]) return;
    const double limit = o.coefficient * std::max(S_[A], 0.0);  // negative while the active set settles
    traction_[A] = coulomb(c.backwards ? base_[A] : trial(A, c), limit);
    traction_[A].by_trial *= Eigen::Matrix2d::Identity() - free_[A] * free_[A].transpose();
    slips_[A] = traction_[A].slips;
    if (S_[A] < 0) traction_[A].by_limit.setZero();
}

// Of multipliers any stiffness leads to the same, but within a step masses answer to a traction by their
// inertia: where that of the step is not counted, slips of short steps do not tell in the trial traction
// beside the multiplier, and nothing tells their direction. Rigid bodies have nothing but inertia: a
// stiffness far beyond it would make tractions of the rounding of slips, also that of facets they rub on.
double ContactTerm::tangential(int A, const Context& c) const {
    const FrictionOptions& o = options_.friction;
    const double inertia = has_tangential() ? std::abs(c.step.motion[1][0]) * o.inertia[A] : 0;
    if (is_inertial(c)) return inertia;
    const double stiffness = o.stiffness[A] + inertia;
    const bool capped = has_tangential() && rebounds() && holds(c) && c.step.has_length() && o.most[A] > 0;
    return capped ? std::min(stiffness, std::abs(c.step.motion[1][0]) * o.most[A]) : stiffness;
}

bool ContactTerm::is_inertial(const Context& c) const { return has_tangential() && answers_by_inertia(c); }

bool ContactTerm::answers_by_inertia(const Context& c) const {
    const std::vector<char>& deforms = gaps_->skin().mesh_node;
    const bool is_rigid = std::none_of(deforms.begin(), deforms.end(), [](char d) { return d != 0; });
    return is_rigid && rebounds() && holds(c) && c.step.has_length() && options_.friction.inertia[0] > 0;
}

// Several vertices, or facets that lean together over the only one.
bool ContactTerm::has_several() const {
    const int own = gaps_->n() / gaps_->copies();
    if (own > 1 || static_cast<int>(area0_.size()) <= own) return own > 1;
    return std::any_of(area0_.begin() + own, area0_.end(), [](double a) { return a > 0; });
}

// As a gap closes when the step begins. Schemes whose velocities follow from the step alone throw nothing
// back.
bool ContactTerm::rubs_in_impact(const Context& c) const {
    if (!may_rest(c)) return false;
    for (int A = 0; A < gaps_->n(); ++A)
        if (closes(A, c)) return true;
    return false;
}

bool ContactTerm::may_rest(const Context& c) const {
    if (c.step.motion[2][1] == 0 || !keeps_slides() || !holds(c)) return false;
    return !has_several() || !retried_;
}

// In an impact, and in the step in which friction brings to rest what slid. Where a side turns or deforms,
// not all that slid can be at rest after the same motion, or it gives energy: it sticks where it is.
void ContactTerm::find_resting(const Context& c) {
    const bool impacts = rubs_in_impact(c), slides = may_rest(c) && slides_straight();
    for (int A = 0; A < gaps_->n(); ++A) rests_[A] = impacts || (slides && slid_.at_start()[A] != 0);
}

// Whether all that touches slid when the step begins, and neither side turns.
bool ContactTerm::slides_straight() const {
    constexpr double same = 1e-6;
    if (gaps_->copies() > 1 && has_several()) return false;
    Eigen::AlignedBox3d sides[2];
    const int n = gaps_->n();
    bool touches = false;
    for (int A = 0; A < n; ++A) {
        if (closed(A) && slid_.at_start()[A] == 0) return false;
        touches = touches || closed(A);
    }
    double fastest = 0;
    for (int v = 0; v < gaps_->skin().n_vertices(); ++v) {
        const Eigen::Vector3d velocity = Eigen::Vector3d::Map(&V0_[3 * v]);
        sides[v < gaps_->n_first() ? 0 : 1].extend(velocity), fastest = std::max(fastest, velocity.norm());
    }
    auto is_one = [&](const Eigen::AlignedBox3d& side) {
        return !side.isEmpty() && side.diagonal().norm() <= same * fastest;
    };
    return touches && is_one(sides[0]) && is_one(sides[1]);
}

// What sticks without having come to rest keeps the velocity with which it slid.
void ContactTerm::keep_slides() {
    std::vector<double> slid(gaps_->n(), 0.0);
    for (int A = 0; A < gaps_->n(); ++A)
        slid[A] = active_[A] && (slips_[A] || (slid_.at_start()[A] != 0 && !rests_[A])) ? 1 : 0;
    slid_.end_step(X0_, X1_, std::move(slid));
}

// Vertices that stick without having closed may be dragged along by the impact of others.
bool ContactTerm::gives_energy(const Context& c) {
    constexpr double rounding = 1e-9;
    if (!has_several() || std::none_of(rests_.begin(), rests_.end(), [](char r) { return r != 0; }))
        return false;
    find_gradients();
    double sum = 0, size = 0;
    Eigen::VectorXd f;
    for (int A = 0; A < gaps_->n(); ++A) {
        if (!active_[A]) continue;
        force(A, c, f);
        const double pressed = S_[A] * f.dot(stencil_of(A, D_)), rubbed = slip_work(A, D_);
        sum += pressed + rubbed, size += std::abs(pressed) + std::abs(rubbed);
    }
    return sum > rounding * size;
}

// An impact jumps: what sticks in it has come to rest at its end, v1 = c1 D + c0 v0 = 0; no slip in the step
// itself would throw it back as fast as it came. Where pressures turn the slip round, friction lets it go on
// as far as the mean of both ends vanishes, for against that it would give energy: what must not slip is D
// with (c0 + s) / c1 of v0, 0 <= s <= 1. Of several vertices each feels the impacts of the others: s is 0,
// and should they give energy together, or not converge, the step is tried again with D alone. Which s is
// told by slips rather than by tractions, which jump.
Eigen::Vector2d ContactTerm::trial(int A, const Context& c) {
    constexpr double by_traction = 1.0 / 8;
    const double k = tangential(A, c), *v1 = c.step.motion[2];
    carried_[A] = 0, free_[A].setZero();
    if (!rests_[A]) return base_[A] + k * slip(A).displacement();
    carried_[A] = v1[1] / v1[0];
    if (has_several()) return base_[A] + k * slip(A).displacement();
    const Eigen::Vector2d stopped = k * slip(A).displacement(), told = by_traction * base_[A] + stopped,
                          before = k / v1[0] * sliding(A, stencil_of(A, V0_)).displacement();
    if (told.dot(before) >= 0) return base_[A] + stopped;
    const double part = std::min(-told.dot(before) / before.squaredNorm(), 1.0);
    carried_[A] += part / v1[0];
    if (part < 1) free_[A] = before.normalized();
    const Eigen::Vector2d t = base_[A] + stopped + part * before;
    return t - free_[A] * free_[A].dot(t);
}

Sliding ContactTerm::slip(int A) const {
    Eigen::VectorXd way = stencil_of(A, D_);
    if (rests_[A]) way += carried_[A] * stencil_of(A, V0_);
    return sliding(A, way);
}

Sliding ContactTerm::sliding(int A, const Eigen::VectorXd& D) const {
    return {grips_[A], stencil_of(A, Xr_), D, grips_[A].turning, gaps_->skin().dim};
}

std::vector<double> ContactTerm::tractions() const {
    std::vector<double> t(3 * gaps_->n(), 0.0);
    for (int A = 0; has_friction() && A < gaps_->n(); ++A)
        if (active_[A]) Eigen::Vector3d::Map(&t[3 * A]) = grips_[A].tangent * traction_[A].value;
    return t;
}

// K is the derivative of forces that the residual subtracts, those of friction are added there.
void ContactTerm::add_friction(int A, const Context& c, const Eigen::VectorXd& g1, Eigen::Ref<Matrix> K,
                               Border& b) const {
    const FrictionOptions& o = options_.friction;
    const Traction& t = traction_[A];
    const Sliding sliding = slip(A);
    const double turn = c.step.theta;
    const Eigen::MatrixXd directions = sliding.directions();
    const double stiffness = tangential(A, c);
    const Eigen::MatrixXd dt = stiffness * t.by_trial * sliding.displacement_gradient(turn) +
                               o.coefficient * dS_gap_[A] * t.by_limit * g1.transpose();
    K -= sliding.force_gradient(t.value, turn) + directions * dt;
    const Eigen::Vector2d by_pressure = o.coefficient * t.by_limit;
    const int normal = has_multipliers() ? 1 : 0, rest = scatter_.n_tangential();
    if (normal) b.column.col(0) += directions * by_pressure;
    if (rest == 0) return;
    b.row.bottomRows(rest) = dt.topRows(rest) / stiffness;
    b.column.rightCols(rest) = directions * t.by_trial.leftCols(rest);
    b.square.bottomRightCorner(rest, rest) += t.by_trial.topLeftCorner(rest, rest) / stiffness;
    if (normal) b.square.bottomLeftCorner(rest, 1) = by_pressure.head(rest) / stiffness;
}

double ContactTerm::slip_work(int A, const std::vector<double>& way) const {
    return -traction_[A].value.dot(sliding(A, stencil_of(A, way)).displacement());
}

// What slip takes is what the forces do less what the elastic slip stores; nothing happens in no time.
void ContactTerm::book_friction(int A, const Context& c, const std::vector<double>& way, LedgerSums& sums) {
    const double work = active_[A] ? slip_work(A, way) : 0;
    if (!has_history()) {
        sums.work[friction_account] += work;
        return;
    }
    auto stored = [&](const Eigen::Vector2d& t) {
        return 0.5 * t.squaredNorm() / options_.friction.stiffness[A];
    };
    double before = stored(base_[A]), after = c.step.h == 0 ? before : stored(traction_[A].value);
    if (c.backwards)
        before = stored_[A];
    else
        stored_[A] = after;
    sums.work[friction_account] += work + after - before;
    sums.energy[slip_energy_account] += after;
}

}  // namespace visviva
