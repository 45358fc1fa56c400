// Linearisation at a trial state for iterations outside of the core: load stepping, arc length.
#include <algorithm>

#include "system.hpp"

namespace visviva {

bool System::linearise(const Step& step, const Signals& signals, double* residual) {
    assemble(step, signals, residual, nullptr);
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data()};
    const bool regular = refactor({step, vectors, signals}, step);
    stale_factor_ = true;  // not a tangent that time steps may keep
    return regular;
}

void System::linear_solve(const Step& step, const double* residual, double* d) {
    std::copy(residual, residual + n_, r_.begin());
    for (int u : held_) r_[u] = 0;
    std::fill(d_.begin(), d_.end(), 0.0);
    solver_->solve(r_.data(), place(step), d_.data());
    std::copy(d_.begin(), d_.begin() + n_, d);
}

std::string System::refuse(const Step& step, const Signals& signals) {
    const Vectors vectors{x.data(), x1_.data(), rate_.data(), second_rate_.data()};
    for (const auto& term : terms_)
        if (const Refusal no = term->refuse({step, vectors, signals}); !no.reason.empty()) return no.reason;
    return {};
}

}  // namespace visviva
