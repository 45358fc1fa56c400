// The tangent as a matrix of equal blocks, one per node; nodes that have fewer free unknowns are filled up
// with equations of nothing (a unit diagonal).
#pragma once
#include <limits>

#include "visviva/linear/block_rows.hpp"
#include "visviva/linear/linear.hpp"

namespace visviva {

// y = A x, shared out among threads
void multiply(const BlockRows<double>& a, const double* x, double* y);

class NodeMatrix {
  public:
    // `single`: products in single precision, half the traffic, where they need no more than a few digits.
    // `level`: rows of constraints are multiplied by the stiffness along them, so that one measure tells of
    // both kinds of residual: the shorter the step, the larger the forces that close the same gap.
    // `borrow_from`: from that many equations on values stay where fill() found them, as a second copy takes
    // much memory and saves a tenth of the time; not of matrices with constraints or pressures.
    explicit NodeMatrix(bool single = false, bool level = false, int borrow_from = never)
        : is_single_(single), levels_(level), borrow_from_(borrow_from) {}
    static constexpr int never = std::numeric_limits<int>::max();
    void analyze(const Csr& pattern, const Blocks& blocks);
    bool fill(const double* values);  // false: some value is not finite

    const BlockRows<double>& blocks() const { return a_; }  // without values where it borrows them
    bool borrows() const { return borrows_; }
    BlockReader reader() const;
    std::size_t size() const { return a_.size(); }
    std::vector<double> modes() const;  // [slot][n_modes], made for this call
    int n_modes() const { return blocks_of_->n_modes; }
    const std::vector<char>& algebraic() const { return algebraic_; }  // by block row
    // By slot, and what no equation fills.
    enum class Kind : char { filling, differential, algebraic };
    const std::vector<Kind>& kinds() const { return kinds_; }
    void multiply(const double* x, double* y) const;
    void multiply_double(const double* x, double* y) const;  // whatever the precision of others

    // -r from the unknowns into slots, and slots back to the unknowns.
    void gather(const double* r, double* b) const;
    void scatter(const double* x, double* d) const;

  private:
    void partition(const std::vector<int>& node, const std::vector<int>& place);
    void make_pattern();
    void fill(int b, const double* values, double* to) const;
    bool is_finite(int b, const double* values) const;
    void level(int b);
    bool share_columns(int b) const;
    void copy_single(int b, const double* from);
    void multiply_single(const double* x, double* y) const;
    void multiply_borrowed(const double* x, double* y) const;

    const Csr* csr_ = nullptr;
    const Blocks* blocks_of_ = nullptr;
    BlockRows<double> a_;
    bool is_single_, levels_, borrows_ = false;
    int borrow_from_;
    const double* values_ = nullptr;  // borrowed, by the pattern
    std::vector<double> level_;       // by block row
    BlockRows<float> single_;
    double scale_ = 1;  // of the numbers in it
    mutable std::vector<float> x_, y_;
    mutable std::vector<double> by_equation_;
    std::vector<int> slot_;   // of every equation
    std::vector<int> order_;  // equations in the order of block rows
    std::vector<int> first_;  // of every block row in that order, and n
    std::vector<char> algebraic_;
    std::vector<Kind> kinds_;
    std::vector<int> block_;    // block row of every equation
    std::vector<char> shared_;  // by block row: its rows have the same columns
};

}  // namespace visviva
