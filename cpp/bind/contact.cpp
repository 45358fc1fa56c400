// Binding of contact: surfaces as arrays.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/shared_ptr.h>

#include "contact/contact_term.hpp"
#include "linear.hpp"

namespace nb = nanobind;
using namespace visviva;

namespace {

using Doubles = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Ints = nb::ndarray<const int, nb::c_contig, nb::device::cpu>;

template <class T>
std::vector<T> vector_of(const nb::ndarray<const T, nb::c_contig, nb::device::cpu>& a) {
    return {a.data(), a.data() + a.size()};
}

nb::ndarray<nb::numpy, double> copy_of(const std::vector<double>& values) {
    auto* kept = new std::vector<double>(values);
    nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
    const std::size_t n = kept->size();
    return nb::ndarray<nb::numpy, double>(kept->data(), 1, &n, owner);
}

Skin skin_of(int dim, const Ints& first, const Ints& unknown, const Doubles& weight, const Ints& mesh_node,
             const Doubles& constant, const Ints& facets, int n_first, int second_begin) {
    Skin s;
    s.dim = dim, s.first = vector_of<int>(first), s.unknown = vector_of<int>(unknown);
    s.weight = vector_of<double>(weight), s.constant = vector_of<double>(constant);
    s.mesh_node.assign(mesh_node.data(), mesh_node.data() + mesh_node.size());
    s.facets = vector_of<int>(facets), s.n_first = n_first, s.second_begin = second_begin;
    return s;
}

std::shared_ptr<Gaps> shared(std::unique_ptr<Gaps> gaps) { return gaps; }

}  // namespace

void bind_contact(nb::module_& m) {
    nb::class_<Skin>(m, "Skin").def(
        "__init__",
        [](Skin* s, int dim, const Ints& first, const Ints& unknown, const Doubles& weight,
           const Ints& mesh_node, const Doubles& constant, const Ints& facets, int n_first,
           int second_begin) {
            new (s) Skin(
                skin_of(dim, first, unknown, weight, mesh_node, constant, facets, n_first, second_begin));
        },
        nb::arg("dim"), nb::arg("first"), nb::arg("unknown"), nb::arg("weight"), nb::arg("mesh_node"),
        nb::arg("constant"), nb::arg("facets"), nb::arg("n_first"), nb::arg("second_begin"));
    nb::class_<Gaps>(m, "Gaps");
    m.def(
        "mortar", [](const Skin& skin, double reach) { return shared(make_mortar(skin, {reach})); },
        nb::arg("skin"), nb::arg("reach"));
    m.def(
        "node_to_segment",
        [](const Skin& skin, const Doubles& areas, double radius, double reach) {
            return shared(make_node_to_segment(skin, {vector_of<double>(areas), radius, reach}));
        },
        nb::arg("skin"), nb::arg("areas"), nb::arg("radius"), nb::arg("reach"));
    m.def(
        "self_contact",
        [](const Skin& skin, const Doubles& areas, double reach, const Doubles& places) {
            return shared(
                make_self_contact(skin, {vector_of<double>(areas), 0, reach}, vector_of<double>(places)));
        },
        nb::arg("skin"), nb::arg("areas"), nb::arg("reach"), nb::arg("places"));
    nb::class_<ContactTerm, Term>(m, "ContactTerm")
        .def(
            "__init__",
            [](ContactTerm* t, std::shared_ptr<Gaps> gaps, double reach, const Ints& multiplier,
               const Doubles& stiffness, bool conserving) {
                new (t) ContactTerm(std::move(gaps),
                                    {vector_of<int>(multiplier), vector_of<double>(stiffness), conserving},
                                    reach);
            },
            nb::arg("gaps"), nb::arg("reach"), nb::arg("multiplier"), nb::arg("stiffness"),
            nb::arg("conserving"))
        .def("book_contact",
             [](ContactTerm& t, int work, int energy) { t.work_account = work, t.energy_account = energy; })
        .def_prop_ro(
            "pressures", [](const ContactTerm& t) { return copy_of(t.pressures()); },
            nb::rv_policy::automatic)
        .def_prop_ro(
            "gaps", [](const ContactTerm& t) { return copy_of(t.gap_values()); }, nb::rv_policy::automatic)
        .def_prop_ro(
            "areas", [](const ContactTerm& t) { return copy_of(t.areas()); }, nb::rv_policy::automatic);
}
