// Binding of physics at points.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include "callback.hpp"
#include "linear.hpp"
#include "visviva/point/point_term.hpp"

namespace nb = nanobind;
using namespace visviva;

using Doubles = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Ints = nb::ndarray<const int, nb::c_contig, nb::device::cpu>;

static const double* optional(const nb::object& a) {
    return a.is_none() ? nullptr : nb::cast<Doubles>(a).data();
}

// Of (weights (n, points, nodes, columns), mass (n, pairs) or None, whether they are positions).
static PointGroupData group_of(const nb::tuple& g) {
    const auto weights = nb::cast<Doubles>(g[0]);
    return {static_cast<int>(weights.shape(2)), nb::cast<bool>(g[2]), weights.data(), optional(g[1])};
}

static PointData data_of(PhysicsKind kind, const Ints& index, const nb::list& groups, const Doubles& volume,
                         const Doubles& par, const nb::object& reference) {
    PointData d{};
    const PointShape& shape = point_kernels(kind).shape;
    d.kind = kind, d.n = static_cast<int>(index.shape(0)), d.n_slots = static_cast<int>(index.shape(1)),
    d.n_points = static_cast<int>(volume.shape(1)), d.index = index.data();
    for (std::size_t g = 0; g < nb::len(groups); ++g) {
        const auto weights = nb::cast<Doubles>(nb::cast<nb::tuple>(groups[g])[0]);
        if (g < static_cast<std::size_t>(shape.n_groups) &&
            static_cast<int>(weights.shape(3)) != shape.group[g].columns)
            throw std::invalid_argument("the weights of a group need the columns of its physics");
        d.groups.push_back(group_of(nb::cast<nb::tuple>(groups[g])));
    }
    if (static_cast<int>(par.shape(2)) != shape.n_par)
        throw std::invalid_argument("the parameters are not those of the physics");
    d.volume = volume.data(), d.par = par.data(), d.reference = optional(reference);
    return d;
}

// [variable][point], with the fillers of the last block.
static nb::ndarray<nb::numpy, double, nb::ndim<2>> history(const PointTerm& t) {
    const auto& h = t.history();
    const std::size_t n = t.n_history(), m = n == 0 ? 0 : h.size() / n;
    auto* out = new std::vector<double>(h.begin(), h.end());
    for (std::size_t i = 0; !t.is_called() && i < h.size(); ++i) {
        const std::size_t lane = i % point_lanes, variable = i / point_lanes % n,
                          point = i / point_lanes / n * point_lanes + lane;
        (*out)[variable * m + point] = h[i];
    }
    nb::capsule owner(out, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
    const std::size_t shape[2] = {n, m};
    return nb::ndarray<nb::numpy, double, nb::ndim<2>>(out->data(), 2, shape, owner);
}

void bind_point(nb::module_& m) {
    nb::enum_<PhysicsKind>(m, "PhysicsKind")
        .value("VISCOELASTIC", PhysicsKind::viscoelastic)
        .value("THERMOELASTIC", PhysicsKind::thermoelastic)
        .value("DAMAGE", PhysicsKind::damage)
        .value("CAHN_HILLIARD", PhysicsKind::cahn_hilliard)
        .value("BEAM", PhysicsKind::beam)
        .value("SHELL", PhysicsKind::shell);
    nb::class_<PointTerm, Term>(m, "PointTerm")
        .def(
            "__init__",
            [](PointTerm* t, PhysicsKind kind, const Ints& index, const nb::list& groups,
               const Doubles& volume, const Doubles& par, nb::object reference) {
                new (t) PointTerm(data_of(kind, index, groups, volume, par, reference));
            },
            nb::arg("kind"), nb::arg("index"), nb::arg("groups"), nb::arg("volume"), nb::arg("par"),
            nb::arg("reference").none())
        .def("set_callback", [](PointTerm& t, nb::object f,
                                const std::vector<double>& start) { t.set_callback(law_callback(f), start); })
        .def("history", &history)
        .def_prop_ro("n_strains", &PointTerm::n_strains)
        .def("book_point", [](PointTerm& t, int energy, int kinetic, int dissipation, int owner) {
            t.energy_account = energy, t.kinetic_account = kinetic, t.dissipation_account = dissipation;
            t.owner = owner;
        });
}
