// Binding of immersed solids.
#include <nanobind/stl/optional.h>

#include "arrays.hpp"
#include "callback.hpp"
#include "parts.hpp"
#include "visviva/flow/immersed_heat.hpp"
#include "visviva/flow/immersed_term.hpp"

using namespace visviva;

namespace {

nb::object rows(const double* values, std::size_t n, std::size_t dim) {
    return nb::cast(nb::ndarray<nb::numpy, const double>(values, {n, dim}, nb::none()));
}

// Takes starts and places (n, dim), returns unknowns and weights (n, width).
Interpolation interpolation_of(const Term* term, const nb::object& function, std::size_t n, std::size_t dim,
                               std::size_t width) {
    return [f = Callback(term, function), n, dim, width](const double* starts, const double* places,
                                                         int* unknown, double* weight) {
        nb::gil_scoped_acquire gil;
        auto found = nb::cast<nb::tuple>(f(rows(starts, n, dim), rows(places, n, dim)));
        const auto unknowns = nb::cast<Ints>(found[0]);
        const auto weights = nb::cast<Doubles>(found[1]);
        if (unknowns.size() != n * width || weights.size() != n * width)
            throw std::runtime_error("an interpolation of an immersed solid has the wrong size");
        std::copy_n(unknowns.data(), n * width, unknown);
        std::copy_n(weights.data(), n * width, weight);
    };
}

// Takes starts and ends (n, dim), returns a point and why it may not end there, or None.
Admission admission_of(const Term* term, const nb::object& function, std::size_t n, std::size_t dim) {
    return [f = Callback(term, function), n, dim](const double* starts, const double* ends) -> Lost {
        nb::gil_scoped_acquire gil;
        const nb::object found = f(rows(starts, n, dim), rows(ends, n, dim));
        if (found.is_none()) return {};
        return {nb::cast<int>(found[0]), nb::cast<std::string>(found[1])};
    };
}

// Takes places and moves (n, dim), returns where the unknowns of each begin, (n + 1), and all of them.
Coupling coupling_of(const Term* term, const nb::object& function, std::size_t n, std::size_t dim) {
    return [f = Callback(term, function), n, dim](const double* places, const double* moves) {
        nb::gil_scoped_acquire gil;
        auto found = nb::cast<nb::tuple>(f(rows(places, n, dim), rows(moves, n, dim)));
        const auto starts = nb::cast<Ints>(found[0]), unknowns = nb::cast<Ints>(found[1]);
        std::vector<std::vector<int>> coupled(n);
        for (std::size_t k = 0; k < n; ++k)
            coupled[k].assign(unknowns.data() + starts.data()[k], unknowns.data() + starts.data()[k + 1]);
        return coupled;
    };
}

// Takes places (n, dim); None where nobody asks.
Reach reach_of(const Term* term, const nb::object& function, std::size_t n, std::size_t dim) {
    if (function.is_none()) return {};
    return [f = Callback(term, function), n, dim](const double* places) {
        nb::gil_scoped_acquire gil;
        f(rows(places, n, dim));
    };
}

using Flags = nb::ndarray<nb::numpy, bool, nb::ndim<1>>;

std::optional<Flags> within(const ImmersedTerm& term) {
    const std::vector<char> found = term.within();
    if (found.empty()) return {};
    auto* flags = new bool[found.size()];
    std::copy(found.begin(), found.end(), flags);
    nb::capsule owner(flags, [](void* p) noexcept { delete[] static_cast<bool*>(p); });
    return Flags(flags, {found.size()}, owner);
}

}  // namespace

void bind_immersed(nb::module_& m) {
    nb::class_<ImmersedTerm, Term>(m, "ImmersedTerm")
        .def(
            "__init__",
            [](ImmersedTerm* t, int dim, int width, double damping, bool leaves, const Ints& vector,
               const Doubles& weight, const Ints& multiplier,
               const nb::ndarray<const bool, nb::c_contig, nb::device::cpu>& held, nb::object interpolate,
               nb::object admit, nb::object couple, nb::object reach) {
                const int n = static_cast<int>(multiplier.size()),
                          terms = static_cast<int>(vector.size()) / n;
                new (t) ImmersedTerm({dim,
                                      terms,
                                      width,
                                      damping,
                                      leaves,
                                      vector_of(vector),
                                      vector_of(weight),
                                      vector_of(multiplier),
                                      {held.data(), held.data() + held.size()}},
                                     interpolation_of(t, interpolate, n, dim, width),
                                     admission_of(t, admit, n, dim), coupling_of(t, couple, n, dim),
                                     reach_of(t, reach, n, dim));
            },
            nb::arg("dim"), nb::arg("width"), nb::arg("damping"), nb::arg("leaves"), nb::arg("vector"),
            nb::arg("weight"), nb::arg("multiplier"), nb::arg("held"), nb::arg("interpolate"),
            nb::arg("admit"), nb::arg("couple"), nb::arg("reach").none())
        .def_prop_ro("within", &within, nb::rv_policy::automatic)
        .def_prop_ro("location", &ImmersedTerm::location);
    nb::class_<ImmersedHeat, Term>(m, "ImmersedHeat")
        .def(
            "__init__",
            [](ImmersedHeat* t, std::shared_ptr<ImmersedTerm> body, const Ints& balance,
               const Ints& temperature, const Doubles& conductance, bool entropy, int flow_start,
               int heat_start, int dim) {
                new (t) ImmersedHeat(std::move(body),
                                     {vector_of(balance), vector_of(temperature), vector_of(conductance),
                                      entropy, flow_start, heat_start, dim});
            },
            nb::arg("body"), nb::arg("balance"), nb::arg("temperature"), nb::arg("conductance"),
            nb::arg("entropy"), nb::arg("flow_start"), nb::arg("heat_start"), nb::arg("dim"));
}
