// Directors of constant length leave the equations with the multipliers that hold it: increments are those of
// the tangent plane of the sphere, dx = T dx_left, and balances are taken in the plane in which that
// multiplier has no force, L^T K T (Betsch & Leyendecker 2006). The bases come from the multiplier's own row
// and column, so that L belongs to the place of the step at which the scheme takes the gradients of
// constraints.
#pragma once
#include "visviva/linear/reduce/reduction.hpp"

namespace visviva {

/// The first of the three unknowns of a vector, and the multiplier that holds its length.
struct HeldLength {
    int unknown, multiplier;
};

class DirectorElimination : public Reduction {
  public:
    /// The multiplier acts on the vector alone. What is fixed of a vector does not move; one whose unknowns
    /// or multiplier left before, or are all fixed, stays as it is.
    explicit DirectorElimination(std::vector<HeldLength> lengths);

    void analyze(const Csr& full, const std::vector<char>& fixed, const std::vector<int>& node) override;
    /// Fails where a multiplier does not act on its vector.
    bool reduce(const double* values) override;
    void condense(std::vector<double>& r) override;
    void recover(const double* r, double* d) const override;
    /// Number of multipliers eliminated.
    int n() const { return static_cast<int>(directors_.size()); }

  private:
    struct Plane {
        double normal[3], squared, basis[3][2];
    };
    struct Director {
        int n, equation[3], multiplier;  // free components, equations of the full system
        std::int64_t row[3], col[3];     // places of the gradient in the multiplier's row and column
        Plane moves, loads;              // T and L
        double own;                      // increment along the gradient of the constraint, by its square
    };
    void choose(const HeldLength& length, const std::vector<char>& fixed);
    bool acts_on_node(const HeldLength& length, const std::vector<int>& node) const;
    bool alike(int i, int j) const;
    void find_pattern();
    void find_places();
    bool read_planes();
    void add_row(int i, int at, const double* loads);
    double along(int row, const std::vector<double>& d) const;

    std::vector<HeldLength> lengths_;
    std::vector<Director> directors_;
    std::vector<int> owner_,
        component_;  // full equation -> the director it is of, or -1, and which component
    std::vector<char> gone_;
    std::vector<int> place_;    // beside the full pattern: first place within the row of what is left, or -1
    std::vector<int> touched_;  // full equations that couple with directors
    const double* full_values_ = nullptr;
    std::vector<double> own_;  // by full equation
    std::vector<double> sum_;  // a row on its way
};

}  // namespace visviva
