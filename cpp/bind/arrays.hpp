#pragma once
// Arrays of Python as the core takes them: contiguous float64 and int32, without a copy where it only looks
// at them.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
// each without which a part of the binding would compile, and fail when it is called
#include <nanobind/stl/function.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace nb = nanobind;

using Array = nb::ndarray<double, nb::c_contig, nb::device::cpu>;
using Doubles = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Ints = nb::ndarray<const int, nb::c_contig, nb::device::cpu>;
using View = nb::ndarray<nb::numpy, double>;

// Objects of Python that are copied and destroyed where the interpreter's lock may not be held.
inline std::shared_ptr<nb::object> kept(nb::object object) {
    return {new nb::object(std::move(object)), [](nb::object* o) {
                nb::gil_scoped_acquire gil;
                delete o;
            }};
}

template <class T>
std::vector<T> vector_of(const nb::ndarray<const T, nb::c_contig, nb::device::cpu>& a) {
    return {a.data(), a.data() + a.size()};
}
inline std::vector<char> flags_of(const Ints& a) { return {a.data(), a.data() + a.size()}; }

/// The numbers of an array, or nothing for None.
inline const double* optional(const nb::object& a) {
    return a.is_none() ? nullptr : nb::cast<Doubles>(a, false).data();  // a copy would not last
}

// --- what the core owns, as arrays of Python -----
inline View view(double* data, std::size_t rows, std::size_t cols, nb::handle owner) {
    const std::size_t shape[2] = {rows, cols};
    return View(data, 2, shape, owner);
}
inline View view(double* data, std::size_t n, nb::handle owner) { return View(data, 1, &n, owner); }
/// Valid during the call of Python that it is passed to.
inline View own(const double* data, std::size_t rows, std::size_t cols) {
    return view(const_cast<double*>(data), rows, cols, nb::none());
}

// --- what Python looks at while it is called -----
template <class T>
nb::object seen(const T* data, std::initializer_list<std::size_t> shape) {
    return nb::cast(nb::ndarray<nb::numpy, const T>(data, shape.size(), shape.begin(), nb::none()),
                    nb::rv_policy::reference);
}
template <class T>
nb::object seen(const std::vector<T>& values) {
    return seen(values.data(), {values.size()});
}

// --- what Python comes to own -----
/// Numbers in this shape.
inline View handed_over(std::vector<double> values, std::initializer_list<std::size_t> shape) {
    auto* kept = new std::vector<double>(std::move(values));
    nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
    return View(kept->data(), shape.size(), shape.begin(), owner);
}
inline View handed_over(std::vector<double> values) {
    const std::size_t n = values.size();
    return handed_over(std::move(values), {n});
}

/// The names of Python from the tables of the core.
template <class Kind, class Table>
void bind_kinds(nb::module_& m, const char* name, const Table& table) {
    auto bound = nb::enum_<Kind>(m, name, nb::is_arithmetic());
    for (const auto& traits : table) bound.value(traits.name, traits.kind);
}
