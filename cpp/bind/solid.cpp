// Binding of solids.
#include "arrays.hpp"
#include "callback.hpp"
#include "parts.hpp"
#include "visviva/solid/solid_dispatch.hpp"
#include "visviva/solid/solid_term.hpp"

using namespace visviva;

static int padded(int n) { return (n + solid_lanes - 1) / solid_lanes * solid_lanes; }

static void material(int kind, const Doubles& par, const Doubles& c, Array out) {
    if (par.size() > material_max_parameters || out.size() != c.shape(0) * 28 || c.shape(1) != 6)
        throw std::invalid_argument("a material needs its parameters, strains (n, 6) and room (n, 28)");
    solid_kernels().material(static_cast<MaterialKind>(kind), par.data(), static_cast<int>(par.size()),
                             static_cast<int>(c.shape(0)), c.data(), out.data());
}

void bind_solid(nb::module_& m) {
    bind_kinds<MaterialKind>(m, "MaterialKind", material_traits);
    m.attr("MATERIAL_PARAMETERS") = material_max_parameters;
    m.def("bulk_place", [](int kind) { return traits(static_cast<MaterialKind>(kind)).bulk; });
    m.def("material", &material, nb::arg("kind"), nb::arg("parameters"), nb::arg("c"), nb::arg("out"));
    nb::class_<SolidTerm, Term>(m, "SolidTerm")
        .def(
            "__init__",
            [](SolidTerm* t, int kind, bool small, const Ints& index, const Doubles& gradients,
               const Doubles& volume, const Doubles& par, nb::object hoop, nb::object mass,
               nb::object damping) {
                SolidData d{};
                d.n = static_cast<int>(index.shape(0)), d.n_nodes = static_cast<int>(gradients.shape(2));
                d.n_pressures = static_cast<int>(index.shape(1)) - d.n_nodes;
                d.n_points = static_cast<int>(volume.shape(1)), d.dim = static_cast<int>(gradients.shape(3));
                d.n_par = static_cast<int>(par.shape(1)), d.kind = static_cast<MaterialKind>(kind),
                d.small = small;
                d.index = index.data(), d.gradients = gradients.data(), d.volume = volume.data(),
                d.par = par.data();
                d.hoop = optional(hoop), d.mass = optional(mass), d.damping = optional(damping);
                new (t) SolidTerm(d);
            },
            nb::arg("kind"), nb::arg("small"), nb::arg("index"), nb::arg("gradients"), nb::arg("volume"),
            nb::arg("par"), nb::arg("hoop").none(), nb::arg("mass").none(), nb::arg("damping").none())
        .def_static(
            "of_bricks",
            [](int kind, bool small, const Ints& index, const Doubles& places, const Doubles& slopes,
               const Doubles& weight, const Doubles& par, nb::object mass_shapes, nb::object mass,
               nb::object damping) {
                if (places.size() != index.size() * 3 || index.shape(1) != 8 ||
                    weight.size() != brick_points || slopes.size() != brick_points * 8 * 3)
                    throw std::invalid_argument(
                        "bricks need places (m, 8, 3), slopes (8, 8, 3) and weights (8,)");
                SolidData d{};
                d.n = static_cast<int>(index.shape(0)), d.n_nodes = 8, d.n_points = brick_points, d.dim = 3;
                d.n_par = static_cast<int>(par.shape(1)), d.kind = static_cast<MaterialKind>(kind),
                d.small = small;
                d.index = index.data(), d.places = places.data(), d.slopes = slopes.data(),
                d.weight = weight.data(), d.par = par.data();
                d.mass_shapes = optional(mass_shapes), d.mass = optional(mass), d.damping = optional(damping);
                return new SolidTerm(d);
            },
            nb::arg("kind"), nb::arg("small"), nb::arg("index"), nb::arg("places"), nb::arg("slopes"),
            nb::arg("weight"), nb::arg("par"), nb::arg("mass_shapes").none(), nb::arg("mass").none(),
            nb::arg("damping").none())
        .def("set_callback", [](SolidTerm& t, nb::object f) { t.set_callback(law_callback(&t, f)); })
        .def_prop_rw("start_stress", &SolidTerm::start_stress, &SolidTerm::set_start_stress)
        .def("set_plane_stress", &SolidTerm::set_plane_stress)
        .def("set_thermal", [](SolidTerm& t, Doubles strain) { t.set_thermal(strain.data()); })
        .def(
            "set_centre",
            [](SolidTerm& t, const Doubles& gradients, nb::object hoop) {
                t.set_centre(gradients.data(), optional(hoop));
            },
            nb::arg("gradients"), nb::arg("hoop").none())
        .def("set_pressure",
             [](SolidTerm& t, const Doubles& shape, const Doubles& compliance, int measure, bool multiplier) {
                 t.set_pressure(shape.data(), compliance.data(), measure, multiplier);
             })
        .def("fields",
             [](SolidTerm& t, const Doubles& x, int begin, int end) {
                 const auto points = static_cast<std::size_t>(t.n_points());
                 std::vector<double> out(static_cast<std::size_t>(padded(end - begin)) * points * 16);
                 t.fields(x.data(), begin, end, out.data());
                 return handed_over(std::move(out), {static_cast<std::size_t>(end - begin), points, 16});
             })
        .def("forces",
             [](SolidTerm& t, const Doubles& x, int begin, int end) {
                 const auto nodes = static_cast<std::size_t>(t.n_nodes()),
                            dim = static_cast<std::size_t>(t.dim());
                 std::vector<double> out(static_cast<std::size_t>(padded(end - begin)) * nodes * dim);
                 t.forces(x.data(), begin, end, out.data());
                 return handed_over(std::move(out), {static_cast<std::size_t>(end - begin), nodes, dim});
             })
        .def("book_solid",
             [](SolidTerm& t, int strain, int kinetic, int damping, int owner, const Ints& numbers) {
                 t.strain_account = strain, t.kinetic_account = kinetic, t.damping_account = damping;
                 t.owner = owner, t.numbers = vector_of<int>(numbers);
             });
}
