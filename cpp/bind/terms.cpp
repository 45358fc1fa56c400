// Binding of terms: strains with laws, inertia, and functions of the user.
#include "arrays.hpp"
#include "callback.hpp"
#include "parts.hpp"
#include "visviva/strain/strain_term.hpp"
#include "visviva/term/callback_term.hpp"
#include "visviva/term/inertia_term.hpp"
#include "visviva/term/mirror.hpp"

using namespace visviva;

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

static nb::tuple arrays_of(const LawArguments& a) {
    const auto e = static_cast<std::size_t>(a.n_e), m = static_cast<std::size_t>(a.n_m),
               n = static_cast<std::size_t>(a.stride), h = static_cast<std::size_t>(a.n_h);
    return nb::make_tuple(own(a.e0, e, n), own(a.e_eval, e, n), own(a.e1, e, n), own(a.e_rate, e, n),
                          own(a.lambda, m, n), own(a.S, e, n), own(a.D, e * e, n), own(a.R, e * e, n),
                          own(a.Phi, m, n), own(a.J, m * e, n), own(a.Jt, m * e, n), own(a.W, 1, n),
                          own(a.h0, h, n), own(a.h1, h, n), own(a.lost, h > 0 ? 1 : 0, n));
}

LawCallback law_callback(const Term* term, const nb::object& function) {
    return [f = Callback(term, function)](const LawArguments& a) {
        if (a.n == 0) return;  // one of several processes may have no elements; functions need not take none
        nb::gil_scoped_acquire gil;
        f(a.n, a.want_tangent, a.t, a.h, a.stress == Stress::discrete_gradient, arrays_of(a));
    };
}

static CallbackTerm::Function term_callback(const Term* term, const nb::object& function, std::size_t n,
                                            std::size_t nl) {
    if (function.is_none()) return {};
    return [f = Callback(term, function), n, nl](const TermArguments& a) {
        nb::gil_scoped_acquire gil;
        const std::size_t shape[3] = {n, nl, nl};
        f(*a.step, own(a.x0, n, nl), own(a.x1, n, nl), own(a.rate, n, nl), own(a.second_rate, n, nl),
          own(a.v1, n, nl), own(a.residual, n, nl), View(a.tangent, 3, shape, nb::none()),
          view(a.energy, n, nb::none()), view(a.work, n, nb::none()), own(a.momentum, n, 6),
          own(a.v0, n, nl));
    };
}

void bind_terms(nb::module_& m) {
    bind_kinds<LawKind>(m, "LawKind", law_traits);
    m.def("caller", &Callback::caller);
    nb::class_<Term>(m, "Term")
        .def_rw("name", &Term::name)
        .def_rw("is_rigidity", &Term::is_rigidity)
        .def_rw("entropy_account", &Term::entropy_account)
        .def("book", [](Term& t, const Ints& account, const Ints& component) {
            t.account = vector_of<int>(account);
            t.component = vector_of<int>(component);
        });
    nb::class_<Mirror, Term>(m, "Mirror").def(nb::init<std::shared_ptr<Term>>());
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
        .def("set_callback", [](StrainTerm& t, nb::object f) { t.set_callback(law_callback(&t, f)); });
    nb::class_<InertiaTerm, Term>(m, "InertiaTerm")
        .def("__init__", [](InertiaTerm* t, int order, int n_nodes, int dim, const Ints& pair,
                            const Doubles& mass, const Ints& index, const Ints& is_position) {
            new (t) InertiaTerm(order, n_nodes, dim, static_cast<int>(index.shape(1)), vector_of<int>(pair),
                                mass.data(), index.data(), flags_of(is_position));
        });
    nb::class_<CallbackTerm, Term>(m, "CallbackTerm")
        .def("__init__",
             [](CallbackTerm* t, const Ints& index, nb::object residual, nb::object tangent,
                nb::object ledger, nb::object accept) {
                 const auto n = index.shape(0), nl = index.shape(1);
                 new (t) CallbackTerm(static_cast<int>(n), static_cast<int>(nl), index.data(),
                                      term_callback(t, residual, n, nl), term_callback(t, tangent, n, nl),
                                      term_callback(t, ledger, n, nl), term_callback(t, accept, n, nl));
             })
        .def("ask_to_look",
             [](CallbackTerm& t, nb::object function, std::size_t n) {
                 t.look = [f = Callback(&t, function), n](const double* x) {
                     nb::gil_scoped_acquire gil;
                     f(view(const_cast<double*>(x), n, nb::none()));
                 };
             })
        .def_rw("work_account", &CallbackTerm::work_account);
}
