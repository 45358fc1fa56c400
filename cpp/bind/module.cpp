// The Python binding. Arrays cross as contiguous float64; everything a user sees is defined in Python.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "parts.hpp"
#include "visviva/base/instructions.hpp"
#include "visviva/base/parallel.hpp"

namespace nb = nanobind;
using namespace visviva;

NB_MODULE(_core, m) {
    m.doc() = "Compiled core of visviva; use the package, not this module.";
    nb::set_leak_warnings(false);  // systems that somebody still holds at exit are no news to users
    bind_terms(m);
    bind_solid(m);
    bind_point(m);
    bind_contact(m);
    bind_flow(m);
    bind_immersed(m);
    bind_step(m);
    bind_linear(m);
    bind_system(m);
    instructions();                 // refuses those that are not there as soon as the module is loaded
    m.def("instruction_sets", [] {  // the narrowest first
        std::vector<std::string> names;
        for (const Instructions set : available()) names.emplace_back(name(set));
        return names;
    });
    m.def("n_threads", &n_threads);
    m.def("use_threads", &use_threads);
    m.def("instruction_set", [] { return std::string(name(instructions())); });
}
