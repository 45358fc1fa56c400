// Forces of a contact and their derivatives, gap by gap.
#include <algorithm>
#include <cmath>

#include "visviva/contact/complement.hpp"
#include "visviva/contact/contact_term.hpp"

namespace visviva {

namespace {

// Forces along the relative motion that complete the work of the gradient to the change of the gap, and how
// much of them: (gap1 - gap0 - g . D) / p . D, see the theory of contact in the documentation.
struct Correction {
    Complement complement;
    double size, c = 0;
    Correction(const Eigen::VectorXd& x, const Eigen::VectorXd& D, const Eigen::VectorXd& masses, int dim)
        : complement(x, D, masses, dim), size(complement.size()) {
        if (size <= 1e-14 * complement.spread()) size = 0;  // what would be mended is less than rounding
    }
    void complete(double defect) { c = size > 0 ? defect / size : 0; }
};

}  // namespace

Eigen::VectorXd ContactTerm::stencil_of(int A, const std::vector<double>& X) const {
    const auto& stencil = gaps_->stencil(A);
    Eigen::VectorXd x(3 * stencil.size());
    for (std::size_t v = 0; v < stencil.size(); ++v)
        for (int i = 0; i < 3; ++i) x[3 * v + i] = X[3 * stencil[v] + i];
    return x;
}

// Per pressure, on the stencil's vertices: the gradient, completed to a discrete one where the scheme wants
// it.
void ContactTerm::force(int A, const Context& c, Eigen::VectorXd& f) const {
    f = as_vector(at_theta_[A].gradient);
    if (!is_discrete(c.step)) return;
    const Eigen::VectorXd D = stencil_of(A, D_);
    Correction correction(stencil_of(A, Xt_), D, masses_[A].weight, gaps_->skin().dim);
    correction.complete(gap1_[A] - gap0_[A] - f.dot(D));
    f += correction.c * correction.complement.momentum();
}

// S df/dx1, minus what follows from the change of S: in the place of the second derivatives.
Eigen::Map<ContactTerm::Matrix> ContactTerm::stiffness(int A, const Context& c, const Eigen::VectorXd& g1,
                                                       const Eigen::VectorXd& f) {
    Gap& gap = at_theta_[A];
    const Eigen::VectorXd g = as_vector(gap.gradient);
    if (S_[A] == 0) gap.hessian.assign(g.size() * g.size(), 0.0);
    Eigen::Map<Matrix> K(gap.hessian.data(), g.size(), g.size());
    const double t = c.step.theta;
    if (t != 1) K *= t;
    if (dS_gap_[A] != 0) K.noalias() += (dS_gap_[A] * f) * g1.transpose();
    if (S_[A] == 0 || !is_discrete(c.step)) return K;
    const Eigen::VectorXd D = stencil_of(A, D_);
    Correction correction(stencil_of(A, Xt_), D, masses_[A].weight, gaps_->skin().dim);
    correction.complete(gap1_[A] - gap0_[A] - g.dot(D));
    if (correction.size == 0) return K;
    const Eigen::VectorXd p = correction.complement.momentum(), &m = masses_[A].weight;
    Eigen::MatrixXd dp = correction.complement.derivative(t);
    for (Eigen::Index v = 0; v < m.size(); ++v) dp.middleRows<3>(3 * v) *= m[v];
    Eigen::VectorXd d_size = 2 * (dp.transpose() * correction.complement.motion());
    if (const Eigen::MatrixXd& dm = masses_[A].weight_gradient; dm.size() > 0) {
        dp += correction.complement.by_masses() * dm;
        d_size += dm.transpose() * correction.complement.size_by_masses();
    }
    const Eigen::VectorXd dc = (g1 - g - t * as_vector(gap.along) - correction.c * d_size) / correction.size;
    K.noalias() += (S_[A] * p) * dc.transpose();
    K += (S_[A] * correction.c) * dp;
    return K;
}

// Four corners of a box press on a plane where three would do, and what sticks may be held by a support as
// well. So little give in the tangent of a step, and none in the residual, leaves alone what changes nothing.
// Where rigid bodies rub, so little would make rounding of positions pull vertices over Coulomb's limit
// against each other: there it is as much as still lets Newton's method converge at once.
double ContactTerm::compliance(int A, const Context& c) const {
    constexpr double little = 1e-10, of_inertia = 5e-6;
    const bool instant =
        c.step.h > 0 && !c.step.has_length();  // where modes take closed gaps for constraints
    if (instant || (!options_.rigid && !has_tangential())) return 0;
    const double mass = std::abs(c.step.motion[1][0]) * options_.friction.inertia[A];
    const bool leans = gaps_->copies() > 1 && has_tangential() && !c.step.is_static();
    if ((is_inertial(c) || leans) && has_several()) return of_inertia / tangential(A, c);
    const double stiffness = augmentation(A, c) + mass;
    return little / (stiffness > 0 ? stiffness : options_.stiffness[A]);
}

// Without friction; where there is no contact multipliers vanish.
ContactScatter::Border ContactTerm::border(int A, const Context& c, const Eigen::VectorXd& g1,
                                           const Eigen::VectorXd& f) const {
    const int m = scatter_.n_multipliers(), normal = has_multipliers() ? 1 : 0;
    Border b;
    b.square.setZero(m, m);
    if (normal && !active_[A]) b.square(0, 0) = -1 / exchange(A, c);
    for (int i = normal; i < m; ++i) b.square(i, i) = -1 / tangential(A, c);
    if (!active_[A]) return b;
    for (int i = 0; i < m; ++i) b.square(i, i) -= compliance(A, c);
    b.row.setZero(m, g1.size()), b.column.setZero(g1.size(), m);
    if (normal) b.row.row(0) = -g1.transpose(), b.column.col(0) = -f;
    return b;
}

// Those of the start of the step; where surfaces hardly face each other then, with those of its end. Whatever
// else is in the stencils, forces follow from both ends of the step.
void ContactTerm::find_masses(bool gradients) {
    std::vector<char> before(gaps_->n()), fresh(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A) {
        before[A] = !gaps_->stencil(A).empty() && is_covered(A, area0_);
        fresh[A] = active_[A] && !before[A];
    }
    if (massed_ != X0_) {
        for (Grip& g : masses_) g.weight_gradient.resize(0, 0);
        gaps_->masses(X0_.data(), before, false, masses_), massed_ = X0_;
    }
    if (std::none_of(fresh.begin(), fresh.end(), [](char f) { return f; })) return;
    std::vector<Grip> start(gaps_->n());
    gaps_->masses(X0_.data(), fresh, false, start);
    gaps_->masses(X1_.data(), fresh, gradients, masses_);
    for (int A = 0; A < gaps_->n(); ++A)
        if (fresh[A]) masses_[A].weight += start[A].weight;
}

}  // namespace visviva
