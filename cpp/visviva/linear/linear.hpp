// Linear solvers of the Newton iteration: a pattern once, then factor and solve many times.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "visviva/linear/csr.hpp"
#include "visviva/linear/place.hpp"

namespace visviva {

// A rigid body for the null-space reduction: position (3), directors (9) and the multipliers (6) of its
// orthonormality, all as unknown numbers.
struct RigidUnknowns {
    int q[12];
    int multiplier[6];
};

// Puts modes of some rows, [row][n_modes], where zeros are; those of a row below zero stay so.
using Modes = std::function<void(const std::vector<int>& rows, double* to)>;

// Those of a part of the rows, by their numbers in it.
inline Modes rows_of(Modes all, std::vector<int> part) {
    return [all = std::move(all), part = std::move(part)](std::vector<int> rows, double* to) {
        for (int& row : rows) row = row < 0 ? row : part[row];
        all(rows, to);
    };
}

// Natural blocks of the unknowns for block elimination: `block[unknown]` (or -1) and the stage of each block
// (0: has inertia, 1: multipliers and massless coordinates, 2: multipliers between stage-1 blocks).
struct Blocks {
    std::vector<int> block, stage;
    std::vector<char> multiplier;  // per unknown: 1 where a redundant constraint may be regularised
    std::vector<RigidUnknowns> rigid;
    // For iterative solvers: the first equation of every node and n at the end (empty: every equation alone),
    std::vector<int> node;
    // the place of every equation, where nodes of several fields stand at one (empty: every node alone),
    std::vector<int> place;
    // and what the tangent hardly resists, for multigrid: [equation][n_modes], rigid-body modes of solids.
    // They are made anew when they are asked for, being half as large as a tangent.
    Modes modes = [](const std::vector<int>&, double*) {};
    int n_modes = 0;
    std::vector<char> algebraic;  // per equation: constraints and pressures, without inertia
    std::vector<double> scale;    // per equation: a large change of its unknown, 0 for forces (empty: 1)
};

// Factors that would not fit into memory; said before they are made.
struct MemoryShortage : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Report of a solver: itself, its last factorisation, its last solution.
struct LinearReport {
    std::string name;           // of what serves at present
    std::string message;        // why it failed, or what was notable
    int singular_unknown = -1;  // after a failed factorisation: one of the singular part, if known
    int n_iterations = 0;       // of the last solution; direct solvers need none
    double tolerance = 0;       // the relative residual that it was allowed to leave; rounding
    int n_negative = -1;        // eigenvalues of the factored matrix below zero, if known
    int n_redundant = 0;        // constraints, of those that were asked for
    double memory = 0;          // bytes that factors or preconditioner take, if known
};

// A solver that keeps rigid bodies rigid by itself: residuals come without their orthonormality constraints.
class RigidSolver {
  public:
    virtual ~RigidSolver() = default;
    // Before the first iteration: brings a predicted configuration where the solver wants it.
    virtual void project(const double* x0, double* dx) = 0;
    // Before a tangent is assembled: brings the multipliers of rigidity into balance with the residual r, so
    // that they do not lag one iteration behind and the tangent is exact.
    virtual void balance(const double* r, const Place& place, double* dx, double* x1) = 0;
    // From the residual r to rates, of which d holds all and not the increment.
    virtual bool solve_rates(const double* r, const Place& place, double* d) = 0;
    // Redundant constraints: `on`, the next factorisation finds out where they are, to be handled from then
    // on.
    virtual void find_redundant(bool on) = 0;
};

// Several solvers, of which one serves.
class SolverSequence {
  public:
    virtual ~SolverSequence() = default;
    // Memory that decides which one, for a restart.
    virtual std::vector<double> state() const = 0;
    virtual void set_state(const std::vector<double>&) = 0;
    // Whether those that are a last resort may take over where others fail.
    virtual void allow_last_resort(bool on) = 0;
};

// Optional abilities of a solver; none by default.
struct LinearCapabilities {
    RigidSolver* rigid = nullptr;
    SolverSequence* sequence = nullptr;
};

class LinearSolver {
  public:
    virtual ~LinearSolver() = default;
    // The pattern and the blocks stay where and as they are until the next analysis.
    virtual void analyze(const Csr& pattern, const Blocks& blocks) = 0;
    // The values stay where and as they are until the next factorisation: it may have to be made again.
    virtual bool factor(const double* values, const Place& place) = 0;
    // From the residual r to the increment d, both by unknown (fixed entries untouched). False: not solved.
    // `tolerance`: the relative residual that may be left, if the solver's own tolerance is less.
    virtual bool solve(const double* r, const Place& place, double* d, double tolerance) = 0;
    // Lets go of what was kept from earlier values: the next solution depends on its own matrix alone.
    virtual void forget() {}
    virtual LinearCapabilities capabilities() { return {}; }
    const LinearReport& report() const { return report_; }

    double regularization = 0;

  protected:
    LinearReport report_;
};

// `careful`: the first matrix is tested for being singular to working precision, which pivots do not show.
// Factors that need more bytes than the limit (0: what is available) are refused.
std::unique_ptr<LinearSolver> make_sparse_lu(bool careful = false, double memory_limit = 0);
std::unique_ptr<LinearSolver> make_null_space();

}  // namespace visviva
