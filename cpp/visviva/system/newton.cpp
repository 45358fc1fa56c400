// Newton's method for one step.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "visviva/base/vector_dispatch.hpp"
#include "visviva/system/acceleration.hpp"
#include "visviva/system/convergence.hpp"
#include "visviva/system/system.hpp"

namespace visviva {

namespace {
bool same_matrix(const Step& a, const Step& b) {
    return a.h == b.h && a.theta == b.theta && a.theta_g == b.theta_g && a.stress == b.stress &&
           a.motion[1][0] == b.motion[1][0] && a.transport[0][0] == b.transport[0][0];
}

// Across a hump of what bodies store, as of latent heat, increments by new tangents go to and fro for ever.
class ToAndFro {
  public:
    /// Unknowns of what is stored: what touches and lets go may turn back as it likes.
    void judge(int begin, int end) { parts_.emplace_back(begin, end); }
    /// Shortens d, by a new tangent in iteration k: once one undoes the last such, they go half as far as
    /// that, and no further from then on. Returned is the share that is left.
    double shorten(int k, std::vector<double>& d, const std::vector<double>& weight) {
        constexpr int patience = 3;
        if (k < patience || parts_.empty()) return 1;
        const double size = std::sqrt(product(d, d, weight)),
                     before = std::sqrt(product(last_, last_, weight));
        if (product(d, last_, weight) < -0.7 * size * before && size > 0.5 * before) most_ = 0.5 * before;
        const double share = size > most_ ? most_ / size : 1;
        for (double& each : d) each *= share;
        last_ = d;
        return share;
    }

  private:
    double product(const std::vector<double>& a, const std::vector<double>& b,
                   const std::vector<double>& weight) const {
        double sum = 0;
        if (a.empty() || b.empty()) return sum;
        for (const auto& [begin, end] : parts_)
            for (int i = begin; i < end; ++i) sum += weight[i] * weight[i] * a[i] * b[i];
        return sum;
    }
    std::vector<std::pair<int, int>> parts_;
    double most_ = std::numeric_limits<double>::infinity();
    std::vector<double> last_;
};
}  // namespace

// Where nothing is extrapolated, prescribed motion alone would tear at the elements it moves: the others
// follow it here by the tangent of the state before.
bool System::extend_prescribed_motion(const Context& c) {
    constexpr double little = 1e-6;
    std::vector<double> motion;
    double largest = 0;
    for (int u : prescribed_) {
        motion.push_back(dx[u]);
        largest = std::max(largest, std::abs(dx[u]));
    }
    if (largest == 0 || !starts_still(c.step)) return true;
    auto residual_at = [&](double part) {
        for (std::size_t k = 0; k < motion.size(); ++k) dx[prescribed_[k]] = part * motion[k];
        update_vectors(c.step);
        evaluate_residual(c, !rigid_);
    };
    residual_at(little);
    const Unknowns moved = r_;
    residual_at(0);
    bool solvable = refactor(c, c.step);
    stale_factor_ = true;
    for (int i = 0; i < n_; ++i) r_[i] += (moved[i] - r_[i]) / little;
    for (int u : held_) r_[u] = 0;
    solvable = solvable && solve_increment(c.step, 0);
    if (solvable) iterate(c.step);
    for (std::size_t k = 0; k < motion.size(); ++k) dx[prescribed_[k]] = motion[k];
    return solvable;
}

System::ForceSize System::relative_force(double change) {
    const auto [balanced, stiffest] =
        multiplier_forces_.sizes(values_.data(), x1_.data(), dx.data(), [this](auto& v) { total(v); });
    return balanced > 0 ? ForceSize{change / balanced, stiffest / balanced} : ForceSize{};
}

void System::start(const Step& step) {
    if (accepted_.empty()) accepted_ = evaluations();
    predict(step);
    if (rigid_) rigid_->project(x.data(), dx.data());
    find_neighbours(step.theta, step.h);
    if (stale_begin_)
        for (const auto& [term, can] : terms_) term->begin(x.data());
    stale_begin_ = false;
}

std::string System::singular() const {
    const std::string& why = solver_->report().message;
    return why.empty() ? "the tangent is singular" : why;
}

bool System::renew_tangent(const Context& context, bool assembled) {
    stale_factor_ = true;
    solver_->forget();  // a restart makes this factorisation again, without those before it
    if (rigid_) rigid_->balance(r_.data(), place(context.step), dx.data(), x1_.data());
    if (!refactor(context, context.step, assembled)) return false;
    stale_factor_ = updated_ = false;
    return true;
}

Report System::failed(Report report, const std::string& reason, int unknown) {
    report.converged = false;
    report.reason = reason;
    report.worst_unknown = unknown;
    stale_factor_ = true;
    return report;
}

// Of the first term that refuses in the first process where one does.
Refusal System::refusal(const Context& context) {
    Refusal no;
    for (auto part = terms_.begin(); part != terms_.end() && no.reason.empty(); ++part)
        no = part->term->refuse(context);
    agree(no);
    return no;
}

Report System::succeeded(Report report, const Context& context, bool renewed) {
    if (const Refusal no = refusal(context); !no.reason.empty())
        return failed(std::move(report), no.reason, no.unknown);
    report.converged = true;
    if (rigid_) rigid_->balance(r_.data(), place(context.step), dx.data(), x1_.data());
    iterations_last_ = renewed ? 0 : report.iterations;
    stale_factor_ = updated_ || monotone_.any();  // which a restart could not make again
    if (monotone_.any()) monotone_.clip(dx.data()), update_vectors(context.step);
    return report;
}

// Why the iteration ends at an increment of this size; nothing if it goes on.
std::string System::lost(const Step& step, double size) const {
    if (!std::isfinite(size)) return "an unknown became infinite or not a number";
    // Only places have a size that no choice of units changes.
    if (size > NewtonOptions::astray && !step.is_static() && order_[worst()] == 2)
        return "the iteration left the model far behind";
    return {};
}

Report System::unfinished(Report report, double last, bool arrived) {
    if (last <= 1e-12 && constraint_error() > 100 * last + noise_)
        return failed(std::move(report),
                      "nothing moves any more but constraints stay violated (they contradict each other, or "
                      "lead no further from here)",
                      worst_constraint());
    const std::string n = std::to_string(report.iterations);
    return failed(std::move(report),
                  "no convergence in " + n + " iterations" + (arrived ? " of the forces of constraints" : ""),
                  worst());
}

Report System::solve(const Step& step, const Signals& signals, const NewtonOptions& options) {
    Report report;
    report.increments.reserve(8);
    start(step);
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    const Context context{step, vectors, signals};
    if (!extend_prescribed_motion(context))
        return failed(std::move(report), singular(), solver_->report().singular_unknown);
    const bool full = options.keep_factor <= 0 || monotone_.any();
    monotone_.begin_step();
    bool refresh = stale_factor_ || full || options.n_tangents > 0 || !same_matrix(step, factored_) ||
                   iterations_last_ > NewtonOptions::many_iterations;
    // Coordinates that constraints determine converge without their multipliers, whose work is booked: these
    // are judged by themselves.
    Convergence convergence(options.keep_factor, contraction_),
        forces(options.keep_factor, contraction_of_forces_);
    bool arrived = false;
    Acceleration acceleration;
    ToAndFro to_and_fro;
    for (const Segment& s : segments_)
        if (s.order == 1 && !s.flows) to_and_fro.judge(s.begin, s.end);
    const bool accelerates = !rigid_;  // by updates that are not sums
    update_vectors(step);
    // Velocities are increments by the step length: errors are judged against the increment of the whole
    // step.
    const double tolerance = options.tolerance * std::min(1.0, extent(step.h));
    const double resolution = finest_search();
    int most = options.max_iterations;
    for (int k = 0; k < most; ++k) {
        const bool fused = refresh;
        if (monotone_.project(dx.data())) update_vectors(step);
        evaluate_residual(context, !rigid_, fused);
        bool outdated = has_branched();
        if (outdated && !refresh) {
            refresh = full || !update_tangent(context);
            convergence.forget(), forces.forget();
            acceleration.forget();
        }
        if (refresh) {
            ++report.factorizations;
            if (!renew_tangent(context, fused))
                return failed(std::move(report), singular(), solver_->report().singular_unknown);
            convergence.renew(k), forces.renew(k);
            acceleration.forget();
        }
        outdated = outdated || monotone_.has_changed();
        for (int u : held_) r_[u] = 0;
        monotone_.clear(r_.data());
        if (!solve_increment(step, convergence.enough(k)))
            return failed(std::move(report), solver_->report().message, -1);
        const double change =
            multiplier_forces_.largest(values_.data(), d_.data(), [this](auto& v) { total(v); });
        double size = 0;  // that of the kept tangent's own increment tells of the residual
        // Coordinates that are there tell nothing of what the increments of multipliers have in common.
        if (accelerates && convergence.last() > noise_ &&
            (acceleration.runs() || convergence.is_sluggish())) {
            size = vector_kernels().largest(n_, d_.data(), inverse_scale_.data());
            acceleration.apply(d_, inverse_scale_);
        }
        double share = limit_correction();
        if (refresh && !outdated) share *= to_and_fro.shorten(k, d_, inverse_scale_);
        size = std::max(size, iterate(step) / share);
        report.increments.push_back(size);
        report.iterations = k + 1;
        if (const std::string why = lost(step, size); !why.empty())
            return failed(std::move(report), why, worst());
        const ForceSize force = relative_force(change);
        convergence.judge(k, size), forces.judge(k, force.change);
        // A constraint that the increment does not answer to (a regularised pivot) keeps the step from
        // converging.
        const bool holds = !outdated && constraint_error() <= 100 * size + noise_;
        arrived = holds && convergence.is_there(tolerance, noise_, resolution);
        const bool balanced = forces.stalls() || forces.is_there(NewtonOptions::of_forces * options.tolerance,
                                                                 noise_ * force.stiffest, resolution);
        if (arrived && balanced) return succeeded(std::move(report), context, convergence.has_tangent());
        // What has found its branches late is on its way: a shorter step would search for them as long.
        const bool is_near = !outdated && size < NewtonOptions::near;
        if (k + 1 == options.max_iterations && is_near) most += options.max_iterations / 2;
        // Multipliers far off put their curvature into a tangent made with them.
        const bool astray = refresh && force.change > 10;
        refresh = full || k + 1 < options.n_tangents || (convergence.is_slow() && !arrived) ||
                  ((forces.is_slow() || astray) && !balanced);
    }
    return unfinished(std::move(report), convergence.last(), arrived);
}

}  // namespace visviva
