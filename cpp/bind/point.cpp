// Binding of physics at points.
#include <nanobind/stl/pair.h>

#include "arrays.hpp"
#include "callback.hpp"
#include "parts.hpp"
#include "visviva/point/assumed_term.hpp"
#include "visviva/point/point_term.hpp"

using namespace visviva;

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

// Of weights (samples, slots), products (strain, left, right) and their factors.
static AssumedData assumed_data(const Ints& index, const Doubles& weights, const Ints& products,
                                const Doubles& factors, const Doubles& stiffness, const Doubles& reference) {
    AssumedData d{};
    d.n = static_cast<int>(index.shape(0)), d.n_slots = static_cast<int>(index.shape(1));
    d.n_samples = static_cast<int>(weights.shape(0)), d.n_strains = static_cast<int>(reference.shape(1));
    d.index = index.data(), d.weights = weights.data();
    for (std::size_t k = 0; k < products.shape(0); ++k) {
        const int* p = products.data() + 3 * k;
        d.products.push_back({p[0], p[1], p[2], factors.data()[k]});
    }
    d.stiffness = stiffness.data(), d.reference = reference.data();
    return d;
}

void bind_point(nb::module_& m) {
    nb::class_<AssumedTerm, Term>(m, "AssumedTerm")
        .def(
            "__init__",
            [](AssumedTerm* t, const Ints& index, const Doubles& weights, const Ints& products,
               const Doubles& factors, const Doubles& stiffness, const Doubles& reference) {
                new (t) AssumedTerm(assumed_data(index, weights, products, factors, stiffness, reference));
            },
            nb::arg("index"), nb::arg("weights"), nb::arg("products"), nb::arg("factors"),
            nb::arg("stiffness"), nb::arg("reference"))
        .def_rw("energy_account", &AssumedTerm::energy_account);
    bind_kinds<PhysicsKind>(m, "PhysicsKind", physics_traits);
    // Components of the unknowns of each group, and how many strains the map has.
    m.def("point_shape", [](PhysicsKind kind) {
        const PointShape& shape = point_kernels(kind).shape;
        nb::list components;
        for (int g = 0; g < shape.n_groups; ++g) components.append(shape.group[g].components);
        return nb::make_tuple(components, shape.n_strains);
    });
    nb::class_<PointTerm, Term>(m, "PointTerm")
        .def(
            "__init__",
            [](PointTerm* t, PhysicsKind kind, const Ints& index, const nb::list& groups,
               const Doubles& volume, const Doubles& par, nb::object reference) {
                new (t) PointTerm(data_of(kind, index, groups, volume, par, reference));
            },
            nb::arg("kind"), nb::arg("index"), nb::arg("groups"), nb::arg("volume"), nb::arg("par"),
            nb::arg("reference").none())
        .def("set_callback",
             [](PointTerm& t, nb::object f, const std::vector<double>& start) {
                 t.set_callback(law_callback(&t, f), start);
             })
        .def("limit", &PointTerm::limit)
        .def("drive", &PointTerm::drive, nb::arg("places"), nb::arg("account"))
        .def("history", &history)
        .def_prop_ro("n_strains", &PointTerm::n_strains)
        .def("book_point", [](PointTerm& t, int energy, int kinetic, int dissipation, int owner) {
            t.energy_account = energy, t.kinetic_account = kinetic, t.dissipation_account = dissipation;
            t.owner = owner;
        });
}
