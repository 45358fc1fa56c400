// Binding of steps of time.
#include "arrays.hpp"
#include "parts.hpp"
#include "visviva/system/system.hpp"

using namespace visviva;

static void tables(Step& s, const Doubles& motion, const Doubles& transport, const double* flow) {
    std::copy(motion.data(), motion.data() + 20, &s.motion[0][0]);
    std::copy(transport.data(), transport.data() + 20, &s.transport[0][0]);
    if (!flow) flow = transport.data();
    std::copy(flow, flow + 20, &s.flow[0][0]);
}

void bind_step(nb::module_& m) {
    nb::class_<Step>(m, "Step")
        .def(
            "__init__",
            [](Step* s, double t0, double h, double te, double theta, double theta_g, bool discrete_gradient,
               const Doubles& motion, const Doubles& transport, bool projects_rates, const nb::object& flow) {
                new (s) Step();
                s->projects_rates = projects_rates;
                s->t0 = t0, s->h = h, s->t1 = t0 + h, s->te = te, s->theta = theta, s->theta_g = theta_g;
                s->stress = discrete_gradient ? Stress::discrete_gradient : Stress::at_theta;
                tables(*s, motion, transport, optional(flow));
            },
            nb::arg("t0"), nb::arg("h"), nb::arg("te"), nb::arg("theta"), nb::arg("theta_g"),
            nb::arg("discrete_gradient"), nb::arg("motion"), nb::arg("transport"),
            nb::arg("projects_rates") = false, nb::arg("flow") = nb::none())
        .def("moved_to",
             [](const Step& s, double t0) {  // the same step at another time
                 Step moved = s;
                 moved.t0 = t0, moved.t1 = t0 + s.h, moved.te = t0 + s.theta * s.h;
                 return moved;
             })
        .def_ro("t0", &Step::t0)
        .def_ro("t1", &Step::t1)
        .def_ro("te", &Step::te)
        .def_ro("h", &Step::h)
        .def_prop_ro("has_length", &Step::has_length)
        .def_prop_ro_static("NO_LENGTH", [](nb::handle) { return Step::no_length; })
        .def_ro("theta", &Step::theta)
        .def_ro("theta_g", &Step::theta_g)
        .def_prop_ro("discrete_gradient", [](const Step& s) { return s.stress == Stress::discrete_gradient; })
        .def_prop_ro("rate_factor", [](const Step& s) { return s.motion[0][0]; })
        .def_prop_ro("second_rate_factor", [](const Step& s) { return s.motion[1][0]; })
        .def_prop_ro("transport_factor", [](const Step& s) { return s.transport[0][0]; });
    nb::class_<Report>(m, "Report")
        .def_ro("converged", &Report::converged)
        .def_ro("iterations", &Report::iterations)
        .def_ro("factorizations", &Report::factorizations)
        .def_ro("increments", &Report::increments)
        .def_ro("worst_unknown", &Report::worst_unknown)
        .def_ro("reason", &Report::reason);
}
