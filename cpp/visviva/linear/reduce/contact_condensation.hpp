// Multipliers that press on a node of their own leave the equations: the momentum of the node along their
// force gives them, and their constraint takes its place (Hueeber & Wohlmuth 2005; Popp et al. 2010 for
// contact with dual multipliers). What they do besides to the nodes of other such multipliers is left out of
// the equations and made up for by refining the solution with the whole matrix.
#pragma once
#include <Eigen/Core>

#include "visviva/linear/reduce/reduction.hpp"

namespace visviva {

/// A multiplier, and the node that it presses on: its first unknown and how many it has.
struct NodalMultiplier {
    int multiplier, unknown, size;
};

class ContactCondensation : public Reduction {
  public:
    /// What presses on a node that is another one's, or is partly fixed, stays among the equations.
    explicit ContactCondensation(std::vector<NodalMultiplier> multipliers);

    void analyze(const Csr& full, const std::vector<char>& fixed, const std::vector<int>& node) override;
    /// Fails where a multiplier has neither a force on its node nor an equation of its own.
    bool reduce(const double* values) override;
    void condense(std::vector<double>& r) override;
    void recover(const double* r, double* d) const override;
    bool solve(const double* r, const Place& place, double* d, LinearSolver& rest, double tolerance) override;
    /// Number of multipliers eliminated.
    int n() const { return static_cast<int>(nodes_.size()); }
    /// Whether forces on the nodes of other multipliers were left out.
    bool is_rough() const { return rough_; }

  private:
    static constexpr int largest_node = 3;
    // A multiplier's own node.
    struct Node {
        int multiplier, n, equation[largest_node];  // equations of the full system
        std::int64_t square, column[largest_node];  // places of the multiplier's own entry and of its force
        std::vector<int> col;                 // equations left that the node and the constraint couple with
        std::vector<std::int64_t> elsewhere;  // places of its forces on others' nodes
        std::vector<std::pair<int, std::int64_t>> on;  // other equations that feel it, and where
        // With the force b and e = b / |b|^2: e . rows of the node; the constraint's row, times `scale`.
        double b[largest_node] = {}, squared = 0, own = 0, scale = 1;
        std::vector<double> along, constraint;
    };
    void choose(const std::vector<char>& fixed);
    void find_forces();
    void find_pattern();
    bool read(Node& node);
    void gather(int row, const Node& node, double* out);
    void replace(Node& node);
    double along(const Node& node, const double* r) const;
    bool refine(const double* r, const Place& place, double* d, LinearSolver& rest, double allowed);
    double measure(const double* r, const double* d, double allowed);
    Eigen::VectorXd multipliers(const Eigen::VectorXd& d) const;

    std::vector<NodalMultiplier> multipliers_;
    std::vector<int> owner_;  // full equation -> the node it is of, or -1
    std::vector<char> gone_;  // full equation: a multiplier that has left
    std::vector<Node> nodes_;
    std::vector<std::vector<std::pair<int, std::int64_t>>>
        feeds_;                        // full equation <- nodes, and the force's place
    std::vector<std::int64_t> place_;  // by equation left
    const double* full_values_ = nullptr;
    bool rough_ = false;
    std::vector<double> residual_, terms_;  // while a solution is refined
};

}  // namespace visviva
