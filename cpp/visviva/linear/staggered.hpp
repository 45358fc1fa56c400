// A linear solver for two parts of the equations in turn.
#pragma once
#include "visviva/linear/linear_choice.hpp"

namespace visviva {

/// Mechanics while entropies rest, then heat while positions do, by solvers of their own, until what each
/// leaves to the other is small (block Gauss & Seidel).
std::unique_ptr<LinearSolver> make_staggered(const LinearChoice&);

}  // namespace visviva
