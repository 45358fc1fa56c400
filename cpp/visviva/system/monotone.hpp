// Unknowns that may only grow, as damage does: in a step either one grows and its equation holds, or it rests
// and a force that is not negative holds it back from shrinking. Which of them rest is chosen in the
// iterations, as by primal-dual active sets (Hintermueller, Ito & Kunisch 2003). Besides, unknowns that are
// halted from outside take no part, for iterations that go to and fro between fields.
#pragma once
#include <algorithm>
#include <functional>
#include <vector>

#include "visviva/linear/linear.hpp"

namespace visviva {

class Monotone {
  public:
    void resize(int n) { halted_.assign(n, 0), rests_.assign(n, 0), returns_.assign(n, 0); }
    /// Unknowns that only grow; all rest at first.
    void set(std::vector<int> unknowns);
    bool any() const { return !unknowns_.empty(); }
    /// Halts unknowns [n], or none where empty; of the others those rest that have not grown yet.
    void halt(const std::vector<char>& halted, const double* dx);
    bool acts() const { return any() || halts_; }

    void begin_step() {
        std::fill(returns_.begin(), returns_.end(), 0);
        advances_ = 0, changed_ = false;
    }
    /// A step ends with what rests now, or is given up.
    void accept() { accepted_ = rests_; }
    void discard() {
        if (any() && !accepted_.empty()) rests_ = accepted_;
        begin_step();
    }
    /// Let unknowns that shrink rest from now on; returns whether an increment was changed.
    bool project(double* dx);
    /// Lets go what a negative force holds, by the residual and the tangent's diagonal, both by unknown.
    /// Where that happens again and again a front advances, and twice as many layers of neighbours each time
    /// are let go along; `total` adds up over processes, each of which knows some of the neighbours.
    using Total = std::function<void(std::vector<double>&)>;
    void release(const double* r, const double* diagonal, const Csr& csr, const Total& total);
    /// Make rows and columns of resting unknowns those of the identity; halted ones are coupled to nothing
    /// else.
    void mask(const Csr& csr, double* values) const;
    void clear(double* r) const;
    bool is_masked(int unknown) const { return rests_[unknown] || halted_[unknown]; }
    /// Whether the last look at increments or residual has changed what rests.
    bool has_changed() const { return changed_; }
    /// Increments that are negative by rounding.
    void clip(double* dx) const;

    std::vector<int> resting() const;
    std::vector<double> flags() const;
    void set_flags(const std::vector<double>& flags);

  private:
    static constexpr double rounding = 1e-13;  // of increments that count as none
    /// So often a front advances by itself. What has come to rest again `doubt` times in a step is no longer
    /// let go along with its neighbours; what did so `patience` times is let go one unknown at a time, so
    /// that it ends.
    static constexpr int waits = 4, doubt = 3, patience = 5;
    bool is_pressed(int u, const double* r, const double* diagonal) const;
    /// One layer further; whether there was one.
    bool spread(std::vector<char>& freed, const Csr& csr, const Total& total);
    std::vector<int> unknowns_;
    std::vector<char> halted_, rests_, accepted_;  // [n]
    bool halts_ = false, changed_ = false;
    std::vector<int> returns_;  // [n], to rest in this step
    int advances_ = 0;          // since something came to rest again
};

}  // namespace visviva
