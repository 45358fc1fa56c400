// Unknowns that may only grow, as damage does: in a step either one grows and its equation holds, or it rests
// and a force that is not negative holds it back from shrinking. Which of them rest is chosen in the
// iterations, as by primal-dual active sets (Hintermueller, Ito & Kunisch 2003). Besides, unknowns that are
// halted from outside take no part, for iterations that go to and fro between fields.
#pragma once
#include <vector>

#include "visviva/linear/linear.hpp"

namespace visviva {

class Monotone {
  public:
    void resize(int n) { halted_.assign(n, 0), rests_.assign(n, 0); }
    /// Unknowns that only grow; all rest at first.
    void set(std::vector<int> unknowns);
    bool any() const { return !unknowns_.empty(); }
    /// Halts unknowns [n], or none where empty; of the others those rest that have not grown yet.
    void halt(const std::vector<char>& halted, const double* dx);
    bool acts() const { return any() || halts_; }

    void begin_step() { changes_ = 0, changed_ = false; }
    /// A step ends with what rests now, or is given up.
    void accept() { accepted_ = rests_; }
    void discard() {
        if (any() && !accepted_.empty()) rests_ = accepted_;
        begin_step();
    }
    /// Let unknowns that shrink rest from now on; returns whether an increment was changed.
    bool project(double* dx);
    /// Lets go what a negative force holds, by the residual and the tangent's diagonal, both by unknown.
    void release(const double* r, const double* diagonal);
    /// Make rows and columns of resting unknowns those of the identity; halted ones are coupled to nothing
    /// else.
    void mask(const Csr& csr, double* values) const;
    void clear(double* r) const;
    bool is_masked(int unknown) const { return rests_[unknown] || halted_[unknown]; }
    /// Whether the last look at increments or residual has changed what rests.
    bool has_changed() const { return changed_; }
    /// Increments that are negative by rounding.
    void clip(double* dx) const;

    std::vector<double> flags() const;
    void set_flags(const std::vector<double>& flags);

  private:
    static constexpr double rounding = 1e-13;  // of increments that count as none
    static constexpr int patience = 10;        // changes, after which one unknown at a time is let go
    std::vector<int> unknowns_;
    std::vector<char> halted_, rests_, accepted_;  // [n]
    bool halts_ = false, changed_ = false;
    int changes_ = 0;
};

}  // namespace visviva
