#pragma once
// Contribution of each part of the binding to the module.
#include <nanobind/nanobind.h>

void bind_terms(nanobind::module_& m);
void bind_solid(nanobind::module_& m);
void bind_point(nanobind::module_& m);
void bind_contact(nanobind::module_& m);
void bind_flow(nanobind::module_& m);
void bind_immersed(nanobind::module_& m);
void bind_step(nanobind::module_& m);
void bind_linear(nanobind::module_& m);
void bind_system(nanobind::module_& m);
