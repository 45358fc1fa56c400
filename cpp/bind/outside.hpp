#pragma once
// Solvers and processes written in Python.
#include <nanobind/nanobind.h>

#include "visviva/linear/linear_choice.hpp"
#include "visviva/system/processes.hpp"

/// Solvers made by a function of Python.
visviva::OutsideSolver outside_solver(nanobind::object make);
std::unique_ptr<visviva::Processes> outside_processes(nanobind::object processes);
