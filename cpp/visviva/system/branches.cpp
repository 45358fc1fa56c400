// Terms whose neighbours change, and whose residuals have branches. Where processes share them, all go on
// alike.
#include <algorithm>

#include "visviva/base/lap.hpp"
#include "visviva/base/stopwatch.hpp"
#include "visviva/base/vector_dispatch.hpp"
#include "visviva/system/system.hpp"

namespace visviva {

// The coupling has changed: a new pattern.
void System::rewire() {
    const Stopwatch watch(rewiring_);
    finalize();
    describe_nodes();
    find_judged();
    solver_->analyze(csr_, blocks_);
    stale_factor_ = true;
}

bool System::find_neighbours(double theta, double h) {
    const double* rate = mean_.empty() ? v.data() : mean_.data();
    vector_kernels().affine(n_, 1.0, dx.data(), x.data(), x1_.data());
    bool changed = false;
    for (const Part& part : terms_) {
        const Lap lap(timed(part));
        if (part.can.search && part.can.search->find_neighbours({x.data(), x1_.data(), rate, theta, h}))
            changed = true;
    }
    changed = searching(changed);
    if (changed) {
        const Lap lap(timed(&Phases::contact));
        rewire(), stale_begin_ = true;
    }
    return changed;
}

bool System::has_branched() const {
    return searching(std::any_of(terms_.begin(), terms_.end(),
                                 [](const Part& p) { return p.can.search && p.can.search->is_outdated(); }));
}

// Where terms are on another branch, the kept tangent may need other rows and columns alone.
bool System::update_tangent(const Context& c) {
    stale_factor_ = true;
    const bool other = std::any_of(terms_.begin(), terms_.end(), [&](const Part& p) {
        return p.can.search && p.can.search->is_outdated() &&
               !p.can.search->update_tangent(c, values_.data());
    });
    if (searching(other)) return false;
    for (auto k : held_zero_) values_[k] = 0;
    updated_ = true;
    return factor(c.step);
}

double System::finest_search() const {
    double resolution = 0;
    for (const auto& [term, can] : terms_)
        if (can.search) resolution = std::max(resolution, can.search->resolution());
    return searches_ ? largest(resolution) : resolution;
}

}  // namespace visviva
