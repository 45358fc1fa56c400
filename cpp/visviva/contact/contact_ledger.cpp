// A contact's share of the ledger.
#include "visviva/base/stopwatch.hpp"
#include "visviva/contact/contact_term.hpp"

namespace visviva {

void ContactTerm::add_to_vertices(int A, const Eigen::VectorXd& f, std::vector<double>& sum) const {
    const auto& stencil = gaps_->stencil(A);
    for (std::size_t v = 0; v < stencil.size(); ++v)
        for (int i = 0; i < 3; ++i) sum[3 * stencil[v] + i] += f[3 * v + i];
}

// A step taken backwards, as statics books its work, leaves the forces of the step itself.
void ContactTerm::ledger(const Context& c, const double*, LedgerSums& sums) {
    if (!c.backwards) return add_to_ledger(c, sums);
    const auto forces = forces_, friction = friction_forces_;
    add_to_ledger(c, sums);
    forces_ = forces, friction_forces_ = friction;
}

// Whether a gap of rigid bodies closes as the step begins, so that its pressure is that of an impact.
bool ContactTerm::collides(int A, const Context& c) const {
    return rebounds() && holds(c) && active_[A] && closes(A, c);
}

bool ContactTerm::closes(int A, const Context& c) const {
    const bool held = rebound(A, c) < 0 && sink(A, c) == 0;
    return !held && -c.step.h * rate0_[A] > touching * search_.reach() * area0_[A];
}

// An impulse changes the kinetic energy by its work along the mean of the velocities before and after it.
// Increments of the scheme are those only if it goes on with that mean.
void ContactTerm::find_mean_increments(const Context& c) {
    const double* v1 = c.step.motion[2];
    gaps_->skin().increments(c.vectors.v0, V0_);
    mean_increments_.resize(D_.size());
    for (std::size_t i = 0; i < D_.size(); ++i)
        mean_increments_[i] = 0.5 * c.step.h * (v1[0] * D_[i] + (1 + v1[1]) * V0_[i]);
}

Impact ContactTerm::impact(int A, const Eigen::VectorXd& f) const {
    Impact hit{work_account, S_[A] * f.dot(stencil_of(A, D_) - stencil_of(A, mean_increments_)), 0, {}};
    if (has_friction()) hit.rubbed = slip_work(A, D_) - slip_work(A, mean_increments_);
    const Skin& skin = gaps_->skin();
    skin.each_form(gaps_->stencil(A), [&](int, int k) { hit.unknowns.push_back(skin.unknown[k]); });
    return hit;
}

// It is no work of a force: a step that is gone backwards brings back what it took, half of which is taken
// off.
double ContactTerm::let_go(const Context& c) const {
    if (c.backwards) return -let_go_;
    return c.step.has_length() ? let_go_ : 0;
}

void ContactTerm::add_to_ledger(const Context& c, LedgerSums& sums) {
    const Stopwatch watch(costs_.forces);
    evaluate(c, false);
    find_gradients();
    forces_.assign(X1_.size(), 0.0), friction_forces_.assign(X1_.size(), 0.0);
    const bool bends = c.step.motion[2][1] != -1;  // velocities in a step otherwise than by their mean
    if (rebounds() && bends) find_mean_increments(c);
    if (!c.step.is_static()) sums.work[work_account] -= let_go(c);
    Eigen::VectorXd f;
    for (int A = 0; A < gaps_->n(); ++A) {
        if (!has_multipliers()) sums.energy[energy_account] += potential(A, gap1_[A]);
        if (!options_.damping.empty())
            sums.work[work_account] +=
                S_[A] * (gap1_[A] - gap0_[A]) + potential(A, gap1_[A]) - potential(A, gap0_[A]);
        const bool collided = bends && collides(A, c);
        const std::vector<double>& way = collided ? mean_increments_ : D_;
        if (has_friction()) book_friction(A, c, way, sums);
        if (!active_[A]) continue;
        force(A, c, f);
        if (collided) sums.impacts.push_back(impact(A, f));
        add_to_vertices(A, S_[A] * f, forces_);
        if (has_friction()) add_to_vertices(A, -sliding(A).force(traction_[A].value), friction_forces_);
        // What turns takes its frame along chords: in schemes with forces of one end these would do work
        // where nothing moves, which what keeps the frame rigid takes back and no one books.
        const bool along_arcs = bends && !collided && !c.step.is_static();
        const double done = along_arcs ? gap1_[A] - gap0_[A] : f.dot(stencil_of(A, way));
        if (has_multipliers()) sums.work[work_account] += S_[A] * done;
    }
}

}  // namespace visviva
