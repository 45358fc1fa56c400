// Gaps of a contact that carry pressure, and their pressures.
#include <algorithm>
#include <cmath>

#include "visviva/contact/contact_term.hpp"

namespace visviva {

namespace {

// Part of a vertex' area that the other surface must cover: with less, the weighted gap also vanishes because
// the cover does, and Newton's method converges to that while the multiplier grows without bound.
constexpr double least_cover = 1e-3;

}  // namespace

bool ContactTerm::is_covered(int A, const std::vector<double>& area) const {
    return area[A] > least_cover * options_.area[A];
}

// At the start of the step. Rounding opens nothing: neither what is held, nor some of the gaps that close
// together at a step's end.
bool ContactTerm::closed(int A) const {
    const double length = rebounds() ? search_.reach() : options_.size;
    return area0_[A] > 0 && gap0_[A] <= touching * length * area0_[A];
}

// Rate at which closed gaps close when the step begins.
void ContactTerm::find_rates(const Context& c) {
    gaps_->skin().increments(c.vectors.v0, V0_);
    if (rates_at_ == X0_ && rates_of_ == V0_) return;
    rates_at_ = X0_, rates_of_ = V0_;
    std::vector<char> wanted(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A) wanted[A] = closed(A);
    segments([&] { gaps_->gradients(X0_.data(), wanted, at_start_); });
    for (int A = 0; A < gaps_->n(); ++A)
        rate0_[A] = wanted[A] ? as_vector(at_start_[A].gradient).dot(stencil_of(A, V0_)) : 0.0;
}

// Change of a gap for which the scheme's rate at the end is the restitution times that of closing.
double ContactTerm::rebound(int A, const Context& c) const {
    const double* v1 = c.step.motion[2];
    return -(options_.restitution + v1[1]) / v1[0] * std::min(rate0_[A], 0.0);
}

// The same of what has sunk below the gap with which it landed as far as that: on surfaces that turn or bend
// rates of what stays in contact are off by the second order of the step, to either side of zero. Did every
// one of these that closes sink further, there would be no end to it. What is held keeps its energy, and the
// rate changes its sign.
double ContactTerm::sink(int A, const Context& c) const {
    const double change = rebound(A, c), landing = landings_.at_start()[A];
    if (change >= 0 || landing == in_flight) return change;
    return std::min(change + std::max(landing * area0_[A] - gap0_[A], 0.0), 0.0);
}

// At the end of a step.
void ContactTerm::keep_landings() {
    std::vector<double> landings = landings_.at_start();
    for (int A = 0; A < gaps_->n(); ++A) {
        const bool open = area1_[A] <= 0 || gap1_[A] > touching * search_.reach() * area1_[A];
        if (open)
            landings[A] = in_flight;
        else if (active_[A] && landings[A] == in_flight)
            landings[A] = gap1_[A] / area1_[A];
    }
    landings_.end_step(X0_, X1_, std::move(landings));
}

// Landings belong to places: gaps of a vertex hold others from now on than those of the step that ended with
// these gaps and areas. What slides over an edge takes its landing along; what is behind something else,
// deeper than it was before, has met that by an impact.
void ContactTerm::carry_landings(const std::vector<long>& places, const std::vector<double>& gap,
                                 const std::vector<double>& area) {
    const std::vector<double>& landed = landings_.at_start();
    const int n = gaps_->n(), own = n / gaps_->copies();
    std::vector<double> landings(n, in_flight);
    auto copy_at = [&](int A, auto wanted) {
        for (int B = A % own; B < n; B += own)
            if (wanted(B)) return B;
        return -1;
    };
    for (int A = 0; A < n; ++A) {
        if (area0_[A] <= 0) continue;
        const double least = gap0_[A] / area0_[A] + touching * search_.reach();
        const long place = gaps_->place(A);
        int from = copy_at(A, [&](int B) { return landed[B] != in_flight && places[B] == place; });
        if (from < 0)
            from = copy_at(A, [&](int B) {
                return landed[B] != in_flight && gap[B] / area[B] <= least &&
                       copy_at(B, [&](int C) { return area0_[C] > 0 && gaps_->place(C) == places[B]; }) < 0;
            });
        if (from >= 0) landings[A] = landed[from];
    }
    landings_.amend(std::move(landings));
}

// The gap below which there is pressure. In time what overlaps shall not close further, but opening it would
// give energy: so it is with conserving impact, and where a vertex was not covered enough to carry before.
double ContactTerm::least_gap(int A, const Context& c) const {
    if (c.step.is_static()) return 0;
    if (rebounds()) return (pushes_out() ? std::max(gap0_[A], 0.0) : gap0_[A]) + sink(A, c);
    if (options_.conserving) return closed(A) ? gap0_[A] : 0.0;
    const double rounding = touching * area0_[A] * options_.size;
    return !options_.presses_out && gap0_[A] < -rounding ? gap0_[A] : 0.0;
}

// Without inertia what just touches holds: bodies may rest on nothing else.
double ContactTerm::slack(int A, const Context& c) const {
    return c.step.is_static() ? touching * area1_[A] * options_.size : 0;
}

// Pressure per gap by which one is weighed against the other: it decides how the active set is found and
// nothing else. Rigid bodies have a natural one in a step, whatever stiffness was given.
double ContactTerm::exchange(int A, const Context& c) const {
    if (!answers_by_inertia(c)) return options_.stiffness[A];
    return std::abs(c.step.motion[1][0]) * options_.friction.inertia[A];
}

bool ContactTerm::wants_pressure(int A, const Context& c) const {
    if (area1_[A] == 0 || !covered_[A] || (holds(c) && !closed(A))) return false;
    const double lambda = c.vectors.x1[options_.multiplier[A]];
    const double k = exchange(A, c), pressure = lambda - k * (gap1_[A] - least_gap(A, c));
    // rounding shall not change what was chosen in this step
    const double rounding = !active_.is_chosen() ? 0 : 1e-12 * k * area1_[A] * options_.size;
    return pressure + k * slack(A, c) > (active_[A] ? -rounding : rounding);
}

// Once covered in the iterations of a step, a vertex may carry until its end. Conserving impact asks for its
// start alone.
void ContactTerm::find_covered(const Context& c) {
    const bool by_start = holds(c);
    for (int A = 0; A < gaps_->n(); ++A) {
        if (!active_.is_chosen()) covered_[A] = is_covered(A, area0_);
        if (!by_start && is_covered(A, area1_)) covered_[A] = 1;
    }
}
void ContactTerm::update_active_set(const Context& c) {
    find_covered(c);
    active_.update([&](int A) { return wants_pressure(A, c); });
}

// In statics bodies may be held by contact alone: the augmentation keeps their tangents regular. With inertia
// multipliers serve as they are, so that a change of the active set changes nothing but their rows and
// columns. Nor does the augmentation do work: the multiplier alone is the force that a load step begins with.
double ContactTerm::augmentation(int A, const Context& c) const {
    const bool plain = !c.step.is_static() && !has_friction();
    if (plain || c.backwards) return 0;
    return is_inertial(c) ? tangential(A, c) : options_.stiffness[A];
}

// The pressure at a gap, not negative once the active set has settled.
void ContactTerm::press(int A, const Context& c, double gap_theta) {
    const double k = options_.stiffness[A];
    S_[A] = dS_gap_[A] = R_[A] = 0;
    // No gap of nothing is closed, also where the active set goes round in circles and others change first.
    const bool alone = gaps_->stencil(A).empty() || (!has_multipliers() && area0_[A] == 0 && area1_[A] == 0);
    if (alone) active_.set(A, false);
    if (alone && !has_multipliers()) return;
    if (!has_multipliers() && is_discrete(c.step)) {
        press_discretely(A, c);
    } else if (!has_multipliers()) {
        if (gap_theta < slack(A, c)) S_[A] = -k * gap_theta, dS_gap_[A] = -k;
    } else {
        const double lambda = c.vectors.x1[options_.multiplier[A]], closing = gap1_[A] - least_gap(A, c);
        const double c_A = augmentation(A, c);
        if (active_[A])
            S_[A] = lambda - c_A * closing, dS_gap_[A] = -c_A, R_[A] = -closing;
        else
            R_[A] = -lambda / exchange(A, c);
        return;
    }
    active_.set(A, dS_gap_[A] != 0);
}

double ContactTerm::potential(int A, double gap) const {
    const double depth = std::min(gap, 0.0);
    return 0.5 * options_.stiffness[A] * depth * depth;
}

// S (gap1 - gap0) = W(gap0) - W(gap1) for W = k / 2 <-gap>^2, and what a damper takes of penetration; both
// together do not pull.
void ContactTerm::press_discretely(int A, const Context& c) {
    const double k = options_.stiffness[A], a = std::min(gap0_[A], 0.0), b = std::min(gap1_[A], 0.0);
    const double change = gap1_[A] - gap0_[A];
    if (a == gap0_[A] && b == gap1_[A]) {
        S_[A] = -0.5 * k * (a + b), dS_gap_[A] = -0.5 * k;
    } else if (a != b) {
        S_[A] = 0.5 * k * (a - b) * (a + b) / change;
        dS_gap_[A] = -(k * b + S_[A]) / change;
    }
    if (options_.damping.empty() || c.step.is_static()) return;
    const double rate = options_.damping[A] / c.step.h;
    S_[A] -= rate * (b - a);
    if (b < 0) dS_gap_[A] -= rate;
    if (S_[A] <= 0) S_[A] = dS_gap_[A] = 0;
}

// Whether both surfaces belong to one rigid body each: vertices are forms that begin with the same place.
bool ContactTerm::is_rigid_pair() const {
    const Skin& skin = gaps_->skin();
    auto origin = [&](int v) { return skin.first[v] < skin.first[v + 1] ? skin.unknown[skin.first[v]] : -1; };
    auto is_one = [&](int begin, int end) {
        for (int v = begin + 1; v < end; ++v)
            if (origin(v) != origin(begin)) return false;
        return true;
    };
    const bool deforms = std::any_of(skin.mesh_node.begin(), skin.mesh_node.end(), [](char m) { return m; });
    const int n = gaps_->n_first();
    return rebounds() && has_several() && !deforms && is_one(0, n) && is_one(n, skin.n_vertices());
}

// What is left of the pressures on a pair of rigid bodies without those of the same force and torque that
// have the least mean square over the area, at the gaps of vertices and edges together. Gaps alone leave it
// open, and rounding would have it drift. With their compliance the rows of gaps have it vanish, and as it
// moves nothing, gaps close all the same.
void ContactTerm::subtract_idle(const Context& c, double* r) const {
    if (!has_multipliers() || !is_rigid_pair_ || stands_beside_) return;
    std::vector<std::pair<const ContactTerm*, int>> pressed;
    for (const ContactTerm* term : {this, static_cast<const ContactTerm*>(beside_.get())})
        for (int A = 0; term && A < term->n(); ++A)
            if (term->active_[A]) pressed.emplace_back(term, A);
    if (pressed.size() < 2) return;
    const Eigen::Index n = static_cast<Eigen::Index>(pressed.size());
    auto place = [](const ContactTerm* term, int v) { return Eigen::Vector3d::Map(&term->Xt_[3 * v]); };
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const auto& [term, A] : pressed) centre += place(term, term->vertex_of(A)) / static_cast<double>(n);
    double size = 0;
    for (const auto& [term, A] : pressed)
        size = std::max(size, (place(term, term->vertex_of(A)) - centre).norm());
    if (size == 0) size = 1;                               // all of one vertex
    Eigen::MatrixXd wrench = Eigen::MatrixXd::Zero(n, 6);  // on the first body, by pressures times sqrt(area)
    Eigen::VectorXd pressure(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto& [term, A] = pressed[i];
        const double root = std::sqrt(term->options_.area[A]);
        const auto& stencil = term->gaps_->stencil(A);
        for (std::size_t k = 0; k < stencil.size(); ++k) {
            if (stencil[k] >= term->gaps_->n_first()) continue;
            const Eigen::Vector3d f = Eigen::Vector3d::Map(&term->at_theta_[A].gradient[3 * k]) / root;
            wrench.row(i).head<3>() += f;
            wrench.row(i).tail<3>() += (place(term, stencil[k]) - centre).cross(f) / size;
        }
        pressure[i] = root * c.vectors.x1[term->options_.multiplier[A]];
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(n, 6);
    qr.setThreshold(1e-7);
    qr.compute(wrench);
    Eigen::VectorXd rest = qr.householderQ().adjoint() * pressure;
    rest.head(qr.rank()).setZero();
    rest = qr.householderQ() * rest;
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto& [term, A] = pressed[i];
        r[term->options_.multiplier[A]] -=
            term->compliance(A, c) * rest[i] / std::sqrt(term->options_.area[A]);
    }
}

}  // namespace visviva
