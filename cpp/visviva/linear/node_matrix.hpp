// The tangent as a matrix of equal blocks, one per node; nodes that have fewer free unknowns are filled up
// with equations of nothing (a unit diagonal).
#pragma once
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
    explicit NodeMatrix(bool single = false, bool level = false) : is_single_(single), levels_(level) {}
    void analyze(const Csr& pattern, const Blocks& blocks);
    bool fill(const double* values);  // false: some value is not finite

    const BlockRows<double>& blocks() const { return a_; }
    std::size_t size() const { return a_.size(); }
    const std::vector<double>& modes() const { return modes_; }  // [slot][n_modes]
    int n_modes() const { return n_modes_; }
    const std::vector<char>& algebraic() const { return algebraic_; }  // by block row
    // By slot, and what no equation fills.
    enum class Kind : char { filling, differential, algebraic };
    const std::vector<Kind>& kinds() const { return kinds_; }
    void multiply(const double* x, double* y) const;

    // -r from the unknowns into slots, and slots back to the unknowns.
    void gather(const double* r, double* b) const;
    void scatter(const double* x, double* d) const;

  private:
    void partition(const std::vector<int>& node, const std::vector<int>& place);
    void make_pattern();
    bool fill(int b, const double* values);
    void level(int b);
    void copy_single(int b);
    void multiply_single(const double* x, double* y) const;

    const Csr* csr_ = nullptr;
    BlockRows<double> a_;
    bool is_single_, levels_;
    std::vector<double> level_;  // by block row
    BlockRows<float> single_;
    double scale_ = 1;  // of the numbers in it
    mutable std::vector<float> x_, y_;
    std::vector<int> slot_;   // of every equation
    std::vector<int> order_;  // equations in the order of block rows
    std::vector<int> first_;  // of every block row in that order, and n
    std::vector<double> modes_;
    std::vector<char> algebraic_;
    std::vector<Kind> kinds_;
    std::vector<int> block_;  // block row of every equation
    int n_modes_ = 0;
};

}  // namespace visviva
