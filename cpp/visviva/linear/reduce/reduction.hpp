// Equations that leave before the others are solved, and whose unknowns come back from those of the others.
#pragma once
#include <functional>

#include "visviva/linear/linear.hpp"

namespace visviva {

class Reduction {
  public:
    /// name: what it does, for the description of the solver; singular: why it may fail.
    Reduction(const char* name, const char* singular) : name_(name), singular_(singular) {}
    virtual ~Reduction() = default;
    /// Finds out what leaves the equations of a pattern, which stays where it is; anew for every other one.
    /// By unknown: whether it is fixed, and the first unknown of its node, see Pattern.
    virtual void analyze(const Csr& full, const std::vector<char>& fixed, const std::vector<int>& node) = 0;
    /// Makes the values of what is left from those of the full pattern, which stay where they are until the
    /// last solution with them. False: it cannot, see `message` and `singular_unknown`.
    virtual bool reduce(const double* values) = 0;
    /// r by unknown becomes the residual of what is left; `recover` completes its solution d of K d = -r.
    virtual void condense(std::vector<double>& r) = 0;
    virtual void recover(const double* r, double* d) const = 0;
    /// d of K d = -r, where `rest` solves what is left.
    virtual bool solve(const double* r, const Place& place, double* d, LinearSolver& rest, double tolerance);

    /// The pattern of what is left, in which unknowns that have left have no equation, and its values.
    const Csr& left() const { return left_; }
    const std::vector<double>& values() const { return values_; }
    /// Equation of the full pattern -> equation of what is left, or -1.
    const std::vector<int>& kept() const { return kept_; }
    const char* name() const { return name_; }
    /// Why it failed; empty if it did not.
    const std::string& message() const { return message_; }
    int singular_unknown() const { return singular_unknown_; }

  protected:
    void number_left(const Csr& full, const std::vector<char>& gone);
    /// Fails at an unknown.
    bool fail_at(int unknown) {
        message_ = singular_, singular_unknown_ = unknown;
        return false;
    }

    const Csr* full_ = nullptr;
    Csr left_;
    std::vector<int> kept_;
    std::vector<double> values_;
    std::string message_;
    int singular_unknown_ = -1;
    std::vector<double> right_;  // by unknown: the residual of what is left, of the last solution

  private:
    const char *name_, *singular_;
};

/// Place of an entry among the values of a matrix; -1 where it has none.
std::int64_t place_of(const Csr& csr, int row, int col);

/// A solver of equations of which some leave before `rest` solves the others. The reduction has to be
/// analysed before the solver is. It has succeeded if all agree, where others reduce a part too.
std::unique_ptr<LinearSolver> make_reduced(
    std::shared_ptr<Reduction>, std::unique_ptr<LinearSolver> rest,
    std::function<bool(bool here)> agree = [](bool here) { return here; });

}  // namespace visviva
