// A term is a batch of equal stencils that returns residual and tangent over a step, and its share of the
// ledger.
#pragma once
#include <any>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "visviva/term/step.hpp"

namespace visviva {

struct Context {
    const Step& step;
    const Vectors& vectors;
    const Signals& signals;
    // The books of statics go the step from its end to its start too: forces are then those that it began
    // with.
    bool backwards = false;
};

// Bodies that collide in a step, by some of their unknowns: what its impulse and friction have booked less
// than their forces do along the increments of the scheme, and on which account the impulse is booked.
struct Impact {
    int account = -1;
    double pressed = 0, rubbed = 0;
    std::vector<int> unknowns;
};

// What the ledger adds up; `energy`, `work` per account, `momentum` [6] and `defect` [2] per component; in
// statics `release` per unknown, the work of what held it out of equilibrium when the step began.
struct LedgerSums {
    std::vector<double> energy, work, momentum, defect, release;
    std::vector<Impact> impacts;
};

class Pattern;

// Where a step goes, as far as that is known before it is solved: its start and its end, extrapolated from
// the steps before. What decides where a step ends has to follow from its start and its rate alone: the
// velocities there, or where these swing from step to step the mean ones of the step before.
struct Way {
    const double *x0, *x1, *rate;
    double theta = 0, h = 0;  // both zero outside of steps
};

// Why a converged step is no solution; empty if it is one.
struct Refusal {
    int unknown = -1;
    std::string reason;
};

class Term {
  public:
    virtual ~Term() = default;
    // Terms on meshes couple whole nodes and find their places by themselves.
    virtual void couple(Pattern&) const {}
    virtual void connect(const Pattern&) {}
    // Before a step: looks for new neighbours; true if the coupling has changed.
    virtual bool search(const Way&) { return false; }
    // Whether the last residual was on another branch than the last tangent.
    virtual bool outdated() const { return false; }
    // Brings a kept tangent to the branch of the last residual, if that changes a part alone; false: it does
    // not.
    virtual bool amend(const Context&, double* /*values*/) { return false; }
    // What a restart needs besides the unknowns; reading moves on in the memory, true if the coupling has
    // changed.
    virtual void write_memory(std::vector<double>&) const {}
    virtual bool read_memory(const double*& /*memory*/) { return false; }
    // What the last evaluation has left, which may be shown and decides the forces of its step; and brings
    // it back after others.
    virtual std::any evaluation() const { return {}; }
    virtual void restore_evaluation(const std::any&) {}
    // Relative increments below which its residual may jump, so that they do not shrink any further.
    virtual double resolution() const { return 0; }
    // Asked after convergence, about the last residual.
    virtual Refusal refuse(const Context&) { return {}; }
    // (row, column) unknowns of every tangent entry, in the order of `positions`.
    virtual void pattern(std::vector<std::pair<int, int>>& entries) const = 0;
    virtual void set_positions(const std::int64_t* positions) = 0;
    virtual std::int64_t n_entries() const = 0;
    virtual void begin(const double* /*x0*/) {}
    virtual bool wants_rates() const { return false; }
    virtual void residual(const Context&, double* r) = 0;
    virtual void tangent(const Context&, double* values) = 0;
    // Terms on meshes, whose tangents may come with their residuals, before those of other terms. They set
    // the rows to zero that they are the first to add to, just before they do: the rows of all their nodes
    // but those marked in `cleared` [node of the pattern], which they mark.
    virtual bool is_first() const { return false; }
    virtual void clear_rows(const Pattern&, std::vector<char>& /*cleared*/) {}
    virtual void linearise(const Context& c, double* r, double* values) {
        residual(c, r), tangent(c, values);
    }
    // The tangent without rows and columns of multipliers.
    virtual void inner_tangent(const Context& c, double* values) { tangent(c, values); }
    virtual void ledger(const Context&, const double* v1, LedgerSums&) = 0;
    virtual void accept(const Context&) {}
    // Whether it may have a part in the rates at an instant: in mass or in lasting constraints.
    virtual bool is_lasting() const { return true; }
    // Whether it may depend on time otherwise than by signals.
    virtual bool sees_clock() const { return false; }
    // After a step, whose end is now x: brings unknowns that belong to where the scheme evaluates forces to
    // the end.
    virtual void settle(const Step&, double* /*x*/) {}

    std::string name;            // for messages
    bool is_inertia = false;     // constant masses alone
    bool is_rigidity = false;    // orthonormality of rigid bodies, which a solver may keep by itself
    std::vector<int> account;    // per element: where its energy and work are booked
    std::vector<int> component;  // per element: whose momentum and defect it is
};

}  // namespace visviva
