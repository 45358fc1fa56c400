// Binding of fluids.
#include "arrays.hpp"
#include "callback.hpp"
#include "parts.hpp"
#include "visviva/flow/flow_term.hpp"
#include "visviva/flow/open_term.hpp"

using namespace visviva;

using Values = nb::ndarray<nb::numpy, double, nb::ndim<1>>;

// The function writes `size` values at a time t. It is Python that owns it.
static FlowLoad load_of(const Term* term, const nb::object& function, std::size_t size) {
    return [f = Callback(term, function), size](double t, double* values) {
        nb::gil_scoped_acquire gil;
        f(t, Values(values, {size}, nb::none()));
    };
}

static int extent(const Doubles& a, std::size_t k) { return static_cast<int>(a.shape(k)); }

void bind_flow(nb::module_& m) {
    nb::class_<FlowTerm, Term>(m, "FlowTerm")
        .def(
            "__init__",
            [](FlowTerm* t, double density, double viscosity, bool convects, const Ints& index,
               const Doubles& N, const Doubles& M, const Doubles& gradients, const Doubles& volume,
               const Doubles& positions, nb::object metric, std::vector<int> pressures) {
                FlowData d{};
                d.n = extent(volume, 0), d.n_points = extent(volume, 1), d.n_nodes = extent(N, 1),
                d.n_pressures = extent(M, 1), d.dim = extent(gradients, 3);
                d.density = density, d.viscosity = viscosity, d.convects = convects;
                d.index = index.data(), d.N = N.data(), d.M = M.data(), d.gradients = gradients.data(),
                d.volume = volume.data(), d.positions = positions.data();
                d.pressures = std::move(pressures);
                d.metric = metric.is_none() ? nullptr : nb::cast<Doubles>(metric).data();
                new (t) FlowTerm(d);
            },
            nb::arg("density"), nb::arg("viscosity"), nb::arg("convects"), nb::arg("index"), nb::arg("N"),
            nb::arg("M"), nb::arg("gradients"), nb::arg("volume"), nb::arg("positions"),
            nb::arg("metric").none(), nb::arg("pressures"))
        .def("set_force",
             [](FlowTerm& t, nb::object f, std::size_t size) { t.set_force(load_of(&t, f, size)); })
        .def("scale_metric", [](FlowTerm& t, const Doubles& factor) { t.scale_metric(factor.data()); })
        .def("blind", [](FlowTerm& t, const Doubles& directions) { t.blind(directions.data()); })
        .def("book_flow", [](FlowTerm& t, int owner, int kinetic, int viscosity, int stabilisation, int force,
                             int continuation) {
            t.owner = owner, t.kinetic_account = kinetic;
            const int accounts[] = {viscosity, stabilisation, force, continuation};
            std::copy(accounts, accounts + 4, t.work_account);
        });
    nb::class_<OpenTerm, Term>(m, "OpenTerm")
        .def("__init__",
             [](OpenTerm* t, double density, double viscosity, bool directional, const Ints& index,
                const Doubles& N, const Doubles& G, const Doubles& normal) {
                 OpenData d{};
                 d.n = extent(N, 0), d.n_points = extent(N, 1), d.n_nodes = extent(N, 2),
                 d.dim = extent(G, 3);
                 d.density = density, d.viscosity = viscosity, d.directional = directional;
                 d.index = index.data();
                 d.N = N.data(), d.G = G.data(), d.normal = normal.data();
                 new (t) OpenTerm(d);
             })
        .def("set_load",
             [](OpenTerm& t, nb::object f, std::size_t size) { t.set_load(load_of(&t, f, size)); })
        .def("book_open",
             [](OpenTerm& t, int load, int flow) { t.load_account = load, t.flow_account = flow; });
}
