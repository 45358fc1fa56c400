// A term is a batch of equal stencils that returns residual and tangent over a step, and its share of the
// ledger.
#pragma once
#include <any>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "visviva/term/record.hpp"
#include "visviva/term/step.hpp"

namespace visviva {

struct Context {
    const Step& step;
    const Vectors& vectors;
    const Signals& signals;
    // The books of statics go the step from its end to its start too: forces are then those that it began
    // with.
    bool backwards = false;
    // A solver keeps rigid bodies rigid: tangents of rigidity come without rows and columns of multipliers.
    bool keeps_rigidity = false;
};

// Bodies that collide in a step, by some of their unknowns: what its impulse and friction have booked less
// than their forces do along the increments of the scheme, and on which account the impulse is booked.
struct Impact {
    int account = -1;
    double pressed = 0, rubbed = 0;
    std::vector<int> unknowns;
};

// Sums of the ledger; `energy`, `work` per account, `momentum` [6] and `defect` [2] per component; in
// statics `release` per unknown, the work of what held it out of equilibrium when the step began; `entropy`
// per account, brought in the step.
struct LedgerSums {
    std::vector<double> energy, work, momentum, defect, release, entropy;
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

// Of terms on meshes, whose tangents may come with their residuals, before those of other terms. They set the
// rows to zero that they are the first to add to, just before they do.
class MeshAssembly {
  public:
    virtual ~MeshAssembly() = default;
    // From now on clears the rows of all its nodes but those marked in `cleared` [node of the pattern], which
    // it marks.
    virtual void clear_rows(const Pattern&, std::vector<char>& cleared) = 0;
    virtual void linearise(const Context&, double* r, double* values) = 0;
};

// Of terms whose neighbours are found anew as they move, and whose residual has branches.
class NeighbourSearch {
  public:
    virtual ~NeighbourSearch() = default;
    // Before a step; true if the coupling has changed.
    virtual bool find_neighbours(const Way&) = 0;
    // Whether the last residual was on another branch than the last tangent.
    virtual bool is_outdated() const = 0;
    // Brings a kept tangent to the branch of the last residual, if that changes a part alone; false: it does
    // not.
    virtual bool update_tangent(const Context&, double* /*values*/) { return false; }
    // Relative increments below which its residual may jump, so that they do not shrink any further.
    virtual double resolution() const { return 0; }
};

// A moment in the past whose history a term may take: when the step accepted last began, or when the
// tangent asked for last was made.
enum class Past : int { step, tangent };

// Of terms that a restart needs more of than the unknowns, under a name and with the version of its layout.
class TermMemory {
  public:
    TermMemory(std::string name, int version) : record_name(std::move(name)), record_version(version) {}
    virtual ~TermMemory() = default;
    const std::string record_name;
    const int record_version;
    virtual void write_memory(std::vector<double>&) const = 0;
    // Moves on in the memory; true if the coupling has changed.
    virtual bool read_memory(const double*& memory) = 0;
    // Result of the last evaluation, which may be shown and decides the forces of its step; and brings it
    // back after others.
    virtual std::any evaluation() const { return {}; }
    virtual void restore_evaluation(const std::any&) {}
};

// Of terms with a state of their own that steps change, as internal variables of materials: a part of their
// memory that holds whatever the next steps are.
class TermHistory {
  public:
    virtual ~TermHistory() = default;
    virtual void write_history(std::vector<double>&) const = 0;
    virtual void read_history(const double*& history) = 0;  // moves on
    virtual void return_to(Past) = 0;
};

// Of terms that know how far an iteration may go at once, or beyond what it may not go.
class IterationLimit {
  public:
    virtual ~IterationLimit() = default;
    // The share, at most 1, of the correction d that may be subtracted from x1.
    virtual double share(const double* x1, const double* d) const = 0;
};

// Optional abilities of a term; none by default.
struct TermCapabilities {
    MeshAssembly* mesh = nullptr;
    NeighbourSearch* search = nullptr;
    TermMemory* memory = nullptr;
    TermHistory* history = nullptr;
    IterationLimit* limit = nullptr;
};

// A term has to couple its unknowns, to find their places, and to give residual, tangent and its share of the
// ledger. Terms of scalar entries start from EntryTerm.
class Term {
  public:
    virtual ~Term() = default;
    virtual void couple(Pattern&) const = 0;
    virtual void connect(const Pattern&) = 0;
    virtual void residual(const Context&, double* r) = 0;
    virtual void tangent(const Context&, double* values) = 0;
    virtual void ledger(const Context&, const double* v1, LedgerSums&) = 0;
    virtual void begin(const double* /*x0*/) {}
    // Asked after convergence, about the last residual.
    virtual Refusal refuse(const Context&) { return {}; }
    virtual void accept(const Context&) {}
    // After a step, whose end is now x: brings unknowns that belong to where the scheme evaluates forces to
    // the end.
    virtual void finish_step(const Step&, double* /*x*/) {}
    virtual TermCapabilities capabilities() { return {}; }

    std::string name;            // for messages
    bool is_inertia = false;     // constant masses alone
    bool is_rigidity = false;    // orthonormality of rigid bodies, which a solver may keep by itself
    bool is_lasting = true;      // may have a part in the rates at an instant: in mass or lasting constraints
    bool needs_rates = false;    // looks at the rates of its unknowns
    bool sees_clock = false;     // may depend on time otherwise than by signals
    bool is_shown = false;       // results are read from it: in each of several processes
    int entropy_account = -1;    // where entropy is booked that it brings to the equations that balance it
    std::vector<int> account;    // per element: where its energy and work are booked
    std::vector<int> component;  // per element: whose momentum and defect it is
};

}  // namespace visviva
