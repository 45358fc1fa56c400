// Linearisation at a trial state for iterations outside of the core: load stepping, arc length.
#include <algorithm>
#include <cmath>
#include <limits>

#include "visviva/system/system.hpp"

namespace visviva {

namespace {
// Where all that moves is prescribed, and nothing is left to solve.
class NoEquations : public LinearSolver {
  public:
    NoEquations() { report_.name = "nothing to solve", report_.n_negative = 0; }
    void analyze(const Csr&, const Blocks&) override {}
    bool factor(const double*, const Place&) override { return true; }
    bool solve(const double*, const Place&, double*, double) override { return true; }
};
}  // namespace

void System::set_solver(std::unique_ptr<LinearSolver> solver) {
    if (!any(solved().n > 0)) solver = std::make_unique<NoEquations>();
    for (auto r = reductions_.rbegin(); r != reductions_.rend(); ++r)
        solver = make_reduced(*r, std::move(solver), [this](bool here) { return !any(!here); });
    solver_ = std::move(solver);
    rigid_ = solver_->capabilities().rigid;
    describe_nodes();
    find_judged();
    solver_->analyze(csr_, blocks_);
    stale_factor_ = true;
    prepare_predictor();
}

// A solver that keeps bodies rigid finds the multipliers for that, which change by other forces alone.
void System::find_judged() {
    std::vector<char> judged = is_judged_;
    judged.resize(n_);
    for (const RigidUnknowns& body : blocks_.rigid)
        for (int k = 0; rigid_ && k < 6; ++k) judged[body.multiplier[k]] = 0;
    std::vector<double> acted_on(n_, 0.0);
    MultiplierForces::mark(csr_, judged, acted_on);
    total(acted_on);
    multiplier_forces_.analyze(csr_, judged, acted_on, inverse_scale_);
}

// Nodes and near-null vectors by equation. Held equations are identities and take no part in rigid motions.
void System::describe_nodes() {
    blocks_.node.clear(), blocks_.place.clear(), blocks_.algebraic.clear(), blocks_.scale.clear();
    blocks_.algebraic.reserve(csr_.n), blocks_.scale.reserve(csr_.n);
    for (int i = 0; i < csr_.n; ++i)
        if (i == 0 || node_[csr_.unknown[i]] != node_[csr_.unknown[i - 1]]) blocks_.node.push_back(i);
    for (int u : csr_.unknown) {
        if (!place_.empty()) blocks_.place.push_back(place_[u]);
        blocks_.algebraic.push_back(order_[u] == 0);
        blocks_.scale.push_back(inverse_scale_[u] > 0 ? 1 / inverse_scale_[u] : 0);
    }
    blocks_.node.push_back(csr_.n);
    blocks_.n_modes = n_modes_;
    blocks_.modes = [this](std::vector<int> rows, double* to) {
        for (int& row : rows) row = row < 0 || fixed_[csr_.unknown[row]] ? -1 : csr_.unknown[row];
        if (n_modes_ > 0) modes_(rows, to);
    };
}

bool System::linearise(const Step& step, const Signals& signals, double* residual) {
    // What is kept from earlier tangents is kept within a load step only: a restart begins one.
    if (std::all_of(dx.begin(), dx.end(), [](double d) { return d == 0; }))
        solver_->forget(), monotone_.begin_step();
    monotone_.project(dx.data());
    find_neighbours();
    evaluate(step, signals, true);
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    const bool regular = refactor({step, vectors, signals}, step, true);
    monotone_.clear(r_.data());
    std::copy(r_.begin(), r_.begin() + n_, residual);
    stale_factor_ = true;  // not a tangent that time steps may keep
    return regular;
}

bool System::linear_solve(const Step& step, const double* residual, double* d, double tolerance) {
    std::copy(residual, residual + n_, r_.begin());
    for (int u : held_) r_[u] = 0;
    monotone_.clear(r_.data());
    std::fill(d_.begin(), d_.end(), 0.0);
    const bool solved = solve_increment(step, tolerance);
    std::copy(d_.begin(), d_.begin() + n_, d);
    return solved;
}

// A residual in units of what rounding of the unknowns makes of its rows: the backward error by component of
// Oettli and Prager (1964).
double System::in_roundings(const double* residual) const {
    constexpr double eps = std::numeric_limits<double>::epsilon();
    double largest = 0;
    std::vector<double> rounding(n_, 0.0);
    for (int i = 0; i < csr_.n; ++i)
        for (auto k = csr_.row[i]; k < csr_.row[i + 1]; ++k)
            rounding[csr_.unknown[i]] += std::abs(values_[k] * x1_[csr_.unknown[csr_.col[k]]]);
    total(rounding);
    for (int u = 0; u < n_; ++u)
        if (!fixed_[u] && !monotone_.is_masked(u) && residual[u] != 0)
            largest = std::max(largest, std::abs(residual[u]) / (eps * rounding[u]));
    return largest;
}

// Half of the digits are to be known all the same.
bool System::meets_rounding(const double* residual, double size, double last) const {
    constexpr double unsure = 1e-8, few = 2;
    return size > 0.5 * last && size <= unsure && in_roundings(residual) <= few;
}

std::string System::refuse(const Step& step, const Signals& signals) {
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    return refusal({step, vectors, signals}).reason;
}

}  // namespace visviva
