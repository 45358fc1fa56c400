// Binding of systems.
#include "visviva/system/system.hpp"

#include "arrays.hpp"
#include "outside.hpp"
#include "parts.hpp"
#include "visviva/linear/linear_choice.hpp"
#include "visviva/linear/reduce/contact_condensation.hpp"
#include "visviva/linear/reduce/director_elimination.hpp"
#include "visviva/linear/reduce/element_condensation.hpp"
#include "visviva/linear/reduce/slave_elimination.hpp"

using namespace visviva;

// Signals live in one array of four rows: values at t0, te, t1 and the rate at t1.
static Signals signals_of(const Doubles& a) {
    const std::size_t n = a.shape(1);
    return {a.data(), a.data() + n, a.data() + 2 * n, a.data() + 3 * n};
}

static Blocks blocks_of(const Ints& block, const Ints& stage, const Ints& multiplier, const Ints& rigid) {
    Blocks b;
    b.block = vector_of<int>(block);
    b.stage = vector_of<int>(stage);
    b.multiplier = flags_of(multiplier);
    for (std::size_t k = 0; k < rigid.size() / 18; ++k) {
        RigidUnknowns r;
        std::copy(rigid.data() + 18 * k, rigid.data() + 18 * k + 12, r.q);
        std::copy(rigid.data() + 18 * k + 12, rigid.data() + 18 * k + 18, r.multiplier);
        b.rigid.push_back(r);
    }
    return b;
}

#define VISVIVA_STATE(name)                                                \
    .def_prop_ro(#name, [](nb::handle self) {                              \
        auto& s = nb::cast<System&>(self);                                 \
        return view(s.name.data(), static_cast<std::size_t>(s.n()), self); \
    })
#define VISVIVA_SUM(name)                                          \
    .def_prop_ro(#name, [](nb::handle self) {                      \
        auto& s = nb::cast<System&>(self);                         \
        return view(s.sums.name.data(), s.sums.name.size(), self); \
    })

// Number of unknowns that a kind of reduction has taken out of the equations.
template <class T>
static int n_reduced(const System& s) {
    int n = 0;
    for (const auto& reduction : s.reductions())
        if (const auto* kind = dynamic_cast<const T*>(reduction.get())) n += kind->n();
    return n;
}

static void bind_records(nb::module_& m) {
    nb::class_<Snapshot>(m, "Snapshot");
    nb::class_<Record>(m, "Record")
        .def("__init__",
             [](Record* record, std::string name, int version, const Doubles& numbers) {
                 new (record) Record{std::move(name), version, vector_of<double>(numbers)};
             })
        .def_ro("name", &Record::name)
        .def_ro("version", &Record::version)
        .def_prop_ro(
            "numbers", [](const Record& record) { return handed_over(record.numbers); }, nb::rv_policy::move);
}

// Parts of the equations.
static void bind_unknowns(nb::class_<System>& system) {
    system
        .def("__init__",
             [](System* s, const Ints& order, const Ints& fixed, const Doubles& scale, const Ints& flows) {
                 new (s) System(vector_of<int>(order), flags_of(fixed), vector_of<double>(scale),
                                flags_of(flows));
             })
        .def("add", &System::add)
        .def("set_accounts",
             [](System& s, int n_accounts, int n_components, const Ints& of_heat) {
                 s.set_accounts(n_accounts, n_components, flags_of(of_heat));
             })
        .def(
            "set_processes",
            [](System& s, nb::object processes) { s.set_processes(outside_processes(std::move(processes))); })
        .def("set_nodes", [](System& s, const Ints& node) { s.set_nodes(vector_of<int>(node)); })
        .def("set_places", [](System& s, const Ints& place) { s.set_places(vector_of<int>(place)); })
        .def("set_blocks",
             [](System& s, const Ints& block, const Ints& stage, const Ints& multiplier, const Ints& rigid) {
                 s.set_blocks(blocks_of(block, stage, multiplier, rigid));
             })
        .def("finalize", &System::finalize)
        .def("set_signal_count", &System::set_signal_count)
        .def("set_judged",
             [](System& s, const Ints& multipliers) { s.set_judged(vector_of<int>(multipliers)); })
        .def("set_prescribed",
             [](System& s, const Ints& unknown, const Ints& account, const Ints& supply) {
                 std::vector<Supply> kinds;
                 for (std::size_t k = 0; k < supply.size(); ++k)
                     kinds.push_back(static_cast<Supply>(supply.data()[k]));
                 s.set_prescribed(vector_of<int>(unknown), vector_of<int>(account), std::move(kinds));
             })
        .def("set_islands",
             [](System& s, const Ints& island, const Ints& account, const Ints& island_of_account) {
                 s.set_islands(vector_of<int>(island), vector_of<int>(account),
                               vector_of<int>(island_of_account));
             })
        .def("set_drives",
             [](System& s, const Ints& multiplier, const Ints& account) {
                 s.set_drives(vector_of<int>(multiplier), vector_of<int>(account));
             })
        .def("set_entropy", [](System& s, const Ints& tested, const Ints& unknown, const Doubles& weight,
                               const Ints& account, const Ints& light) {
            s.set_entropy({vector_of<int>(tested), vector_of<int>(unknown), vector_of<double>(weight),
                           vector_of<int>(account), vector_of<int>(light)});
        });
}

// Reductions of the equations before they are solved.
static void bind_reductions(nb::class_<System>& system) {
    system
        .def("condense_elements",
             [](System& s, const Ints& element) {
                 s.add_reduction(std::make_shared<ElementCondensation>(vector_of<int>(element)));
             })
        .def("condense_contact",
             [](System& s, const Ints& multiplier, const Ints& unknown, const Ints& size) {
                 std::vector<NodalMultiplier> all;
                 for (std::size_t k = 0; k < multiplier.size(); ++k)
                     all.push_back({multiplier.data()[k], unknown.data()[k], size.data()[k]});
                 s.add_reduction(std::make_shared<ContactCondensation>(std::move(all)));
             })
        .def("eliminate_slaves",
             [](System& s, const Ints& unknown, const Ints& multiplier) {
                 std::vector<Dependence> all;
                 for (std::size_t k = 0; k < unknown.size(); ++k)
                     all.push_back({unknown.data()[k], multiplier.data()[k]});
                 s.add_reduction(std::make_shared<SlaveElimination>(std::move(all)));
             })
        .def("eliminate_directors",
             [](System& s, const Ints& unknown, const Ints& multiplier) {
                 std::vector<HeldLength> all;
                 for (std::size_t k = 0; k < unknown.size(); ++k)
                     all.push_back({unknown.data()[k], multiplier.data()[k]});
                 s.add_reduction(std::make_shared<DirectorElimination>(std::move(all)));
             })
        .def_prop_ro("n_eliminated", n_reduced<SlaveElimination>)
        .def_prop_ro("n_exchanged", n_reduced<ContactCondensation>)
        .def_prop_ro("n_lengths", n_reduced<DirectorElimination>)
        .def_prop_ro("n_equations", [](const System& s) { return s.solved().n; })
        .def_prop_ro("n_entries", [](const System& s) { return s.solved().col.size(); });
}

// Solvers of linear equations.
static void bind_solvers(nb::class_<System>& system) {
    system
        .def("use_solver",
             [](System& s, bool null_space, double regularization) {
                 auto solver = null_space ? make_null_space() : make_sparse_lu();
                 solver->regularization = regularization;
                 s.set_solver(std::move(solver));
             })
        .def("use_linear",
             [](System& s, const std::vector<LinearChoice>& choices) { s.set_solver(make_linear(choices)); })
        .def("use_rate_solver",
             [](System& s, bool null_space, double regularization, const Ints& constraint) {
                 auto solver = null_space ? make_null_space() : make_sparse_lu();
                 solver->regularization = regularization;
                 s.set_rate_solver(std::move(solver), flags_of(constraint));
             })
        .def("use_rate_linear",
             [](System& s, const std::vector<LinearChoice>& choices, const Ints& constraint) {
                 s.set_rate_solver(make_linear(choices), flags_of(constraint));
             })
        .def_prop_ro("projects_rates", &System::projects_rates)
        .def(
            "set_modes",
            [](System& s, nb::callable make, int n_modes) {
                s.set_modes(
                    [make = kept(std::move(make)), n_modes](const std::vector<int>& unknown, double* to) {
                        nb::gil_scoped_acquire gil;
                        const auto k = static_cast<std::size_t>(n_modes);
                        (*make)(seen(unknown), view(to, unknown.size(), k, nb::none()));
                    },
                    n_modes);
            },
            "What puts the modes (n, n_modes) of unknowns (n,) where zeros are")
        .def("allow_last_resort", &System::allow_last_resort)
        .def_prop_ro("solver",
                     [](const System& s) { return s.solver() ? s.solver()->report().name : std::string(); })
        .def_prop_ro(
            "linear_message",
            [](const System& s) { return s.solver() ? s.solver()->report().message : std::string(); })
        .def_prop_ro("n_negative",
                     [](const System& s) { return s.solver() ? s.solver()->report().n_negative : -1; })
        .def(
            "linear_solve",
            [](System& s, const Step& step, const Doubles& residual, Array d, double tolerance) {
                nb::gil_scoped_release release;
                return s.linear_solve(step, residual.data(), d.data(), tolerance);
            },
            nb::arg("step"), nb::arg("residual"), nb::arg("d"), nb::arg("tolerance") = 0.0)
        .def("asymmetry", &System::asymmetry);
}

// Steps in time.
static void bind_steps(nb::class_<System>& system) {
    system
        .def("solve",
             [](System& s, const Step& step, const Doubles& signals, double tolerance, int max_iterations,
                double keep_factor, int n_tangents) {
                 nb::gil_scoped_release release;
                 return s.solve(step, signals_of(signals),
                                {tolerance, max_iterations, keep_factor, n_tangents});
             })
        .def(
            "advance",
            [](System& s, const Step& step, nb::object signals, double tolerance, int max_iterations,
               double keep_factor, int n_tangents) {
                const Signals given =
                    signals.is_none() ? s.no_signals() : signals_of(nb::cast<Doubles>(signals));
                nb::gil_scoped_release release;
                return s.advance(step, given, {tolerance, max_iterations, keep_factor, n_tangents});
            },
            nb::arg("step"), nb::arg("signals").none(), nb::arg("tolerance"), nb::arg("max_iterations"),
            nb::arg("keep_factor"), nb::arg("n_tangents") = 0)
        .def("accept",
             [](System& s, const Step& step, const Doubles& signals, bool ledger) {
                 nb::gil_scoped_release release;
                 return s.accept(step, signals_of(signals), ledger);
             })
        .def("discard", &System::discard)
        .def("begin_at",
             [](System& s, const Ints& unknown, const Doubles& increment) {
                 s.begin_at(vector_of<int>(unknown), vector_of<double>(increment));
             })
        .def("evaluate_ledger",
             [](System& s, const Step& step, const Doubles& signals, bool moves) {
                 nb::gil_scoped_release release;
                 s.evaluate_ledger(step, signals_of(signals), moves);
             })
        .def("refuse", [](System& s, const Step& step,
                          const Doubles& signals) { return s.refuse(step, signals_of(signals)); })
        .def("meets_rounding", [](const System& s, const Doubles& residual, double size, double last) {
            return s.meets_rounding(residual.data(), size, last);
        });
}

// Memory, and its restoration.
static void bind_memory(nb::class_<System>& system) {
    system.def("memory", &System::memory)
        .def("histories", [](const System& s) { return handed_over(s.histories()); })
        .def("restore_histories",
             [](System& s, const Doubles& m) { s.restore_histories(vector_of<double>(m)); })
        .def("restore", &System::restore)
        .def("snapshot", &System::snapshot)
        .def("restore_snapshot", &System::restore_snapshot)
        .def("invalidate", &System::invalidate)
        .def("mark_state", &System::mark_state)
        .def_prop_ro("is_unchanged", &System::is_unchanged);
}

// Equations as arrays.
static void bind_assembly(nb::class_<System>& system) {
    system
        .def("forces", [](System& s, const Step& step, const Doubles& signals,
                          Array out) { s.forces(step, signals_of(signals), out.data()); })
        .def("solve_instant",
             [](System& s, const Step& step, const Doubles& signals, const Doubles& residual, Array out) {
                 return s.solve_instant(step, signals_of(signals), residual.data(), out.data());
             })
        .def("find_redundant", [](System& s, const Step& step, const Doubles& signals,
                                  bool on) { return s.find_redundant(step, signals_of(signals), on); })
        .def(
            "assemble",
            [](System& s, const Step& step, const Doubles& signals, Array residual, nb::object values) {
                double* k = nullptr;
                if (!values.is_none()) {
                    const Array entries = nb::cast<Array>(values);
                    if (entries.size() < s.assembled().col.size())
                        throw std::invalid_argument("values is smaller than what is assembled");
                    k = entries.data();
                }
                nb::gil_scoped_release release;
                s.assemble(step, signals_of(signals), residual.data(), k);
            },
            nb::arg("step"), nb::arg("signals"), nb::arg("residual"), nb::arg("values").none())
        .def("linearise",
             [](System& s, const Step& step, const Doubles& signals, Array residual) {
                 nb::gil_scoped_release release;
                 return s.linearise(step, signals_of(signals), residual.data());
             })
        .def("find_neighbours", [](System& s) { return s.find_neighbours(); })
        .def_prop_ro("revision", &System::revision)
        .def_prop_ro("rewiring", &System::rewiring)
        .def("profile", &System::profile)
        .def_prop_ro("phases",
                     [](const System& s) {
                         const Phases& p = s.phases();
                         nb::dict found;
                         found["assembly"] = p.assembly, found["contact"] = p.contact;
                         found["factorisation"] = p.factorisation, found["solution"] = p.solution;
                         found["ledger"] = p.ledger, found["solutions"] = p.n_solutions;
                         found["iterations"] = p.n_iterations;
                         return found;
                     })
        .def_prop_ro("is_outdated", &System::is_outdated)
        .def_prop_ro("is_settled", &System::is_settled)
        .def("set_monotone", &System::set_monotone)
        .def("set_cracking", &System::set_cracking)
        .def_prop_ro("resting", &System::resting)
        .def("halt",
             [](System& s, const std::vector<int>& halted) {
                 s.halt(std::vector<char>(halted.begin(), halted.end()));
             })
        .def("trial_energies",
             [](System& s, const Step& step, const Doubles& signals) {
                 nb::gil_scoped_release release;
                 return s.trial_energies(step, signals_of(signals));
             })
        .def_prop_ro("csr", [](nb::handle self) {
            auto view = [self]<class T>(const std::vector<T>& a) {
                return nb::ndarray<nb::numpy, const T, nb::ndim<1>>(a.data(), {a.size()}, self);
            };
            const Csr& c = nb::cast<const System&>(self).csr();
            return nb::make_tuple(view(c.row), view(c.col), view(c.unknown));
        });
}

// Vectors of the state and sums of the ledger, as views.
static void bind_state(nb::class_<System>& system) {
    system VISVIVA_STATE(x) VISVIVA_STATE(dx) VISVIVA_STATE(v) VISVIVA_STATE(a) VISVIVA_STATE(w)
        VISVIVA_SUM(energy) VISVIVA_SUM(work) VISVIVA_SUM(momentum) VISVIVA_SUM(defect) VISVIVA_SUM(release)
            VISVIVA_SUM(entropy);
}

void bind_system(nb::module_& m) {
    bind_records(m);
    nb::class_<System> system(m, "System");
    bind_unknowns(system);
    bind_reductions(system);
    bind_solvers(system);
    bind_steps(system);
    bind_memory(system);
    bind_assembly(system);
    bind_state(system);
}
