// The Python binding. Arrays cross as contiguous float64; everything a user sees is defined in Python.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "callback.hpp"
#include "linear.hpp"
#include "visviva/base/instructions.hpp"
#include "visviva/linear/linear_choice.hpp"
#include "visviva/linear/reduce/contact_condensation.hpp"
#include "visviva/linear/reduce/element_condensation.hpp"
#include "visviva/linear/reduce/slave_elimination.hpp"
#include "visviva/solid/solid_dispatch.hpp"
#include "visviva/solid/solid_term.hpp"
#include "visviva/strain/strain_term.hpp"
#include "visviva/system/system.hpp"
#include "visviva/term/callback_term.hpp"
#include "visviva/term/inertia_term.hpp"

namespace nb = nanobind;
using namespace visviva;

using Array = nb::ndarray<double, nb::c_contig, nb::device::cpu>;
using Doubles = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Ints = nb::ndarray<const int, nb::c_contig, nb::device::cpu>;
using View = nb::ndarray<nb::numpy, double>;

template <class T>
static std::vector<T> vector_of(const nb::ndarray<const T, nb::c_contig, nb::device::cpu>& a) {
    return {a.data(), a.data() + a.size()};
}
static std::vector<char> flags_of(const Ints& a) { return {a.data(), a.data() + a.size()}; }

static View view(double* data, std::size_t rows, std::size_t cols, nb::handle owner) {
    const std::size_t shape[2] = {rows, cols};
    return View(data, 2, shape, owner);
}
static View view(double* data, std::size_t n, nb::handle owner) { return View(data, 1, &n, owner); }
static View own(const double* data, std::size_t rows, std::size_t cols) {
    return view(const_cast<double*>(data), rows, cols, nb::none());
}

static StrainShape shape_of(int n_x, int n_y, int n_e, int n_m, int law, const Ints& forms, const Ints& quad,
                            const Doubles& quad_coef, const Ints& lin, const Doubles& lin_coef) {
    StrainShape s;
    s.n_x = n_x, s.n_y = n_y, s.n_e = n_e, s.n_m = n_m, s.law = static_cast<LawKind>(law);
    for (std::size_t k = 0; k < forms.size() / 2; ++k) {
        s.form_row.push_back(forms.data()[2 * k]);
        s.form_col.push_back(forms.data()[2 * k + 1]);
    }
    for (std::size_t k = 0; k < quad.size() / 3; ++k) {
        s.quad_e.push_back(quad.data()[3 * k]);
        s.quad_a.push_back(quad.data()[3 * k + 1]);
        s.quad_b.push_back(quad.data()[3 * k + 2]);
    }
    for (std::size_t k = 0; k < lin.size() / 2; ++k) {
        s.lin_e.push_back(lin.data()[2 * k]);
        s.lin_a.push_back(lin.data()[2 * k + 1]);
    }
    s.quad_coef = vector_of<double>(quad_coef);
    s.lin_coef = vector_of<double>(lin_coef);
    return s;
}

static void tables(Step& s, const Doubles& motion, const Doubles& transport) {
    std::copy(motion.data(), motion.data() + 20, &s.motion[0][0]);
    std::copy(transport.data(), transport.data() + 20, &s.transport[0][0]);
}

// Signals live in one array of four rows: values at t0, te, t1 and the rate at t1.
static Signals signals_of(const Doubles& a) {
    const std::size_t n = a.shape(1);
    return {a.data(), a.data() + n, a.data() + 2 * n, a.data() + 3 * n};
}

static nb::tuple arrays_of(const LawArguments& a) {
    const auto e = static_cast<std::size_t>(a.n_e), m = static_cast<std::size_t>(a.n_m),
               n = static_cast<std::size_t>(a.stride), h = static_cast<std::size_t>(a.n_h);
    return nb::make_tuple(own(a.e0, e, n), own(a.e_eval, e, n), own(a.e1, e, n), own(a.e_rate, e, n),
                          own(a.lambda, m, n), own(a.S, e, n), own(a.D, e * e, n), own(a.R, e * e, n),
                          own(a.Phi, m, n), own(a.J, m * e, n), own(a.Jt, m * e, n), own(a.W, 1, n),
                          own(a.h0, h, n), own(a.h1, h, n), own(a.lost, h > 0 ? 1 : 0, n));
}

// Functions of the user often know the system that calls them. The Python side owns them, and only weak
// references lie here, where the garbage collector could not see the cycle.
static nb::object alive(const nb::weakref& f) {
    nb::object g = f();
    if (g.is_none())
        throw std::runtime_error("a function of the user was called after its system was released");
    return g;
}

LawCallback law_callback(nb::object function) {
    return [f = nb::weakref(function)](const LawArguments& a) {
        nb::gil_scoped_acquire gil;
        alive(f)(a.n, a.want_tangent, a.t, a.h, a.stress == Stress::discrete_gradient, arrays_of(a));
    };
}

static CallbackTerm::Function term_callback(nb::object function, std::size_t n, std::size_t nl) {
    if (function.is_none()) return {};
    return [f = nb::weakref(function), n, nl](const TermArguments& a) {
        nb::gil_scoped_acquire gil;
        const std::size_t shape[3] = {n, nl, nl};
        alive(f)(*a.step, own(a.x0, n, nl), own(a.x1, n, nl), own(a.rate, n, nl), own(a.second_rate, n, nl),
                 own(a.v1, n, nl), own(a.residual, n, nl), View(a.tangent, 3, shape, nb::none()),
                 view(a.energy, n, nb::none()), view(a.work, n, nb::none()), own(a.momentum, n, 6),
                 own(a.v0, n, nl));
    };
}

static const double* optional(const nb::object& a) {
    return a.is_none() ? nullptr : nb::cast<Doubles>(a).data();
}

// Arrays that Python owns.
using Cube = nb::ndarray<nb::numpy, double, nb::ndim<3>>;
static Cube owned(std::vector<double>* data, std::initializer_list<std::size_t> shape) {
    nb::capsule owner(data, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
    return Cube(data->data(), shape, owner);
}
static int padded(int n) { return (n + solid_lanes - 1) / solid_lanes * solid_lanes; }

static void material(int kind, const Doubles& par, const Doubles& c, Array out) {
    if (par.size() > material_max_parameters || out.size() != c.shape(0) * 28 || c.shape(1) != 6)
        throw std::invalid_argument("a material needs its parameters, strains (n, 6) and room (n, 28)");
    solid_kernels().material(static_cast<MaterialKind>(kind), par.data(), static_cast<int>(par.size()),
                             static_cast<int>(c.shape(0)), c.data(), out.data());
}

static void bind_solid(nb::module_& m) {
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
        .def("set_callback", [](SolidTerm& t, nb::object f) { t.set_callback(law_callback(f)); })
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
                 const auto size = static_cast<std::size_t>(padded(end - begin)) * t.n_points() * 16;
                 auto* out = new std::vector<double>(size);
                 t.fields(x.data(), begin, end, out->data());
                 return owned(out, {static_cast<std::size_t>(end - begin),
                                    static_cast<std::size_t>(t.n_points()), 16});
             })
        .def("forces",
             [](SolidTerm& t, const Doubles& x, int begin, int end) {
                 const auto nodes = static_cast<std::size_t>(t.n_nodes()),
                            dim = static_cast<std::size_t>(t.dim());
                 auto* out =
                     new std::vector<double>(static_cast<std::size_t>(padded(end - begin)) * nodes * dim);
                 t.forces(x.data(), begin, end, out->data());
                 return owned(out, {static_cast<std::size_t>(end - begin), nodes, dim});
             })
        .def("book_solid", [](SolidTerm& t, int strain, int kinetic, int damping, int owner, int first) {
            t.strain_account = strain, t.kinetic_account = kinetic, t.damping_account = damping;
            t.owner = owner, t.first_element = first;
        });
}

static void bind_terms(nb::module_& m) {
    nb::class_<Term>(m, "Term")
        .def_rw("name", &Term::name)
        .def_rw("is_rigidity", &Term::is_rigidity)
        .def("book", [](Term& t, const Ints& account, const Ints& component) {
            t.account = vector_of<int>(account);
            t.component = vector_of<int>(component);
        });
    nb::class_<StrainTerm, Term>(m, "StrainTerm")
        .def("__init__",
             [](StrainTerm* t, const std::vector<int>& counts, const Ints& forms, const Ints& quad,
                const Doubles& quad_coef, const Ints& lin, const Doubles& lin_coef, const Ints& index,
                const Doubles& weight, const Doubles& y_const, const Doubles& e_const, const Doubles& par,
                const Ints& signal) {
                 new (t)
                     StrainTerm(shape_of(counts[0], counts[1], counts[2], counts[3], counts[4], forms, quad,
                                         quad_coef, lin, lin_coef),
                                static_cast<int>(index.shape(1)), index.data(), weight.data(), y_const.data(),
                                e_const.data(), par.data(), static_cast<int>(par.shape(0)), signal.data());
             })
        .def("set_callback", [](StrainTerm& t, nb::object f) { t.set_callback(law_callback(f)); });
    nb::class_<InertiaTerm, Term>(m, "InertiaTerm")
        .def("__init__", [](InertiaTerm* t, int order, int n_nodes, int dim, const Ints& pair,
                            const Doubles& mass, const Ints& index, const Ints& is_position) {
            new (t) InertiaTerm(order, n_nodes, dim, static_cast<int>(index.shape(1)), vector_of<int>(pair),
                                mass.data(), index.data(), flags_of(is_position));
        });
    bind_solid(m);
    bind_point(m);
    bind_contact(m);
    bind_flow(m);
    bind_immersed(m);
    nb::class_<CallbackTerm, Term>(m, "CallbackTerm")
        .def("__init__",
             [](CallbackTerm* t, const Ints& index, nb::object residual, nb::object tangent,
                nb::object ledger, nb::object accept) {
                 const auto n = index.shape(0), nl = index.shape(1);
                 new (t) CallbackTerm(static_cast<int>(n), static_cast<int>(nl), index.data(),
                                      term_callback(residual, n, nl), term_callback(tangent, n, nl),
                                      term_callback(ledger, n, nl), term_callback(accept, n, nl));
             })
        .def_rw("work_account", &CallbackTerm::work_account);
}

static void bind_step(nb::module_& m) {
    nb::class_<Step>(m, "Step")
        .def(
            "__init__",
            [](Step* s, double t0, double h, double te, double theta, double theta_g, bool discrete_gradient,
               const Doubles& motion, const Doubles& transport, bool projects_rates) {
                new (s) Step();
                s->projects_rates = projects_rates;
                s->t0 = t0, s->h = h, s->t1 = t0 + h, s->te = te, s->theta = theta, s->theta_g = theta_g;
                s->stress = discrete_gradient ? Stress::discrete_gradient : Stress::at_theta;
                tables(*s, motion, transport);
            },
            nb::arg("t0"), nb::arg("h"), nb::arg("te"), nb::arg("theta"), nb::arg("theta_g"),
            nb::arg("discrete_gradient"), nb::arg("motion"), nb::arg("transport"),
            nb::arg("projects_rates") = false)
        .def("moved_to",
             [](const Step& s, double t0) {  // the same step at another time
                 Step moved = s;
                 moved.t0 = t0, moved.t1 = t0 + s.h, moved.te = t0 + s.theta * s.h;
                 return moved;
             })
        .def_ro("t0", &Step::t0)
        .def_ro("t1", &Step::t1)
        .def_ro("te", &Step::te)
        .def_ro("h", &Step::h)
        .def_prop_ro("has_length", &Step::has_length)
        .def_prop_ro_static("NO_LENGTH", [](nb::handle) { return Step::no_length; })
        .def_ro("theta", &Step::theta)
        .def_ro("theta_g", &Step::theta_g)
        .def_prop_ro("discrete_gradient", [](const Step& s) { return s.stress == Stress::discrete_gradient; })
        .def_prop_ro("rate_factor", [](const Step& s) { return s.motion[0][0]; })
        .def_prop_ro("second_rate_factor", [](const Step& s) { return s.motion[1][0]; })
        .def_prop_ro("transport_factor", [](const Step& s) { return s.transport[0][0]; });
    nb::class_<Report>(m, "Report")
        .def_ro("converged", &Report::converged)
        .def_ro("iterations", &Report::iterations)
        .def_ro("factorizations", &Report::factorizations)
        .def_ro("increments", &Report::increments)
        .def_ro("worst_unknown", &Report::worst_unknown)
        .def_ro("reason", &Report::reason);
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

// How many unknowns a kind of reduction has taken out of the equations.
template <class T>
static int n_reduced(const System& s) {
    int n = 0;
    for (const auto& reduction : s.reductions())
        if (const auto* kind = dynamic_cast<const T*>(reduction.get())) n += kind->n();
    return n;
}

static void bind_system(nb::module_& m) {
    nb::class_<Snapshot>(m, "Snapshot");
    nb::class_<System>(m, "System")
        .def("__init__",
             [](System* s, const Ints& order, const Ints& fixed, const Doubles& scale) {
                 new (s) System(vector_of<int>(order), flags_of(fixed), vector_of<double>(scale));
             })
        .def("add", &System::add)
        .def("set_accounts", &System::set_accounts)
        .def("set_nodes", [](System& s, const Ints& node) { s.set_nodes(vector_of<int>(node)); })
        .def("set_blocks",
             [](System& s, const Ints& block, const Ints& stage, const Ints& multiplier, const Ints& rigid) {
                 s.set_blocks(blocks_of(block, stage, multiplier, rigid));
             })
        .def("condense_elements",
             [](System& s, const Ints& element) {
                 s.add_reduction(std::make_shared<ElementCondensation>(vector_of<int>(element)));
             })
        .def("finalize", &System::finalize)
        .def("use_solver",
             [](System& s, bool null_space, double regularization) {
                 auto solver = null_space ? make_null_space() : make_sparse_lu();
                 solver->regularization = regularization;
                 s.set_solver(std::move(solver));
             })
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
        .def("set_modes",
             [](System& s, const Doubles& modes) {
                 s.set_modes(vector_of<double>(modes), static_cast<int>(modes.shape(1)));
             })
        .def_prop_ro("n_equations", [](const System& s) { return s.solved().n; })
        .def_prop_ro("n_entries", [](const System& s) { return s.solved().col.size(); })
        .def_prop_ro("n_eliminated", n_reduced<SlaveElimination>)
        .def("use_linear",
             [](System& s, const std::vector<LinearChoice>& choices) { s.set_solver(make_linear(choices)); })
        .def("allow_last_resort", &System::allow_last_resort)
        .def_prop_ro("solver",
                     [](const System& s) { return s.solver() ? s.solver()->report().name : std::string(); })
        .def_prop_ro(
            "linear_message",
            [](const System& s) { return s.solver() ? s.solver()->report().message : std::string(); })
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
                 s.accept(step, signals_of(signals), ledger);
             })
        .def("discard", &System::discard)
        .def("set_signal_count", &System::set_signal_count)
        .def("set_driven", &System::set_driven)
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
        .def_prop_ro("n_exchanged", n_reduced<ContactCondensation>)
        .def_prop_ro("n_negative",
                     [](const System& s) { return s.solver() ? s.solver()->report().n_negative : -1; })
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
        .def("memory",
             [](const System& s) {
                 auto* m = new std::vector<double>(s.memory());
                 nb::capsule owner(m, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
                 return nb::ndarray<nb::numpy, double, nb::ndim<1>>(m->data(), {m->size()}, owner);
             })
        .def("find_redundant", [](System& s, const Step& step, const Doubles& signals,
                                  bool on) { return s.find_redundant(step, signals_of(signals), on); })
        .def("restore", [](System& s, const Doubles& m) { s.restore(vector_of<double>(m)); })
        .def("snapshot", &System::snapshot)
        .def("restore_snapshot", &System::restore_snapshot)
        .def("invalidate", &System::invalidate)
        .def("mark_state", &System::mark_state)
        .def_prop_ro("is_unchanged", &System::is_unchanged)
        .def("forces", [](System& s, const Step& step, const Doubles& signals,
                          Array out) { s.forces(step, signals_of(signals), out.data()); })
        .def("evaluate_ledger",
             [](System& s, const Step& step, const Doubles& signals, bool moves) {
                 nb::gil_scoped_release release;
                 s.evaluate_ledger(step, signals_of(signals), moves);
             })
        .def(
            "assemble",
            [](System& s, const Step& step, const Doubles& signals, Array residual, nb::object values) {
                double* k = values.is_none() ? nullptr : nb::cast<Array>(values).data();
                nb::gil_scoped_release release;
                s.assemble(step, signals_of(signals), residual.data(), k);
            },
            nb::arg("step"), nb::arg("signals"), nb::arg("residual"), nb::arg("values").none())
        .def("find_neighbours", [](System& s) { return s.find_neighbours(); })
        .def_prop_ro("revision", &System::revision)
        .def_prop_ro("rewiring", &System::rewiring)
        .def("linearise",
             [](System& s, const Step& step, const Doubles& signals, Array residual) {
                 nb::gil_scoped_release release;
                 return s.linearise(step, signals_of(signals), residual.data());
             })
        .def_prop_ro("is_outdated", &System::is_outdated)
        .def(
            "linear_solve",
            [](System& s, const Step& step, const Doubles& residual, Array d, double tolerance) {
                nb::gil_scoped_release release;
                return s.linear_solve(step, residual.data(), d.data(), tolerance);
            },
            nb::arg("step"), nb::arg("residual"), nb::arg("d"), nb::arg("tolerance") = 0.0)
        .def("refuse", [](System& s, const Step& step,
                          const Doubles& signals) { return s.refuse(step, signals_of(signals)); })
        .def_prop_ro("csr",
                     [](nb::handle self) {
                         auto view = [self]<class T>(const std::vector<T>& a) {
                             return nb::ndarray<nb::numpy, const T, nb::ndim<1>>(a.data(), {a.size()}, self);
                         };
                         const Csr& c = nb::cast<const System&>(self).csr();
                         return nb::make_tuple(view(c.row), view(c.col), view(c.unknown));
                     }) VISVIVA_STATE(x) VISVIVA_STATE(dx) VISVIVA_STATE(v) VISVIVA_STATE(a) VISVIVA_STATE(w)
            VISVIVA_SUM(energy) VISVIVA_SUM(work) VISVIVA_SUM(momentum) VISVIVA_SUM(defect)
                VISVIVA_SUM(release);
}

NB_MODULE(_core, m) {
    m.doc() = "Compiled core of visviva; use the package, not this module.";
    nb::set_leak_warnings(false);  // systems that somebody still holds at exit are no news to users
    bind_terms(m);
    bind_step(m);
    bind_linear(m);
    bind_system(m);
    instructions();                 // refuses those that are not there as soon as the module is loaded
    m.def("instruction_sets", [] {  // the narrowest first
        std::vector<std::string> names;
        for (const Instructions set : available()) names.emplace_back(name(set));
        return names;
    });
    m.def("instruction_set", [] { return std::string(name(instructions())); });
}
