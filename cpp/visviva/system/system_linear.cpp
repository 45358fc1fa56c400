// Linearisation at a trial state for iterations outside of the core: load stepping, arc length.
#include <algorithm>

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
    if (solved().n == 0) solver = std::make_unique<NoEquations>();
    for (auto r = reductions_.rbegin(); r != reductions_.rend(); ++r)
        solver = make_reduced(*r, std::move(solver));
    solver_ = std::move(solver);
    rigid_ = solver_->capabilities().rigid;
    describe_nodes();
    solver_->analyze(csr_, blocks_);
    stale_factor_ = true;
    prepare_predictor();
}

// Nodes and near-null vectors by equation. Held equations are identities and take no part in rigid motions.
void System::describe_nodes() {
    blocks_.node.clear(), blocks_.algebraic.clear(), blocks_.scale.clear();
    for (int i = 0; i < csr_.n; ++i)
        if (i == 0 || node_[csr_.unknown[i]] != node_[csr_.unknown[i - 1]]) blocks_.node.push_back(i);
    for (int u : csr_.unknown) {
        blocks_.algebraic.push_back(order_[u] == 0);
        blocks_.scale.push_back(inverse_scale_[u] > 0 ? 1 / inverse_scale_[u] : 0);
    }
    blocks_.node.push_back(csr_.n);
    blocks_.n_modes = n_modes_;
    blocks_.modes.assign(static_cast<std::size_t>(csr_.n) * n_modes_, 0.0);
    for (int i = 0; i < csr_.n; ++i)
        if (const int u = csr_.unknown[i]; !fixed_[u])
            std::copy_n(modes_.data() + static_cast<std::size_t>(u) * n_modes_, n_modes_,
                        blocks_.modes.data() + static_cast<std::size_t>(i) * n_modes_);
}

bool System::linearise(const Step& step, const Signals& signals, double* residual) {
    // What is kept from earlier tangents is kept within a load step only: a restart begins one.
    if (std::all_of(dx.begin(), dx.end(), [](double d) { return d == 0; })) solver_->forget();
    find_neighbours();
    evaluate(step, signals, true);
    std::copy(r_.begin(), r_.begin() + n_, residual);
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    const bool regular = refactor({step, vectors, signals}, step, true);
    stale_factor_ = true;  // not a tangent that time steps may keep
    return regular;
}

bool System::linear_solve(const Step& step, const double* residual, double* d, double tolerance) {
    std::copy(residual, residual + n_, r_.begin());
    for (int u : held_) r_[u] = 0;
    std::fill(d_.begin(), d_.end(), 0.0);
    const bool solved = solver_->solve(r_.data(), place(step), d_.data(), tolerance);
    std::copy(d_.begin(), d_.begin() + n_, d);
    return solved;
}

std::string System::refuse(const Step& step, const Signals& signals) {
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data(), v.data()};
    for (const auto& [term, can] : terms_)
        if (const Refusal no = term->refuse({step, vectors, signals}); !no.reason.empty()) return no.reason;
    return {};
}

}  // namespace visviva
