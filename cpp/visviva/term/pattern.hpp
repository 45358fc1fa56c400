// The sparsity pattern of the tangent: node by node, so that a mesh of millions of entries needs no sorting
// of scalar pairs, and a block of two nodes is found once for all its entries.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "visviva/linear/csr.hpp"

namespace visviva {

/// Unknowns are grouped into nodes: consecutive unknowns that share one list of neighbours.
class Pattern {
  public:
    /// node[unknown]: first unknown of its node. Unknowns of a node without any free one vanish; fixed ones
    /// beside free ones stay in the matrix, as `held` rows that the system turns into identities.
    Pattern(const std::vector<int>& node, const std::vector<char>& fixed);

    /// Couples the nodes of two unknowns (one direction).
    void couple(int row, int col) {
        const int i = number_[row], j = number_[col];
        if (i >= 0 && j >= 0) pairs_[i].push_back(j);
    }
    /// Nodes that nothing has coupled have no equations: those of other processes.
    void leave_uncoupled();
    /// Sorts what was coupled and fills rows and columns.
    void finish(Csr& csr);
    /// Of the same unknowns, none of which has an equation.
    Pattern without_equations() const;

    /// Place of the entry (row, col) of unknowns among the values; -1 if one of them has no equation.
    std::int64_t position(int row, int col) const;
    /// Length of the rows of an unknown's node, and where the row of the unknown starts.
    std::int64_t row_length(int row) const;
    std::int64_t row_start(int row) const;
    /// All rows of the node of an unknown among the values: empty without equations.
    struct Rows {
        int node;
        std::int64_t begin, end;
    };
    Rows rows(int unknown) const;
    std::int64_t n_entries() const { return n_entries_; }
    int n_nodes() const { return static_cast<int>(first_.size()); }
    std::size_t n_unknowns() const { return number_.size(); }
    /// Equations of fixed unknowns.
    const std::vector<int>& held() const { return held_; }

  private:
    explicit Pattern(std::size_t n_unknowns) : number_(n_unknowns, -1) {}

    std::vector<int> number_, first_, size_;  // unknown -> node, node -> first unknown and number of unknowns
    std::vector<std::vector<int>> pairs_;     // per node: coupled nodes, sorted once finished
    std::vector<std::vector<int>> offset_;    // their first columns within the row
    std::vector<std::int64_t> start_, length_;
    std::vector<int> held_;
    std::int64_t n_entries_ = 0;
};

}  // namespace visviva
