// A term is a batch of equal stencils that returns residual and tangent over a step, and its share of the
// ledger.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aligned.hpp"
#include "inertia.hpp"
#include "step.hpp"
#include "strain.hpp"

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
    // Keeps what the last evaluation has left, which may be shown; and brings it back after others.
    virtual void hold() {}
    virtual void release() {}
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

// A law evaluated outside the core, at batch level. Arrays are [n_e][stride] and so on, element-fastest.
struct LawArguments {
    int n, stride, n_e, n_m;
    bool want_tangent;
    double t, h;
    Stress stress;
    const double *e0, *e1, *e_eval, *e_rate, *lambda;
    double *S, *D, *R, *Phi, *J, *Jt, *W;
};
using LawCallback = std::function<void(const LawArguments&)>;

class StrainTerm : public Term {
  public:
    // Arrays are given element-fastest without padding: weight [n_forms][n] and so on.
    StrainTerm(StrainShape shape, int n, const int* index, const double* weight, const double* y_const,
               const double* e_const, const double* par, int n_par, const int* signal);
    void set_callback(LawCallback f) { callback_ = std::move(f); }
    const StrainShape& shape() const { return shape_; }
    double* par() { return par_.data(); }
    int stride() const { return view_.stride; }

    void pattern(std::vector<std::pair<int, int>>& entries) const override;
    void set_positions(const std::int64_t* positions) override;
    std::int64_t n_entries() const override { return static_cast<std::int64_t>(slots_.size()) * view_.n; }
    void begin(const double* x0) override;
    bool wants_rates() const override { return needs_rate(shape_.law); }
    void residual(const Context&, double* r) override;
    Refusal refuse(const Context&) override;
    void tangent(const Context&, double* values) override;
    void inner_tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;

  private:
    void make_program();
    void call_back(const Context&, bool want_tangent);

    StrainShape shape_;
    StrainView view_;
    LawCallback callback_;
    Aligned<double> weight_, y_const_, e_const_, par_, y0_, e0_, e_eval_, e_rate_, e1_, lambda_;
    Aligned<double> cb_S_, cb_D_, cb_R_, cb_Phi_, cb_J_, cb_Jt_, cb_W_, scratch_, out_;
    std::vector<int> index_, signal_, pairs_;
    std::vector<std::pair<int, int>> slots_;  // local (row, column) of every tangent entry
    std::vector<Product> products_;
    std::vector<Border> columns_, rows_;
    Aligned<std::int64_t> position_;
};

class InertiaTerm : public Term {
  public:
    InertiaTerm(int order, int n_nodes, int dim, int n, std::vector<int> pair, const double* mass,
                const int* index, std::vector<char> is_position);
    void pattern(std::vector<std::pair<int, int>>& entries) const override;
    void set_positions(const std::int64_t* positions) override;
    std::int64_t n_entries() const override;
    bool wants_rates() const override { return view_.order == 1; }
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;

  private:
    InertiaView view_;
    std::vector<int> pair_, index_;
    std::vector<char> is_position_;
    Aligned<double> mass_, out_;
    Aligned<std::int64_t> position_;
};

// A whole term from outside: dense local tangents, element-slowest arrays [n][n_local].
struct TermArguments {
    const Step* step;
    const double *x0, *x1, *rate, *second_rate;  // gathered, [n][n_local]
    double *residual, *tangent;                  // [n][n_local], [n][n_local][n_local] or null
    double *energy, *work, *momentum;            // [n], [n], [n][6], for the ledger
    const double* v1;                            // ledger only
    const double* v0;                            // rates at the start of the step
};

class CallbackTerm : public Term {
  public:
    using Function = std::function<void(const TermArguments&)>;
    CallbackTerm(int n, int n_local, const int* index, Function residual, Function tangent, Function ledger,
                 Function accept);
    int work_account = -1;  // where work is booked that is done beside what is stored; -1: none

    void pattern(std::vector<std::pair<int, int>>& entries) const override;
    void set_positions(const std::int64_t* positions) override;
    std::int64_t n_entries() const override { return static_cast<std::int64_t>(n_) * nl_ * nl_; }
    bool wants_rates() const override { return true; }
    bool sees_clock() const override { return true; }
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;
    void accept(const Context&) override;

  private:
    TermArguments gather(const Context&);
    int n_, nl_;
    std::vector<int> index_;
    Function residual_, tangent_, ledger_, accept_;
    std::vector<double> x0_, x1_, rate_, second_rate_, v1_, v0_, r_, k_, energy_, work_, momentum_;
    std::vector<std::int64_t> position_;
};

}  // namespace visviva
