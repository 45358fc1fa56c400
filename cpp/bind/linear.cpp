// Choices of linear solvers, and the solvers on their own for tests and benchmarks.
#include <algorithm>

#include "arrays.hpp"
#include "outside.hpp"
#include "parts.hpp"
#include "visviva/linear/asymmetry.hpp"
#include "visviva/linear/linear_choice.hpp"
#include "visviva/system/system.hpp"

using namespace visviva;

using Out = nb::ndarray<double, nb::c_contig, nb::device::cpu>;
using Longs = nb::ndarray<const std::int64_t, nb::c_contig, nb::device::cpu>;

namespace {

Aggregates aggregates_of(nb::handle parts) {
    const auto of = nb::cast<Ints>(parts[1]);
    const auto block = nb::cast<Doubles>(parts[2]);
    Aggregates a;
    a.n = nb::cast<int>(parts[0]), a.cols = static_cast<int>(block.shape(2));
    if (a.cols > 6) throw nb::value_error("multigrid takes at most 6 near-null vectors");
    a.of.assign(of.data(), of.data() + of.size());
    a.block.assign(block.data(), block.data() + block.size());
    return a;
}

// The function returns one tuple (number of aggregates, the aggregate of each block row, tentative blocks by
// rows) per level but the coarsest.
Aggregator aggregator_of(nb::object function) {
    if (function.is_none()) return {};
    return
        [shared = kept(std::move(function))](const BlockRows<double>& a, const double* modes, int n_modes) {
            nb::gil_scoped_acquire gil;
            const nb::object levels =
                (*shared)(seen(a.row.data(), {a.row.size()}), seen(a.col.data(), {a.col.size()}), a.rows,
                          seen(modes, {a.size(), static_cast<std::size_t>(n_modes)}));
            std::vector<Aggregates> all;
            for (nb::handle level : levels) all.push_back(aggregates_of(level));
            return all;
        };
}

// A linear solver on a matrix given in compressed rows.
struct Linear {
    Linear(const std::vector<LinearChoice>& choices, const Longs& row, const Ints& col, const Ints& node,
           const Doubles& modes, const Ints& multiplier, const std::vector<int>& place,
           const std::vector<int>& algebraic, const std::vector<double>& scale)
        : solver(make_linear(choices)) {
        csr.row.assign(row.data(), row.data() + row.size());
        csr.col.assign(col.data(), col.data() + col.size());
        csr.n = static_cast<int>(row.size()) - 1;
        for (int i = 0; i < csr.n; ++i) csr.equation.push_back(i), csr.unknown.push_back(i);
        blocks.node.assign(node.data(), node.data() + node.size());
        blocks.n_modes = csr.n ? static_cast<int>(modes.size()) / csr.n : 0;
        blocks.modes = [given = vector_of<double>(modes), n = blocks.n_modes](const std::vector<int>& rows,
                                                                              double* to) {
            for (int row : rows) {
                if (row >= 0) std::copy_n(given.data() + static_cast<std::size_t>(row) * n, n, to);
                to += n;
            }
        };
        blocks.multiplier = flags_of(multiplier);
        blocks.place = place, blocks.scale = scale;
        blocks.algebraic.assign(algebraic.begin(), algebraic.end());
        solver->analyze(csr, blocks);
    }

    bool factor(const Doubles& values) {
        if (values.size() != csr.col.size()) throw nb::value_error("one value per entry of the pattern");
        kept = values;  // a solver that takes over in the midst of a solution factors them again
        nb::gil_scoped_release release;
        return solver->factor(values.data(), {});
    }

    bool solve(const Doubles& rhs, Out& x, double tolerance) {
        if (rhs.size() != static_cast<std::size_t>(csr.n) || x.size() != rhs.size())
            throw nb::value_error("one number per equation");
        nb::gil_scoped_release release;
        std::vector<double> r(rhs.data(), rhs.data() + csr.n);
        for (double& a : r) a = -a;
        return solver->solve(r.data(), {}, x.data(), tolerance);
    }

    Csr csr;
    Blocks blocks;
    Doubles kept;
    std::unique_ptr<LinearSolver> solver;
};

void bind_choice(nb::module_& m) {
    nb::enum_<Backend>(m, "Backend")
        .value("sparse_lu", Backend::sparse_lu)
        .value("cholesky", Backend::cholesky)
        .value("pardiso", Backend::pardiso)
        .value("krylov", Backend::krylov)
        .value("staggered", Backend::staggered)
        .value("outside", Backend::outside);
    nb::enum_<MatrixKind>(m, "MatrixKind")
        .value("definite", MatrixKind::definite)
        .value("symmetric", MatrixKind::symmetric)
        .value("general", MatrixKind::general);
    nb::enum_<KrylovMethod>(m, "KrylovMethod")
        .value("cg", KrylovMethod::cg)
        .value("gmres", KrylovMethod::gmres)
        .value("bicgstab", KrylovMethod::bicgstab);
    nb::enum_<Preconditioner>(m, "Preconditioner")
        .value("none", Preconditioner::none)
        .value("diagonal", Preconditioner::diagonal)
        .value("block", Preconditioner::block)
        .value("incomplete", Preconditioner::incomplete)
        .value("multigrid", Preconditioner::multigrid)
        .value("saddle", Preconditioner::saddle)
        .value("augmented", Preconditioner::augmented)
        .value("commutator", Preconditioner::commutator)
        .value("mixture", Preconditioner::mixture);
    nb::class_<LinearChoice>(m, "LinearChoice")
        .def(nb::init<>())
        .def_rw("backend", &LinearChoice::backend)
        .def_rw("kind", &LinearChoice::kind)
        .def_rw("regularization", &LinearChoice::regularization)
        .def_rw("memory_limit", &LinearChoice::memory_limit)
        .def_rw("library", &LinearChoice::library)
        .def_rw("matching", &LinearChoice::matching)
        .def_rw("minimum_degree", &LinearChoice::minimum_degree)
        .def_rw("last_resort", &LinearChoice::last_resort)
        .def_rw("borrow_from", &LinearChoice::borrow_from)
        .def_rw("method", &LinearChoice::method)
        .def_rw("preconditioner", &LinearChoice::preconditioner)
        .def_rw("tolerance", &LinearChoice::tolerance)
        .def_rw("max_iterations", &LinearChoice::max_iterations)
        .def_rw("restart", &LinearChoice::restart)
        .def("set_parts",
             [](LinearChoice& c, const std::vector<LinearChoice>& mechanics,
                const std::vector<LinearChoice>& heat, const Ints& is_heat) {
                 c.parts[0] = mechanics, c.parts[1] = heat, c.is_second = flags_of(is_heat);
             })
        .def("set_outside",
             [](LinearChoice& c, nb::object make) { c.outside = outside_solver(std::move(make)); })
        .def("set_aggregator", [](LinearChoice& c, nb::object f) { c.aggregator = aggregator_of(f); });
}

void bind_solver(nb::module_& m) {
    nb::class_<Linear>(m, "Linear")
        .def(nb::init<const std::vector<LinearChoice>&, const Longs&, const Ints&, const Ints&,
                      const Doubles&, const Ints&, const std::vector<int>&, const std::vector<int>&,
                      const std::vector<double>&>(),
             nb::arg("choices"), nb::arg("row"), nb::arg("col"), nb::arg("node"), nb::arg("modes"),
             nb::arg("multiplier"), nb::arg("place") = std::vector<int>(),
             nb::arg("algebraic") = std::vector<int>(), nb::arg("scale") = std::vector<double>())
        .def("factor", &Linear::factor)
        .def("solve", &Linear::solve, nb::arg("rhs"), nb::arg("x"), nb::arg("tolerance") = 0.0)
        .def("forget", [](Linear& l) { l.solver->forget(); })
        .def_prop_ro("name", [](const Linear& l) { return l.solver->report().name; })
        .def_prop_ro("message", [](const Linear& l) { return l.solver->report().message; })
        .def_prop_ro("iterations", [](const Linear& l) { return l.solver->report().n_iterations; })
        .def_prop_ro("n_negative", [](const Linear& l) { return l.solver->report().n_negative; })
        .def_prop_ro("memory", [](const Linear& l) { return l.solver->report().memory; })
        .def_prop_ro("singular_unknown", [](const Linear& l) { return l.solver->report().singular_unknown; });
}

}  // namespace

void bind_linear(nb::module_& m) {
    nb::register_exception_translator([](const std::exception_ptr& p, void*) {
        try {
            std::rethrow_exception(p);
        } catch (const MemoryShortage& e) {
            PyErr_SetString(nb::module_::import_("visviva.base.errors").attr("InputError").ptr(), e.what());
        } catch (const FailedElsewhere& e) {
            PyErr_SetString(nb::module_::import_("visviva.base.errors").attr("NotFinite").ptr(), e.what());
        }
    });
    bind_choice(m);
    bind_solver(m);
    m.def("missing_pardiso", &missing_pardiso, nb::arg("library"));
    m.def("available_memory", &available_memory);
    m.def("asymmetry", [](const Longs& row, const Ints& col, const Doubles& value) {
        const Asymmetry found =
            asymmetry({row.data(), row.size()}, {col.data(), col.size()}, {value.data(), value.size()});
        return std::pair(found.size, found.row);
    });
    m.def("left_in_groups", &left_in_groups);
}
