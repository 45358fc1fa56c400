// Unknowns that linear constraints give by others (the nodes of a tied surface, those of an immersed solid)
// leave the equations together with the constraints' multipliers. The multiplier's row tells how they move,
// dx = T dx_left, its column where the forces on them go; what is left is L^T K T, with L = T where the
// column is the row.
#pragma once
#include "visviva/linear/reduce/reduction.hpp"

namespace visviva {

/// An unknown that the constraint of a multiplier gives, and that by no other such unknown of its own node.
struct Dependence {
    int unknown, multiplier;
};

class SlaveElimination : public Reduction {
  public:
    /// Fixed unknowns among the others do not move. A dependence that meets an earlier one (it depends on
    /// what that gives, or gives what that depends on) stays among the equations.
    explicit SlaveElimination(std::vector<Dependence> dependences);

    void analyze(const Csr& full, const std::vector<char>& fixed, const std::vector<int>& node) override;
    bool reduce(const double* values) override;
    void condense(std::vector<double>& r) override;
    void recover(const double* r, double* d) const override;
    /// Number of unknowns eliminated.
    int n() const { return static_cast<int>(given_.size()); }

  private:
    struct Part {
        int equation;  // of what is left
        int link;      // factors, or -1 for one
    };
    // From a given unknown to one of those it moves with.
    struct Link {
        int other;              // equation of the full system
        std::int64_t row, col;  // places of the constraint's weights
        double moves, loads;    // factors in T and L
    };
    struct Given {
        int equation, multiplier;  // of the full system
        std::int64_t row, col;     // places of its own weights in the constraint
        int begin, end;            // links
    };
    // Of K T
    struct Row {
        int equation;  // of the full system
        std::vector<int> col;
        std::vector<double> value;
    };
    void choose(const std::vector<char>& fixed, const std::vector<int>& node);
    void expand();
    void read_factors();
    double moves(const Part& p) const { return p.link < 0 ? 1.0 : links_[p.link].moves; }
    double loads(const Part& p) const { return p.link < 0 ? 1.0 : links_[p.link].loads; }
    void find_pattern();
    void make_rows(std::vector<int>& seen);
    void multiply(Row& row);
    double along(int row, const std::vector<double>& d) const;

    std::vector<Dependence> dependences_;
    std::vector<Given> given_;
    std::vector<Link> links_;
    std::vector<std::vector<Part>> parts_;  // full equation -> what it moves with; empty: a multiplier
    std::vector<std::vector<Part>> feeds_;  // equation of what is left <- full equations
    std::vector<char> plain_;               // ... whether its row is copied as it is
    std::vector<int> touched_;              // full equations that couple with given unknowns
    std::vector<Row> rows_;                 // those that rows which are not plain are made of
    std::vector<int> row_of_;               // full equation -> its row, or -1
    std::vector<double> own_;               // what given unknowns move by themselves, by equation
    std::vector<std::int64_t> place_;
    const double* full_values_ = nullptr;
};

}  // namespace visviva
