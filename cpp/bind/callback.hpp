#pragma once
#include <nanobind/nanobind.h>

#include "visviva/term/law_callback.hpp"

/// A function of Python, which owns it, as the core calls it: f(n, want_tangent, t, h, discrete, arrays).
visviva::LawCallback law_callback(nanobind::object function);
