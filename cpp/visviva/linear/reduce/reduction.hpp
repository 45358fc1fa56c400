// A linear solver around another one: some equations leave before the others are solved.
#pragma once
#include "visviva/linear/linear.hpp"

namespace visviva {

/// Numbers the equations of `full` that are not gone as those of `left`, whose pattern is still to be found.
/// By equation of `full`: its equation there, or -1.
std::vector<int> number_left(const Csr& full, const std::vector<char>& gone, Csr& left);

/// Place of an entry among the values of a matrix; -1 where it has none.
std::int64_t place_of(const Csr& csr, int row, int col);

/// Blocks of what is left, with the numbers of `number_left`.
Blocks left_blocks(const Blocks& blocks, const std::vector<int>& kept, int n_left);

/// What takes equations out: see ElementCondensation and SlaveElimination.
template <class Reduction>
class Reduced : public LinearSolver {
  public:
    Reduced(std::shared_ptr<Reduction> reduction, std::unique_ptr<LinearSolver> solver)
        : reduction_(std::move(reduction)), solver_(std::move(solver)) {}

    void analyze(const Csr&, const Blocks& blocks) override {
        blocks_ = left_blocks(blocks, reduction_->kept(), reduction_->left().n);
        solver_->analyze(reduction_->left(), blocks_);
    }
    bool factor(const double* values, const Place& place) override {
        regular_ = reduction_->eliminate(values);
        return regular_ && solver_->factor(reduction_->values().data(), place);
    }
    bool solve(const double* r, const Place& place, double* d) override {
        right_.assign(r, r + reduction_->n_unknowns());
        right_.push_back(0.0);  // element slots of nothing may point there
        reduction_->condense(right_);
        if (!solver_->solve(right_.data(), place, d)) return false;
        reduction_->recover(r, d);
        return true;
    }

    void project(const double* x0, double* dx) override { solver_->project(x0, dx); }
    void balance(const double* r, const Place& place, double* dx, double* x1) override {
        solver_->balance(r, place, dx, x1);
    }
    std::string message() const override { return regular_ ? solver_->message() : Reduction::singular; }
    int n_iterations() const override { return solver_->n_iterations(); }
    int n_negative() const override { return solver_->n_negative(); }  // of what is left
    double memory() const override { return solver_->memory(); }
    void aim(double residual) override { solver_->aim(residual); }
    void forget() override { solver_->forget(); }
    void allow_last_resort(bool on) override { solver_->allow_last_resort(on); }
    std::vector<double> state() const override { return solver_->state(); }
    void set_state(const std::vector<double>& s) override { solver_->set_state(s); }
    int singular_unknown() const override {
        return regular_ ? solver_->singular_unknown() : reduction_->singular_unknown();
    }
    void find_redundant(bool on) override { solver_->find_redundant(on); }
    int n_redundant() const override { return solver_->n_redundant(); }
    bool keeps_rigidity() const override { return solver_->keeps_rigidity(); }
    std::string name() const override { return solver_->name() + Reduction::name; }

  private:
    std::shared_ptr<Reduction> reduction_;
    std::unique_ptr<LinearSolver> solver_;
    Blocks blocks_;
    std::vector<double> right_;
    bool regular_ = true;
};

}  // namespace visviva
