// What friction adds to a contact: tractions, their tangent, memory and books.
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
    base_[A] = elastic_.at_start(A);
    for (int i = 0; has_tangential() && i < 2; ++i)
        base_[A][i] = i + 1 < gaps_->skin().dim ? c.vectors.x1[o.multiplier[A] + i] : 0.0;
    traction_[A] = {}, slid_[A].setZero(), slips_[A] = 0;
    if (!active_[A]) return;
    slid_[A] = sliding(A).displacement();
    const double limit = o.coefficient * std::max(S_[A], 0.0);  // negative while the active set settles
    const Eigen::Vector2d change =
        c.backwards ? Eigen::Vector2d::Zero() : (tangential(A, c) * slid_[A]).eval();
    traction_[A] = coulomb(base_[A] + change, limit);
    slips_[A] = traction_[A].slips;
    if (S_[A] < 0) traction_[A].by_limit.setZero();
}

// Of multipliers any stiffness leads to the same, but within a step masses answer to a traction by their
// inertia: where that of the step is not counted, slips of short steps do not tell in the trial traction
// beside the multiplier, and nothing tells their direction.
double ContactTerm::tangential(int A, const Context& c) const {
    const FrictionOptions& o = options_.friction;
    return o.stiffness[A] + (has_tangential() ? std::abs(c.step.motion[1][0]) * o.inertia[A] : 0);
}

Sliding ContactTerm::sliding(int A, const std::vector<double>& D) const {
    Eigen::VectorXd turning = Eigen::VectorXd::Zero(grips_[A].weight.size());
    turning.head(gaps_->n_turning(A)).setOnes();
    return {grips_[A], stencil_of(A, Xr_), stencil_of(A, D), turning, gaps_->skin().dim};
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
    const Sliding sliding = this->sliding(A);
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
    return -traction_[A].value.dot(sliding(A, way).displacement());
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
