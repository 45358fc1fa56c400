#pragma once
#include <nanobind/nanobind.h>

void bind_linear(nanobind::module_& m);
void bind_point(nanobind::module_& m);
void bind_contact(nanobind::module_& m);
void bind_flow(nanobind::module_& m);
void bind_immersed(nanobind::module_& m);
