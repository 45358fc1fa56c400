// Where a contact's tangent goes: blocks of the vertices' nodes, and rows and columns of multipliers.
#pragma once
#include <Eigen/Dense>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "visviva/contact/gaps.hpp"
#include "visviva/term/pattern.hpp"

namespace visviva {

class ContactScatter {
  public:
    // Tangent of a gap's multipliers: by the stencil's positions, and on its forces.
    struct Border {
        Eigen::MatrixXd row, column, square;
    };
    // First unknowns of every gap's multipliers: of its pressure, and of friction in the tangent plane;
    // empty: it has none.
    ContactScatter(std::shared_ptr<const Gaps> gaps, std::vector<int> normal, std::vector<int> tangential);

    int n_multipliers() const { return (normal_.empty() ? 0 : 1) + n_tangential(); }
    int n_tangential() const { return tangential_.empty() ? 0 : gaps_->skin().dim - 1; }
    std::vector<int> multipliers(int gap) const;
    void couple(Pattern& pattern) const;
    void connect(const Pattern& pattern);

    // Subtracts K, [i][j] by the stencil's positions.
    void subtract_stiffness(int gap, const double* K, double* values);
    // Adds a border; that of a gap without contact is its square alone.
    void add_border(int gap, const Border&, bool active, double* values);
    // No border has been added yet to the values; or those that have been are set to zero.
    void forget_borders() { border_places_.clear(); }
    void clear_borders(double* values);

  private:
    // Where a gap's part of the tangent is among the values.
    struct Places {
        bool known = false;
        std::vector<int> stencil;
        std::vector<std::int64_t> blocks, border;
    };
    void couple_vertices(Pattern& pattern) const;
    const Places& places(int gap);

    std::shared_ptr<const Gaps> gaps_;
    std::vector<int> normal_, tangential_;
    std::optional<Pattern> pattern_;
    std::vector<Places> places_;
    std::vector<std::int64_t> border_places_;  // what borders have been added to
};

}  // namespace visviva
