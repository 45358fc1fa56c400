// Data of a gap's contact in a step that the passage of heat needs.
#pragma once
#include <Eigen/Dense>

#include "visviva/contact/gaps.hpp"

namespace visviva {

/// The pressure, the heat that friction has made over the step, and the areas by which the stencil's vertices
/// take part; with derivatives, where wanted, by the positions of the stencil's vertices at the end of the
/// step, and by the multipliers of pressure and traction (three, those that there are).
struct Passage {
    bool active = false;
    double pressure = 0, rubbed = 0, pressure_by_multiplier = 0;
    Eigen::RowVectorXd pressure_by_place;
    Eigen::RowVectorXd rubbed_by_place;
    Eigen::RowVector3d rubbed_by_multiplier = Eigen::RowVector3d::Zero();
    Eigen::VectorXd weight;           // of the second surface positive, of the first negative
    Eigen::MatrixXd weight_by_place;  // [vertex][3 k]
};

}  // namespace visviva
