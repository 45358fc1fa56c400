// Interface of a contact to the heat that passes at its gaps.
#include "visviva/contact/contact_term.hpp"
#include "visviva/contact/passage.hpp"

namespace visviva {

void ContactTerm::find_passages(const Context& c, bool gradients, bool by_rates, std::vector<Passage>& out) {
    evaluate(c, false, gradients);
    const std::size_t n = gaps_->n();
    if (!has_friction()) {
        find_rubbed(c), grips_.resize(n);
        segments([&] { gaps_->grips(Xr_.data(), active_.flags(), gradients, grips_); });
    }
    std::vector<Gap> by_place(gradients ? n : 0);
    const bool at_theta = !has_multipliers() && !is_discrete(c.step);
    if (!by_place.empty())
        segments([&] { gaps_->gradients((at_theta ? Xt_ : X1_).data(), active_.flags(), by_place); });
    out.assign(n, {});
    std::vector<double> way = D_;
    double by_step = 1;  // derivative of the way by the increments
    if (by_rates && has_friction() && c.step.remembers() && !c.step.is_static()) {
        gaps_->skin().increments(c.vectors.rate, way);
        for (double& w : way) w *= c.step.h;
        by_step = c.step.h * c.step.motion[0][0];
    }
    for (std::size_t A = 0; A < n; ++A) {
        Passage& p = out[A];
        if (has_friction()) p.rubbed = rubbed(static_cast<int>(A), c, way);
        if (!active_[A]) continue;
        p.active = true, p.pressure = std::max(S_[A], 0.0), p.weight = grips_[A].weight;
        if (!gradients) continue;
        p.weight_by_place = c.step.theta * grips_[A].weight_gradient;
        p.pressure_by_place = dS_gap_[A] * as_vector(by_place[A].gradient).transpose();
        if (at_theta) p.pressure_by_place *= c.step.theta;
        if (has_friction())
            differentiate_rubbed(static_cast<int>(A), c, p.pressure_by_place, way, by_step, p);
        if (S_[A] < 0) p.pressure_by_place.setZero();
        p.pressure_by_multiplier = has_multipliers() && S_[A] >= 0 ? 1 : 0;
    }
}

// What slip along the way takes over the step, less what its elastic part stores; that is lost where surfaces
// part.
double ContactTerm::rubbed(int A, const Context& c, const std::vector<double>& way) const {
    const Eigen::Vector2d t = traction_[A].value;
    const double work = active_[A] ? slip_work(A, way) : 0;
    if (!has_history()) return -work;
    const double k = options_.friction.stiffness[A], before = 0.5 * base_[A].squaredNorm() / k;
    return -work - 0.5 * t.squaredNorm() / k + (c.backwards ? stored_[A] : before);
}

void ContactTerm::differentiate_rubbed(int A, const Context& c, const Eigen::RowVectorXd& pressure,
                                       const std::vector<double>& along, double by_step, Passage& p) const {
    const FrictionOptions& o = options_.friction;
    const Traction& t = traction_[A];
    const Sliding goes = sliding(A, stencil_of(A, along));
    const Eigen::MatrixXd way = by_step * goes.displacement_gradient(c.step.theta / by_step);
    const Eigen::Vector2d gone = goes.displacement(), by_pressure = o.coefficient * t.by_limit;
    const Eigen::MatrixXd by_place =
        tangential(A, c) * t.by_trial * slip(A).displacement_gradient(c.step.theta) + by_pressure * pressure;
    Eigen::RowVector2d by_traction = gone.transpose();
    if (has_history()) by_traction -= t.value.transpose() / o.stiffness[A];
    p.rubbed_by_place = by_traction * by_place + t.value.transpose() * way;
    if (!has_multipliers()) return;
    p.rubbed_by_multiplier[0] = by_traction.dot(by_pressure);
    if (has_tangential()) p.rubbed_by_multiplier.tail<2>() = by_traction * t.by_trial;
}

}  // namespace visviva
