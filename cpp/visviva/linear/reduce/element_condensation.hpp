// Unknowns that one element alone touches (enhanced strains, pressures without neighbours) leave the
// equations before these are solved: K_uu - K_ua K_aa^-1 K_au, and their increments follow from those of the
// others.
#pragma once
#include "visviva/linear/reduce/reduction.hpp"

namespace visviva {

class ElementCondensation : public Reduction {
  public:
    /// element[unknown]: to which element the unknown is local, or -1. An element's own unknowns follow each
    /// other; they couple with what this element couples, and with no other element's.
    explicit ElementCondensation(std::vector<int> element);

    void analyze(const Csr& full, const std::vector<char>& fixed, const std::vector<int>& node) override;
    bool reduce(const double* values) override;
    void condense(std::vector<double>& r) override;
    void recover(const double* r, double* d) const override;

  private:
    struct Element {
        int unknown, n, n_outer;      // first own unknown, how many, and with how many others they couple
        std::int64_t own;             // where the own columns start among the values of the own first row
        std::size_t outer, runs;      // first entries of outer_ and of place_
        std::size_t inverse, follow;  // ... of inverse_, and of follow_ and lead_
    };
    struct Run {
        int first, size;  // outer unknowns of consecutive equations
    };
    void find_pattern();
    void describe_all();
    void describe(Element& e);
    bool eliminate(const Element& e, const double* values);
    void subtract(const Element& e);
    std::int64_t place(const Csr& csr, int row, int col) const;
    void copy(const double* values);

    std::vector<int> element_;
    std::vector<char> local_;  // by equation of the full system
    std::vector<Element> elements_;
    std::vector<int> outer_;            // equations of the full system that elements couple with
    std::vector<std::int64_t> column_;  // beside outer_: where own columns start in that row
    std::vector<std::vector<Run>> runs_;
    std::vector<std::int64_t> place_;  // per outer row and run: where it starts in values_
    // A = K_aa^-1 [n][n], X = K_aa^-1 K_au [n][n_outer], C = K_ua [n_outer][n]
    std::vector<double> inverse_, follow_, lead_;
};

}  // namespace visviva
