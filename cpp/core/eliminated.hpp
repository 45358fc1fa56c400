// Unknowns that constant linear constraints give by others (the nodes of a tied surface) leave the equations
// together with the constraints' multipliers: with dx = T dx_left what is left is T^T K T.
#pragma once
#include "linear.hpp"

namespace visviva {

/// weight * x[unknown] + sum of weights * x[others] = 0, the multiplier's column being this row.
struct Dependence {
    int unknown, multiplier;
    double weight;
    std::vector<int> others;
    std::vector<double> weights;
};

class Elimination {
  public:
    /// Fixed unknowns among the others do not move. A dependence that meets an earlier one (it depends on
    /// what that gives, or gives what that depends on) stays among the equations.
    Elimination(const Csr& full, const std::vector<Dependence>& dependences, const std::vector<char>& fixed);

    const Csr& left() const { return left_; }
    const std::vector<int>& kept() const { return kept_; }
    static constexpr const char* name = ", tied nodes eliminated";
    static constexpr const char* singular = "";  // it always succeeds
    bool eliminate(const double* values);  // which stay where they are until the last solution with them
    const std::vector<double>& values() const { return values_; }
    /// r by unknown becomes the residual of what is left; `recover` completes its solution d of K d = -r.
    void condense(std::vector<double>& r);
    void recover(const double* r, double* d) const;
    int singular_unknown() const { return -1; }
    int n() const { return static_cast<int>(given_.size()); }
    std::size_t n_unknowns() const { return full_->equation.size(); }

  private:
    struct Part {
        int equation;  // of what is left
        double factor;
    };
    struct Given {
        int equation, multiplier;  // of the full system
        double weight;
        std::vector<int> others;  // equations of the full system
        std::vector<double> factors;
    };
    void choose(const std::vector<Dependence>& dependences, const std::vector<char>& fixed);
    void number();
    void expand();
    void find_pattern();
    double along(int row, const std::vector<double>& d) const;

    const Csr* full_;
    Csr left_;
    std::vector<int> kept_;  // full equation -> equation of what is left, or -1
    std::vector<Given> given_;
    std::vector<std::vector<Part>> parts_;  // full equation -> what it moves with; empty: a multiplier
    std::vector<std::vector<Part>> feeds_;  // equation of what is left <- full equations and factors
    std::vector<char> plain_;               // ... whether its row is copied as it is
    std::vector<int> touched_;              // full equations that couple with given unknowns
    std::vector<double> values_, own_;      // own_: what given unknowns move by themselves, by equation
    std::vector<std::int64_t> place_;
    const double* full_values_ = nullptr;
};

/// Eliminates, and lets another solver solve what is left.
std::unique_ptr<LinearSolver> make_eliminated(std::shared_ptr<Elimination>, std::unique_ptr<LinearSolver>);

}  // namespace visviva
