// Binding of immersed solids.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "flow/immersed_term.hpp"
#include "linear.hpp"

namespace nb = nanobind;
using namespace visviva;

namespace {

template <class T>
using Array = nb::ndarray<const T, nb::c_contig, nb::device::cpu>;

template <class T>
std::vector<T> vector_of(const Array<T>& a) {
    return {a.data(), a.data() + a.size()};
}

// The function takes places (n, dim) and whether they must be inside, and returns unknowns and weights (n,
// width). It is Python that owns it.
Interpolation interpolation_of(nb::object function, std::size_t n, std::size_t dim, std::size_t width) {
    return [f = nb::weakref(function), n, dim, width](const double* places, bool must, int* unknown,
                                                      double* weight) {
        nb::gil_scoped_acquire gil;
        nb::object call = f();
        if (call.is_none())
            throw std::runtime_error("an immersed solid was asked after its system was released");
        auto found = nb::cast<nb::tuple>(
            call(nb::ndarray<nb::numpy, const double>(places, {n, dim}, nb::none()), must));
        const auto unknowns = nb::cast<Array<int>>(found[0]);
        const auto weights = nb::cast<Array<double>>(found[1]);
        if (unknowns.size() != n * width || weights.size() != n * width)
            throw std::runtime_error("an interpolation of an immersed solid has the wrong size");
        std::copy_n(unknowns.data(), n * width, unknown);
        std::copy_n(weights.data(), n * width, weight);
    };
}

}  // namespace

void bind_immersed(nb::module_& m) {
    nb::class_<ImmersedTerm, Term>(m, "ImmersedTerm")
        .def("__init__", [](ImmersedTerm* t, int dim, int width, double damping, const Array<int>& vector,
                            const Array<double>& weight, const Array<int>& multiplier,
                            nb::object interpolate) {
            const int n = static_cast<int>(multiplier.size()), terms = static_cast<int>(vector.size()) / n;
            new (t) ImmersedTerm(
                {dim, terms, width, damping, vector_of(vector), vector_of(weight), vector_of(multiplier)},
                interpolation_of(std::move(interpolate), n, dim, width));
        });
}
