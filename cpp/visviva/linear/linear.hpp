// Linear solvers of the Newton iteration: a pattern once, then factor and solve many times.
#pragma once
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
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

// Natural blocks of the unknowns for block elimination: `block[unknown]` (or -1) and the stage of each block
// (0: has inertia, 1: multipliers and massless coordinates, 2: multipliers between stage-1 blocks).
struct Blocks {
    std::vector<int> block, stage;
    std::vector<char> multiplier;  // per unknown: 1 where a redundant constraint may be regularised
    std::vector<RigidUnknowns> rigid;
    // For iterative solvers: the first equation of every node and n at the end (empty: every equation alone),
    std::vector<int> node;
    // and what the tangent hardly resists, for multigrid: [equation][n_modes], rigid-body modes of solids.
    std::vector<double> modes;
    int n_modes = 0;
    std::vector<char> algebraic;  // per equation: constraints and pressures, without inertia
    std::vector<double> scale;    // per equation: a large change of its unknown, 0 for forces (empty: 1)
};

// Factors that would not fit into memory; said before they are made.
struct MemoryShortage : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class LinearSolver {
  public:
    virtual ~LinearSolver() = default;
    virtual void analyze(const Csr& pattern, const Blocks& blocks) = 0;
    // Before the first iteration: bring a predicted configuration where the solver wants it.
    virtual void project(const double* /*x0*/, double* /*dx*/) {}
    // Before a tangent is assembled: bring the multipliers of rigidity into balance with the residual r, so
    // that they do not lag one iteration behind and the tangent is exact.
    virtual void balance(const double* /*r*/, const Place& /*place*/, double* /*dx*/, double* /*x1*/) {}
    // The values stay where and as they are until the next factorisation: it may have to be made again.
    virtual bool factor(const double* values, const Place& place) = 0;
    // From the residual r to the increment d, both by unknown (fixed entries untouched). False: not solved.
    virtual bool solve(const double* r, const Place& place, double* d) = 0;
    // The same for rates, of which d holds all and not the increment.
    virtual bool solve_rates(const double* r, const Place& place, double* d) { return solve(r, place, d); }
    // Why the last factorisation or solution failed, or what was notable about it.
    virtual std::string message() const { return {}; }
    // Of the last solution; direct solvers need none.
    virtual int n_iterations() const { return 0; }
    // Negative eigenvalues of the factored matrix, where the solver knows them, else -1.
    virtual int n_negative() const { return -1; }
    // Bytes that the factors or the preconditioner take, where known.
    virtual double memory() const { return 0; }
    // The relative residual that the next solution may leave, if the solver's own tolerance is less.
    virtual void aim(double /*residual*/) {}
    // Let go of what was kept from earlier values: the next solution depends on its own matrix alone.
    virtual void forget() {}
    // Whether solvers that are a last resort may take over where others fail.
    virtual void allow_last_resort(bool /*on*/) {}
    // What decides which solver serves, for a restart.
    virtual std::vector<double> state() const { return {}; }
    virtual void set_state(const std::vector<double>&) {}
    // After a failed factorisation: one unknown of the singular part, or -1.
    virtual int singular_unknown() const { return -1; }
    // Redundant constraints: `on`, the next factorisation finds out where they are, to be handled from then
    // on.
    virtual void find_redundant(bool /*on*/) {}
    virtual int n_redundant() const { return 0; }
    // Whether it keeps rigid bodies rigid by itself: r then comes without their orthonormality constraints.
    virtual bool keeps_rigidity() const { return false; }
    virtual std::string name() const = 0;
    double regularization = 0;
};

// `careful`: the first matrix is tested for being singular to working precision, which pivots do not show.
std::unique_ptr<LinearSolver> make_sparse_lu(bool careful = false);
std::unique_ptr<LinearSolver> make_null_space();

}  // namespace visviva
