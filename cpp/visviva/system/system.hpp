// Numbers the unknowns, gathers, evaluates, scatters into a pattern made once, and takes Newton's steps.
#pragma once
#include <any>
#include <exception>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "visviva/base/lap.hpp"
#include "visviva/base/unknowns.hpp"
#include "visviva/linear/linear.hpp"
#include "visviva/linear/reduce/reduction.hpp"
#include "visviva/system/monotone.hpp"
#include "visviva/system/multiplier_forces.hpp"
#include "visviva/system/predictor.hpp"
#include "visviva/system/processes.hpp"
#include "visviva/term/term.hpp"

namespace visviva {

struct NewtonOptions {
    // Largest estimated error of an accepted iterate, relative to each unknown's own scale and to the step's
    // extent.
    double tolerance = 1e-13;
    int max_iterations = 25;
    // Keep a factorisation as long as it contracts the error at least by this factor per iteration; 0: full
    // Newton.
    double keep_factor = 0.3;
    // So many iterations at the start of every step make tangents of their own.
    int n_tangents = 0;
    // A step that took more iterations than this lets the next one begin with a new factorisation.
    static constexpr int many_iterations = 4;
    /// An increment of so many sizes of the model leaves no digits for what it is to find.
    static constexpr double astray = 1e4;
    /// Forces of multipliers relative to those that balance each other in the step may be wrong by so many
    /// tolerances: as much as coordinates that are there leave to those which determine nothing.
    static constexpr double of_forces = 10;
    // Increments from which on a solution is so near that half as many iterations more are granted.
    static constexpr double near = 1e-6;
};

struct Report {
    bool converged = false;
    int iterations = 0, factorizations = 0;
    std::vector<double> increments;  // relative to the unknowns' scales
    int worst_unknown = -1;          // of the last increment, or of a singular matrix
    std::string reason;              // why not converged
};

// Intake of a held unknown over a step, from the force r that holds it: work of a position, power of a
// velocity, or an amount (heat) that the ledger counts by itself.
enum class Supply : int { work = 0, power = 1, amount = 2 };

// All that a look at a system may change, kept so that it goes on to the bit as if nobody had looked: the
// vectors, an increment that is tried among them, what a restart remembers, and what terms have evaluated.
struct Snapshot {
    std::vector<KeptUnknowns> vectors;
    Predictor predictor;
    std::vector<Record> memory;
    std::vector<std::any> evaluated, accepted;
    bool stale_begin = true;
};

// Seconds by the clock of what steps consist of; contact: terms that search for what they couple, their
// search and new patterns. And how often was solved, in how many iterations of a Krylov method.
struct Phases {
    double assembly = 0, contact = 0, factorisation = 0, solution = 0, ledger = 0;
    long n_solutions = 0, n_iterations = 0;
};

class System {
  public:
    // order 2 motion, 1 transport, 0 algebraic; scale > 0: a change of this size is large; 0: not judged.
    System(std::vector<int> order, std::vector<char> fixed, std::vector<double> scale,
           const std::vector<char>& flows = {});

    void add(std::shared_ptr<Term> term) {
        const TermCapabilities can = term->capabilities();
        terms_.push_back({std::move(term), can});
    }
    // node[unknown]: first unknown of the mesh node it belongs to, or the unknown itself.
    void set_nodes(std::vector<int> node) { node_ = std::move(node); }
    /// Place of every unknown, where nodes of several fields stand at one.
    void set_places(std::vector<int> place) { place_ = std::move(place); }
    void set_blocks(Blocks blocks) { blocks_ = std::move(blocks); }
    // Reductions of the equations before they are solved, in this order.
    void add_reduction(std::shared_ptr<Reduction> reduction) { reductions_.push_back(std::move(reduction)); }
    // island[unknown], and of accounts of constraints: what joints hold together, so that an impact goes
    // through all of it.
    void set_islands(std::vector<int> island, std::vector<int> account, std::vector<int> island_of_account) {
        island_ = std::move(island);
        constraint_account_ = std::move(account), account_island_ = std::move(island_of_account);
    }
    void set_accounts(int n_accounts, int n_components, std::vector<char> of_heat = {});
    // Before finalize(): the terms added here are some of those of the system, others have the rest.
    void set_processes(std::unique_ptr<Processes> processes) { processes_ = std::move(processes); }
    void finalize();
    // The near null space of the tangent, by unknown: rigid motions of solids, for multigrid.
    void set_modes(Modes make, int n_modes) { modes_ = std::move(make), n_modes_ = n_modes; }
    void set_solver(std::unique_ptr<LinearSolver> solver);
    // For the rates at the end of steps that project them; constraint[unknown]: multipliers of lasting
    // constraints.
    void set_rate_solver(std::unique_ptr<LinearSolver> solver, std::vector<char> constraint);
    bool projects_rates() const;
    void allow_last_resort(bool on) {
        if (auto* sequence = solver_->capabilities().sequence) sequence->allow_last_resort(on);
    }

    // One step from the accepted state; leaves the trial state, which accept() makes the new state.
    Report solve(const Step& step, const Signals& signals, const NewtonOptions& options);
    // Both in one, the ledger booked: solved, the step is accepted.
    Report advance(const Step& step, const Signals& signals, const NewtonOptions& options);
    void set_signal_count(std::size_t n) { n_signals_ = n, no_signals_.assign(n, 0.0); }
    Signals no_signals() const {
        const double* zero = no_signals_.data();
        return {zero, zero, zero, zero};
    }
    // Multipliers that Newton's method judges by the forces they make.
    void set_judged(const std::vector<int>& multipliers) {
        is_judged_.assign(n_, 0);
        for (int u : multipliers) is_judged_[u] = 1;
    }
    // Unknowns of order 0 that may only grow, see Monotone; their tangents are never kept.
    void set_monotone(std::vector<int> unknowns) { monotone_.set(std::move(unknowns)); }
    /// There are cracks, whatever keeps them from healing, in bodies with inertia or in some that have none.
    void set_cracking(bool all_have_mass) { cracks_ = true, cracks_have_mass_ = all_have_mass; }
    // Those of them that rest at the trial state.
    std::vector<int> resting() const { return monotone_.resting(); }
    // Unknowns [n] that take no part in what is linearised from now on; none where empty.
    void halt(const std::vector<char>& halted) { monotone_.halt(halted, dx.data()); }
    // Whether the tangent factored last is of those that rest by the residual evaluated last.
    bool is_settled() const { return !monotone_.has_changed(); }
    // Of each account at the trial state.
    std::vector<double> trial_energies(const Step& step, const Signals& signals);
    // Fixed unknowns that move as prescribed, or through which something flows: their increments are put into
    // dx before a step is solved, and what they take in is booked on these accounts.
    void set_prescribed(std::vector<int> unknown, std::vector<int> account, std::vector<Supply> supply) {
        prescribed_ = std::move(unknown), prescribed_account_ = std::move(account),
        supply_ = std::move(supply);
    }
    // Entropy is the sum of unknowns with weights; equations that add up to its balance, and the accounts on
    // which what is stored is booked with what the terms of the body let go (-1: none). What its shape
    // function counts for in the whole is next to nothing of a light one, as of corners of quadratic
    // triangles.
    struct Entropy {
        std::vector<int> tested, unknown;
        std::vector<double> weight;
        std::vector<int> account, light;
    };
    void set_entropy(Entropy entropy) { entropy_ = std::move(entropy); }
    // Multipliers of constraints that functions of time drive, and where the work of each is booked.
    void set_drives(std::vector<int> multiplier, std::vector<int> account) {
        drives_ = std::move(multiplier), drive_account_ = std::move(account);
    }
    // Increments of some unknowns at which the iteration of the next step begins.
    void begin_at(std::vector<int> unknown, std::vector<double> increment) {
        guessed_ = std::move(unknown), guess_ = std::move(increment);
    }
    // Makes the increment of a solved step the new state; one that has no rates at its end has not converged.
    [[nodiscard]] Report accept(const Step& step, const Signals& signals, bool ledger);
    // Gives up the trial state: nothing is left of what terms evaluated there.
    void discard();
    // The ledger of the present state (no work done).
    // `moves`: the rates are velocities, and not what is left of them in statics.
    void evaluate_ledger(const Step& step, const Signals& signals, bool moves);
    // All that decides the bits of the coming steps besides x, v, a, w: predictor history, and the state at
    // which the kept factorisation was made, each part by name. Restoring makes that factorisation again, and
    // refuses names and versions that this system would not write.
    std::vector<Record> memory() const;
    void restore(const std::vector<Record>& memory);
    // The part of it that holds whatever the next steps are.
    std::vector<double> histories() const;
    void restore_histories(const std::vector<double>& histories);
    // For looks at other states, with the factorisation made again that is kept.
    Snapshot snapshot();
    void restore_snapshot(const Snapshot& snapshot);
    // After the state vectors were changed from outside; nothing is forgotten if they are as they were left.
    void invalidate() {
        if (!is_unchanged()) forget();
    }
    // What the state vectors are now is that of the step accepted last.
    void mark_state() { marked_[0] = x, marked_[1] = v, marked_[2] = a, marked_[3] = w; }
    // Whether the state vectors are those with which the last step has ended.
    bool is_unchanged() const {
        return marked_[0] == x && marked_[1] == v && marked_[2] == a && marked_[3] == w;
    }

    // Lets the terms look for new neighbours between the state and the trial state; true if the pattern is
    // another one from now on.
    bool find_neighbours() { return find_neighbours(0, 0); }
    // Residual and tangent at the trial state x0 + dx, for checks and special solves.
    void assemble(const Step& step, const Signals& signals, double* residual, double* values);

    // Residual and factorised tangent at the trial state, and solutions with it, for iterations other than
    // Newton's loop; false if the tangent is singular.
    bool linearise(const Step& step, const Signals& signals, double* residual);
    // Whether terms are on another branch than that tangent, or the pattern is another one, by the residual
    // evaluated last.
    bool is_outdated() const { return revision_ != factored_revision_ || has_branched(); }
    // False if the linear solver failed; its message says why. `tolerance`: see LinearSolver.
    bool linear_solve(const Step& step, const double* residual, double* d, double tolerance);
    // Whether an increment is no smaller than the one before it because the residual that it answers to, by
    // the tangent factored last, is rounding: no iteration gets nearer.
    bool meets_rounding(const double* residual, double size, double last) const;
    // Of the tangent factored last.
    double asymmetry() const;
    // Why the trial state is no solution though its residual may vanish; empty if it can be one.
    std::string refuse(const Step& step, const Signals& signals);

    // The residual of the step accepted last: at fixed unknowns, the force that holds them. Terms outside the
    // core have to know what they knew when that step began.
    void forces(const Step& step, const Signals& signals, double* residual);

    // Has the solver find redundant constraints at the trial state, and handle them from then on; returns how
    // many it found (0 from solvers that cannot). Without `on` it forgets them.
    int find_redundant(const Step& step, const Signals& signals, bool on);
    bool solve_instant(const Step& now, const Signals& signals, const double* residual, double* a);

    int n() const { return n_; }
    const Csr& csr() const { return csr_; }
    // The equations that the linear solver gets.
    // The pattern of what is assembled, before reductions.
    const Csr& assembled() const { return csr_; }
    const Csr& solved() const { return reductions_.empty() ? csr_ : reductions_.back()->left(); }
    const std::vector<std::shared_ptr<Reduction>>& reductions() const { return reductions_; }
    int revision() const { return revision_; }     // of the pattern
    double rewiring() const { return rewiring_; }  // CPU seconds for new ones
    // From now on the phases are timed, which takes microseconds of a step.
    void profile(bool on) { profiles_ = on; }
    const Phases& phases() const { return phases_; }
    const LinearSolver* solver() const { return solver_.get(); }

    // State by unknown: configuration, increment of the trial step, rate and the schemes' further history.
    Unknowns x, dx, v, a, w;
    LedgerSums sums;  // of the last accepted step

  private:
    void forget() {
        stale_begin_ = stale_factor_ = true, contraction_ = contraction_of_forces_ = 1, noise_ = 0,
        iterations_last_ = 0, predictor_.forget();
        mean_.clear();
    }
    void find_held(const Pattern&);
    void rewire();
    std::string memory_name(std::size_t term) const;
    void refuse_unknown(const std::vector<Record>& memory) const;
    void recall(const std::vector<Record>& memory);
    void return_to(Past);
    void make_again(const Record& tangent);
    Record tangent_record() const;
    std::vector<std::any> evaluations() const;
    void restore_evaluations(const std::vector<std::any>&);
    std::vector<Unknowns*> looked_at();
    std::vector<Record> memory_of_parts() const;
    void prepare_predictor();
    /// Whether motion is extrapolated nowhere: in statics, and where something cracks under steps that do not
    /// keep their energy, or without inertia.
    bool starts_still(const Step& step) const {
        return step.is_static() ||
               (cracks_ && !(cracks_have_mass_ && step.stress == Stress::discrete_gradient));
    }
    void predict(const Step&);
    bool find_neighbours(double theta, double h);
    bool extend_prescribed_motion(const Context&);
    void start(const Step&);
    bool renew_tangent(const Context&, bool assembled);
    std::string singular() const;
    Report failed(Report, const std::string& reason, int unknown);
    Refusal refusal(const Context&);
    Report succeeded(Report, const Context&, bool renewed);
    Report unfinished(Report, double last, bool arrived);
    std::string lost(const Step&, double size) const;
    double finest_search() const;
    void clear_values();
    void set_base_rates(const Step&);
    void take_off_excess(const Context&);
    void update_vectors(const Step&);
    void update_rates(const Step&);
    bool end_of_step(const Step&, int k, const Unknowns& now, Unknowns& next);
    Report finish(Report, const Step&, const Signals&, bool ledger);
    void analyze_rates();
    void evaluate_lasting(const Context&);
    void keep_weightless();
    void evaluate_rate_matrix(const Context&);
    void evaluate_rate_residual(const Unknowns& impulse, const Unknowns& change);
    Unknowns constraint_impulse(const Context&, const Unknowns& without);
    void add_later(const Context&, double later, double factor, Unknowns& d);
    void drift(const Context&, double h, Unknowns& d);
    bool solve_rates(const Context&, const Context& instant);
    bool project_rates(const Context&);
    void take_rates(const Step&);
    std::vector<double> constraint_rates(const Context&, double h, const Unknowns& at, const Unknowns& rates);
    void book_drives(const Context&, const Context& end, const Unknowns& rates);
    void evaluate(const Step&, const Signals&, bool with_mesh_tangents);
    void evaluate_residual(const Context&, bool all, bool with_mesh_tangents = false);
    void evaluate_tangent(const Context&, bool has_mesh_tangents);
    bool refactor(const Context&, const Step&, bool has_mesh_tangents = false);
    bool has_branched() const;
    bool update_tangent(const Context&);
    int worst() const;
    double extent(double h) const;
    double iterate(const Step&);
    double limit_correction();  // shortens d_ by the share that it returns
    void weigh_constraints();
    double constraint_error() const;
    double in_roundings(const double* residual) const;
    int worst_constraint() const;
    Place place(const Step& step) const { return {x.data(), x1_.data(), step.theta_g}; }
    void clear_sums();
    void book(const Context&, const double* v1);
    void book_step(const Context&, const double* v1, double direction);
    void book_path(const Context&);
    std::vector<double> brought_entropy(const Context&);
    void book_impacts(const Context&, const double* v1);
    void record_mean(const Step&);
    template <class F>
    static std::exception_ptr attempt(F&& f) {
        try {
            f();
        } catch (...) {
            return std::current_exception();
        }
        return nullptr;
    }
    // Processes go on after failures, which others need not have: terms that all of them evaluate remember
    // the same then.
    template <class F>
    std::exception_ptr for_each_term(F&& f) {
        std::exception_ptr first;
        for (const Part& part : terms_)
            if (const auto failure = attempt([&] { f(part); }); failure && !first) {
                first = failure;
                if (!processes_) break;
            }
        return first;
    }
    void add_up(std::span<double> values, const std::exception_ptr& failure);
    void add_up(LedgerSums&, const std::exception_ptr& failure);
    void agree(const std::exception_ptr& failure, bool any) const;
    void agree(Refusal& no) const;
    void meet();
    bool any(bool here) const;
    bool is_own(int unknown) const { return !processes_ || own_[unknown]; }
    bool searching(bool here) const { return searches_ && any(here); }
    double largest(double here) const;
    void total(std::vector<double>& parts) const;
    std::vector<double> diagonal() const;
    bool solve_for(LinearSolver&, const Step&, double tolerance);
    bool share(bool solved);
    struct ForceSize {
        double change = 0, stiffest = 0;  // relative to the forces that balance each other
    };
    ForceSize relative_force(double change);

    int n_ = 0, revision_ = 0, factored_revision_ = -1;
    double rewiring_ = 0;
    bool profiles_ = false;
    Phases phases_;
    double* timed(double Phases::* phase) { return profiles_ ? &(phases_.*phase) : nullptr; }
    std::vector<int> order_;
    std::vector<char> fixed_;
    std::vector<double> inverse_scale_;
    struct Part {
        std::shared_ptr<Term> term;
        TermCapabilities can;
    };
    double* timed(const Part& part) { return timed(part.can.search ? &Phases::contact : &Phases::assembly); }
    bool factor(const Step& step);
    bool factor_by(LinearSolver& solver, const Step& step);
    bool solve_increment(const Step& step, double tolerance);
    std::vector<Part> terms_;
    Blocks blocks_;
    void describe_nodes();
    void find_judged();
    Modes modes_;
    int n_modes_ = 0;
    std::vector<int> island_, constraint_account_, account_island_;
    std::vector<int> node_, place_, held_;  // held: fixed unknowns with equations
    std::vector<int> prescribed_, prescribed_account_, drives_, drive_account_;
    std::vector<double> drive_work_;  // of each drive, by the projection of the rates of this step
    std::vector<Supply> supply_;
    std::vector<char> heat_account_;  // [account]
    Entropy entropy_;
    std::vector<std::int64_t> held_zero_, held_one_;
    Csr csr_;
    std::vector<std::pair<std::int64_t, std::int64_t>> zeros_;  // values that no term sets to zero
    std::vector<std::shared_ptr<Reduction>> reductions_;
    std::unique_ptr<LinearSolver> solver_, rate_solver_;    // null where rates cannot be projected here
    RigidSolver *rigid_ = nullptr, *rate_rigid_ = nullptr;  // of these, if they keep bodies rigid
    std::vector<char> constraint_;
    std::vector<std::int64_t> rate_zero_, rate_one_;
    int rate_revision_ = -1;
    struct Segment {
        int begin, end, order;  // unknowns of equal order in a row
        bool flows;             // velocities of flows
        auto table(const Step& step) const -> const double (&)[5][4] {
            return order == 2 ? step.motion : flows ? step.flow : step.transport;
        }
    };
    std::vector<Segment> segments_;
    bool needs_rates_ = false;
    Unknowns x1_, rate_, second_rate_, base_rate_, base_second_, r_;
    std::vector<double> d_, values_, rate_values_;
    std::vector<double> constraint_weight_;  // by unknown; zero for what is no constraint
    Unknowns v_next_, a_next_, w_next_;      // of the step being accepted
    std::vector<int> guessed_;               // unknowns
    std::vector<double> guess_;              // of their increments in the next one
    Unknowns still_;                         // the velocities of statics, none
    Unknowns last_[5];                       // x, dx, v, a, w of the step accepted last
    std::vector<double> mean_;               // rate of that step, where velocities swing; or none
    Unknowns marked_[4];                     // x, v, a, w at its end
    std::vector<std::any> accepted_;         // what terms evaluated in it
    double contraction_ = 1, contraction_of_forces_ = 1, noise_ = 0;
    std::vector<char> is_judged_;  // by unknown
    MultiplierForces multiplier_forces_;
    int iterations_last_ = 0, n_fixed_ = 0;
    Predictor predictor_;
    bool cracks_ = false, cracks_have_mass_ = false;
    Monotone monotone_;
    bool searches_ = false;                 // whether a term of any process does
    std::unique_ptr<Processes> processes_;  // null where this one is alone
    std::vector<char> own_;                 // by unknown: whether it belongs to this process
    bool stale_begin_ = true, stale_factor_ = true;
    bool updated_ = false;  // the kept tangent has parts of another configuration
    Step factored_;
    std::vector<double> factored_state_;    // x, dx, v, a, w when the kept factorisation was made
    std::vector<double> factored_signals_;  // the prescribed functions of time then
    std::size_t n_signals_ = 0;
    std::vector<double> no_signals_;
};

}  // namespace visviva
