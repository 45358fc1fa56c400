// Multipliers that press on a node of their own leave the equations: the momentum of the node along their
// force gives them, and their constraint takes its place (Hueeber & Wohlmuth 2005; Popp et al. 2010 for
// contact with dual multipliers). What they do besides to the nodes of other such multipliers is left out of
// the equations and made up for by refining the solution with the whole matrix.
#pragma once
#include "visviva/linear/linear.hpp"

namespace visviva {

/// A multiplier, and the node that it presses on: its first unknown and how many it has.
struct NodalMultiplier {
    int multiplier, unknown, size;
};

class ContactCondensation {
  public:
    /// What presses on a node that is another one's, or is partly fixed, stays among the equations.
    ContactCondensation(const Csr& full, const std::vector<NodalMultiplier>& listed,
                        const std::vector<char>& fixed);

    const Csr& left() const { return left_; }
    const std::vector<int>& kept() const { return kept_; }
    static constexpr const char* name = ", pressures condensed";
    static constexpr const char* singular = "a contact pressure has no force on its own node";
    /// False where a multiplier has neither a force on its node nor an equation of its own.
    bool eliminate(const double* values);  // which stay where they are until the last solution with them
    const std::vector<double>& values() const { return values_; }
    /// r by unknown becomes the residual of what is left; `recover` completes its solution d of K d = -r.
    void condense(std::vector<double>& r) const;
    void recover(const double* r, double* d) const;
    int singular_unknown() const { return singular_; }
    int n() const { return static_cast<int>(nodes_.size()); }
    std::size_t n_unknowns() const { return full_->equation.size(); }
    /// Whether forces on the nodes of other multipliers were left out.
    bool is_rough() const { return rough_; }
    /// r += K d with the whole matrix, both by unknown.
    void add_product(const double* d, double* r) const;
    /// The largest of an increment's entries that are no multipliers.
    double size(const double* d) const;

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
    void choose(const std::vector<NodalMultiplier>& listed, const std::vector<char>& fixed);
    void find_forces();
    void find_pattern();
    bool read(Node& node);
    void gather(int row, const Node& node, double* out);
    void replace(Node& node);
    double along(const Node& node, const double* r) const;

    const Csr* full_;
    Csr left_;
    std::vector<int> kept_;   // full equation -> equation of what is left, or -1
    std::vector<int> owner_;  // full equation -> the node it is of, or -1
    std::vector<char> gone_;  // full equation: a multiplier that has left
    std::vector<Node> nodes_;
    std::vector<std::vector<std::pair<int, std::int64_t>>>
        feeds_;  // full equation <- nodes, and the force's place
    std::vector<double> values_;
    std::vector<std::int64_t> place_;  // by equation left
    const double* full_values_ = nullptr;
    bool rough_ = false;
    int singular_ = -1;
};

/// Exchanges, and lets another solver solve what is left.
std::unique_ptr<LinearSolver> make_exchanged(std::shared_ptr<ContactCondensation>,
                                             std::unique_ptr<LinearSolver>);

}  // namespace visviva
