// Binding of contact: surfaces as arrays.
#include "arrays.hpp"
#include "callback.hpp"
#include "parts.hpp"
#include "visviva/contact/contact_heat.hpp"
#include "visviva/contact/contact_term.hpp"
#include "visviva/contact/overlap.hpp"
#include "visviva/contact/search.hpp"
#include "visviva/contact/segment_points.hpp"
#include "visviva/contact/tie_term.hpp"
#include "visviva/system/system.hpp"

using namespace visviva;

namespace {

Skin skin_of(int dim, const Ints& first, const Ints& unknown, const Doubles& weight, const Ints& mesh_node,
             const Doubles& constant, const Ints& facets, const Doubles& behind, const Doubles& ahead,
             int n_first, int second_begin) {
    Skin s;
    s.dim = dim, s.first = vector_of<int>(first), s.unknown = vector_of<int>(unknown);
    s.weight = vector_of<double>(weight), s.constant = vector_of<double>(constant);
    s.mesh_node.assign(mesh_node.data(), mesh_node.data() + mesh_node.size());
    s.behind = vector_of<double>(behind), s.ahead = vector_of<double>(ahead);
    s.facets = vector_of<int>(facets), s.n_first = n_first, s.second_begin = second_begin;
    return s;
}

std::shared_ptr<Gaps> shared(std::unique_ptr<Gaps> gaps) { return gaps; }

// Facets of the first surface that come nearer than `margin` to facets of the second: pairs [n][2].
std::vector<int> near_facets(const Skin& skin, const double* X, double margin) {
    std::vector<Box> boxes;
    std::vector<double> centres;
    for (int f = skin.second_begin; f < skin.n_facets(); ++f) {
        boxes.push_back(swept(skin, f, X, X, 0));
        for (int i = 0; i < 3; ++i) centres.push_back(0.5 * (boxes.back().low[i] + boxes.back().high[i]));
    }
    BoxTree tree;
    tree.build(centres), tree.refit(boxes);
    std::vector<int> pairs, found;
    for (int f = 0; f < skin.n_first; ++f) {
        tree.query(swept(skin, f, X, X, margin), found);
        for (int k : found) pairs.push_back(f), pairs.push_back(skin.second_begin + k);
    }
    return pairs;
}

// Quadrature points of the segments of pairs: of which pair, and per point the weight and both facets'
// shapes.
nb::tuple segment_points(const Skin& skin, const Doubles& X, const Ints& pairs, const Doubles& rule) {
    std::vector<RulePoint> points(rule.shape(0));
    for (std::size_t k = 0; k < points.size(); ++k)
        points[k] = {rule.data()[3 * k], rule.data()[3 * k + 1], rule.data()[3 * k + 2]};
    std::vector<SegmentPoint> all;
    std::vector<double> pair, values;
    for (std::size_t k = 0; k < pairs.shape(0); ++k) {
        const int facet[2] = {pairs.data()[2 * k], pairs.data()[2 * k + 1]};
        FacetPair p{{}, skin.n_corners(facet[0]), skin.n_corners(facet[1])};
        for (int side = 0; side < 2; ++side)
            for (int a = 0; a < skin.n_corners(facet[side]); ++a)
                std::copy_n(X.data() + 3 * skin.corners(facet[side])[a], 3, p.x[side * facet_corners + a]);
        add_points(p, points, all);
        pair.resize(all.size(), static_cast<double>(k));
    }
    for (const SegmentPoint& p : all) {
        values.push_back(p.weight);
        values.insert(values.end(), p.first, p.first + facet_corners);
        values.insert(values.end(), p.second, p.second + facet_corners);
    }
    return nb::make_tuple(handed_over(pair), handed_over(values));
}

// Gaps at positions of all vertices, weighted by area, the areas, and the gradients: of which gap, by which
// vertex, three numbers each.
nb::tuple linearised(Gaps& gaps, const Doubles& X) {
    std::vector<double> gap(gaps.n()), area(gaps.n()), row, vertex, gradient;
    gaps.search(X.data(), X.data());
    gaps.values(X.data(), gap.data(), area.data());
    std::vector<char> seen(gaps.n());
    for (int A = 0; A < gaps.n(); ++A) seen[A] = area[A] > 0;
    std::vector<Gap> found(gaps.n());
    gaps.gradients(X.data(), seen, found);
    for (int A = 0; A < gaps.n(); ++A) {
        if (!seen[A]) continue;
        for (int v : gaps.stencil(A)) row.push_back(A), vertex.push_back(v);
        gradient.insert(gradient.end(), found[A].gradient.begin(), found[A].gradient.end());
    }
    return nb::make_tuple(handed_over(gap), handed_over(area), handed_over(row), handed_over(vertex),
                          handed_over(gradient));
}

void bind_tying(nb::module_& m) {
    m.def("near_facets", [](const Skin& skin, const Doubles& X, double margin) {
        const std::vector<int> pairs = near_facets(skin, X.data(), margin);
        return handed_over({pairs.begin(), pairs.end()});
    });
    m.def("segment_points", segment_points);
    nb::class_<TieTerm, Term>(m, "TieTerm")
        .def("__init__", [](TieTerm* t, int dim, const Ints& first, const Ints& unknown,
                            const Ints& multiplier, const Doubles& weight) {
            new (t) TieTerm({dim, vector_of<int>(first), vector_of<int>(unknown), vector_of<int>(multiplier),
                             vector_of<double>(weight)});
        });
}

void bind_skin(nb::module_& m) {
    nb::class_<Skin>(m, "Skin").def(
        "__init__",
        [](Skin* s, int dim, const Ints& first, const Ints& unknown, const Doubles& weight,
           const Ints& mesh_node, const Doubles& constant, const Ints& facets, const Doubles& behind,
           const Doubles& ahead, int n_first, int second_begin) {
            new (s) Skin(skin_of(dim, first, unknown, weight, mesh_node, constant, facets, behind, ahead,
                                 n_first, second_begin));
        },
        nb::arg("dim"), nb::arg("first"), nb::arg("unknown"), nb::arg("weight"), nb::arg("mesh_node"),
        nb::arg("constant"), nb::arg("facets"), nb::arg("behind"), nb::arg("ahead"), nb::arg("n_first"),
        nb::arg("second_begin"));
    nb::class_<Cover>(m, "Cover").def(nb::init<Skin>(), nb::arg("whole"));
    m.def("sights", [](int dim, const Doubles& places, const Ints& facets) {
        std::vector<double> all;
        for (const Sight& s : find_sights(dim, vector_of<double>(places), vector_of<int>(facets)))
            all.push_back(s.behind), all.push_back(s.ahead);
        return handed_over(all);
    });
    m.def(
        "unseen",
        [](int dim, const Doubles& own, const Ints& own_facets, const Doubles& own_behind,
           const Doubles& other, const Ints& other_facets, const Doubles& other_behind, const Ints& touched,
           double reach) {
            auto side = [](const Doubles& X, const Ints& facets, const Doubles& behind) {
                return Side{vector_of<double>(X), vector_of<int>(facets), vector_of<double>(behind)};
            };
            return handed_over(find_unseen(dim, side(own, own_facets, own_behind),
                                           side(other, other_facets, other_behind), vector_of<int>(touched),
                                           reach));
        },
        nb::arg("dim"), nb::arg("own"), nb::arg("own_facets"), nb::arg("own_behind"), nb::arg("other"),
        nb::arg("other_facets"), nb::arg("other_behind"), nb::arg("touched"), nb::arg("reach"));
}

// The deepest place in two bodies of closed surfaces.
nb::tuple overlap(const Skin& skin, const Doubles& q, double least) {
    std::vector<double> places;
    skin.positions(q.data(), places);
    const Enclosure one(places, Triangulated(skin, 0, skin.second_begin).triangles),
        two(places, Triangulated(skin, skin.second_begin, skin.n_facets()).triangles);
    const DeepPlace found = find_overlap(one, two, least);
    return nb::make_tuple(found.depth, handed_over({found.place.begin(), found.place.end()}));
}

void bind_gaps(nb::module_& m) {
    nb::class_<Gaps>(m, "Gaps").def("linearised", linearised);
    m.def("overlap", overlap, nb::arg("skin"), nb::arg("q"), nb::arg("least"));
    m.def(
        "mortar",
        [](const Skin& skin, double reach, bool axisymmetric, bool dual) {
            return shared(make_mortar(skin, {reach, axisymmetric, dual}));
        },
        nb::arg("skin"), nb::arg("reach"), nb::arg("axisymmetric"), nb::arg("dual"));
    m.def(
        "node_to_segment",
        [](const Skin& skin, const Doubles& areas, const Doubles& behind, double radius, double reach,
           bool rubs, const Ints& turning, double axis, int copies, const Ints& facets) {
            return shared(make_node_to_segment(
                skin, {vector_of<double>(areas), vector_of<double>(behind), radius, reach, rubs,
                       vector_of<int>(turning), axis, copies, vector_of<int>(facets)}));
        },
        nb::arg("skin"), nb::arg("areas"), nb::arg("behind"), nb::arg("radius"), nb::arg("reach"),
        nb::arg("rubs"), nb::arg("turning"), nb::arg("axis"), nb::arg("copies"), nb::arg("facets"));
    m.def(
        "line_gaps",
        [](const Skin& skin, const Doubles& areas, double radius, double reach, const Ints& start,
           const Ints& own, const Ints& stretches, const Ints& turning, const Ints& opposite, double inner) {
            return shared(make_line_gaps(
                skin, {vector_of<double>(areas), {}, radius, reach, false, vector_of<int>(turning), 0},
                {vector_of<int>(start), vector_of<int>(own)},
                {vector_of<int>(opposite), inner, vector_of<int>(stretches)}));
        },
        nb::arg("skin"), nb::arg("areas"), nb::arg("radius"), nb::arg("reach"), nb::arg("start"),
        nb::arg("own"), nb::arg("stretches"), nb::arg("turning"), nb::arg("opposite"), nb::arg("inner"));
    nb::class_<SharpParts>(m, "SharpParts")
        .def(
            "__init__",
            [](SharpParts* p, const Ints& edges, int n_first, const Ints& face_corners, const Ints& borders,
               const Ints& border_start, const Ints& corners, const Ints& next, const Ints& next_start) {
                new (p) SharpParts{vector_of<int>(edges),        n_first,
                                   vector_of<int>(face_corners), vector_of<int>(borders),
                                   vector_of<int>(border_start), vector_of<int>(corners),
                                   vector_of<int>(next),         vector_of<int>(next_start)};
            },
            nb::arg("edges"), nb::arg("n_first"), nb::arg("face_corners"), nb::arg("borders"),
            nb::arg("border_start"), nb::arg("corners"), nb::arg("next"), nb::arg("next_start"));
    m.def(
        "sharp_gaps",
        [](const Skin& skin, const SharpParts& parts, int n_vertices, int n_gaps, double depth,
           double reach) { return shared(make_sharp_gaps(skin, {parts, n_vertices, n_gaps, depth, reach})); },
        nb::arg("skin"), nb::arg("parts"), nb::arg("n_vertices"), nb::arg("n_gaps"), nb::arg("depth"),
        nb::arg("reach"));
    m.def(
        "self_contact",
        [](const Skin& skin, const Doubles& areas, const Doubles& behind, double reach, bool rubs,
           const Doubles& places, const Doubles& starts, const Doubles& ends) {
            return shared(make_self_contact(
                skin, {vector_of<double>(areas), vector_of<double>(behind), 0, reach, rubs, {}, 0},
                {vector_of<double>(places), vector_of<double>(starts), vector_of<double>(ends)}));
        },
        nb::arg("skin"), nb::arg("areas"), nb::arg("behind"), nb::arg("reach"), nb::arg("rubs"),
        nb::arg("places"), nb::arg("starts"), nb::arg("ends"));
    m.def(
        "obstacle",
        [](const Skin& skin, const Doubles& areas, double radius, const Ints& turning, int core,
           const Doubles& half, double round, double axis, const Ints& facets) {
            ObstacleShape shape{static_cast<ObstacleShape::Core>(core), {}, round, axis};
            std::copy_n(half.data(), 3, shape.half);
            PointOptions options{vector_of<double>(areas), {}, radius, 0, false, vector_of<int>(turning)};
            options.facets = vector_of<int>(facets);
            return shared(make_obstacle(skin, std::move(options), shape));
        },
        nb::arg("skin"), nb::arg("areas"), nb::arg("radius"), nb::arg("turning"), nb::arg("core"),
        nb::arg("half"), nb::arg("round"), nb::arg("axis"), nb::arg("facets"));
}

void bind_construction(nb::class_<ContactTerm, Term>& term) {
    term.def(
        "__init__",
        [](ContactTerm* t, std::shared_ptr<Gaps> gaps, double reach, const Ints& multiplier,
           const Doubles& stiffness, const Doubles& area, bool conserving, bool rigid, double restitution,
           double size, bool presses_out, double friction, const Ints& tangential,
           const Doubles& tangential_stiffness, const Doubles& inertia, const Doubles& most_inertia,
           const Doubles& damping) {
            FrictionOptions rubbing{friction, vector_of<int>(tangential),
                                    vector_of<double>(tangential_stiffness), vector_of<double>(inertia),
                                    vector_of<double>(most_inertia)};
            new (t) ContactTerm(std::move(gaps),
                                {vector_of<int>(multiplier), vector_of<double>(stiffness),
                                 vector_of<double>(area), conserving, rigid, restitution, size, presses_out,
                                 vector_of<double>(damping), std::move(rubbing)},
                                reach);
        },
        nb::arg("gaps"), nb::arg("reach"), nb::arg("multiplier"), nb::arg("stiffness"), nb::arg("area"),
        nb::arg("conserving"), nb::arg("rigid"), nb::arg("restitution"), nb::arg("size"),
        nb::arg("presses_out"), nb::arg("friction"), nb::arg("tangential"), nb::arg("tangential_stiffness"),
        nb::arg("inertia"), nb::arg("most_inertia"), nb::arg("damping"));
}

// Findings of the last step.
void bind_findings(nb::class_<ContactTerm, Term>& term) {
    term.def("book_contact",
             [](ContactTerm& t, int work, int energy) { t.work_account = work, t.energy_account = energy; })
        .def("book_friction", [](ContactTerm& t, int work,
                                 int energy) { t.friction_account = work, t.slip_energy_account = energy; })
        .def(
            "watch",
            [](ContactTerm& t, const Skin& skin, std::pair<bool, bool> encloses, const Ints& faces, bool thin,
               double limit, double least, const std::string& cure) {
                Piercing::Sides sides{skin, {encloses.first, encloses.second}, {}, thin};
                sides.faces.assign(faces.data(), faces.data() + faces.size());
                t.watch({std::move(sides), limit, least, cure});
            },
            nb::arg("skin"), nb::arg("encloses"), nb::arg("faces"), nb::arg("thin"), nb::arg("limit"),
            nb::arg("least"), nb::arg("cure"))
        .def(
            "stand_beside",
            [](ContactTerm& t, std::shared_ptr<ContactTerm> other) { t.stand_beside(std::move(other)); },
            nb::arg("other"))
        .def("lie_beside", &ContactTerm::lie_beside, nb::arg("other"))
        .def("cover", &ContactTerm::cover, nb::arg("side"), nb::arg("own"), nb::arg("other"))
        .def_prop_ro("costs",
                     [](const ContactTerm& t) {
                         return std::vector<double>{t.costs().search, t.costs().segments, t.costs().forces};
                     })
        .def_prop_ro(
            "tractions", [](const ContactTerm& t) { return handed_over(t.tractions()); },
            nb::rv_policy::automatic)
        .def_prop_ro(
            "slips",
            [](const ContactTerm& t) { return std::vector<int>(t.slips().begin(), t.slips().end()); })
        .def_prop_ro("unsettled", &ContactTerm::unsettled)
        .def_prop_ro("roaming", &ContactTerm::roaming)
        .def_prop_ro(
            "pressures", [](const ContactTerm& t) { return handed_over(t.pressures()); },
            nb::rv_policy::automatic)
        .def_prop_ro(
            "forces", [](const ContactTerm& t) { return handed_over(t.forces()); }, nb::rv_policy::automatic)
        .def_prop_ro(
            "friction_forces", [](const ContactTerm& t) { return handed_over(t.friction_forces()); },
            nb::rv_policy::automatic)
        .def_prop_ro(
            "gaps", [](const ContactTerm& t) { return handed_over(t.gap_values()); },
            nb::rv_policy::automatic)
        .def_prop_ro(
            "areas", [](const ContactTerm& t) { return handed_over(t.areas()); }, nb::rv_policy::automatic);
}

// The function writes conductances of pressures, both arrays; Python keeps it.
Conductance conductance_of(const Term* term, const nb::object& function) {
    return [f = Callback(term, function)](const std::vector<double>& p, std::vector<double>& h,
                                          std::vector<double>& slopes) {
        nb::gil_scoped_acquire gil;
        f(handed_over(p), view(h.data(), h.size(), nb::none()),
          view(slopes.data(), slopes.size(), nb::none()));
    };
}

void bind_heat(nb::module_& m) {
    nb::class_<ContactHeat, Term>(m, "ContactHeat")
        .def(
            "__init__",
            [](ContactHeat* t, std::shared_ptr<ContactTerm> contact, const Ints& balance,
               const Ints& temperature, const Ints& carries, const Ints& entropy, double share) {
                ContactWarmth w{vector_of<int>(balance), vector_of<int>(temperature)};
                for (int side = 0; side < 2; ++side)
                    w.carries[side] = carries.data()[side] != 0, w.entropy[side] = entropy.data()[side] != 0;
                w.share = share;
                new (t) ContactHeat(std::move(contact), std::move(w));
            },
            nb::arg("contact"), nb::arg("balance"), nb::arg("temperature"), nb::arg("carries"),
            nb::arg("entropy"), nb::arg("share"))
        .def("set_conductance",
             [](ContactHeat& t, nb::object f) { t.set_conductance(conductance_of(&t, f)); })
        .def("book_heat", [](ContactHeat& t, int work) { t.work_account = work; })
        .def_prop_ro(
            "conducted", [](const ContactHeat& t) { return handed_over(t.conducted()); },
            nb::rv_policy::automatic);
}

}  // namespace

void bind_contact(nb::module_& m) {
    bind_skin(m);
    bind_gaps(m);
    bind_tying(m);
    nb::class_<ContactTerm, Term> term(m, "ContactTerm");
    bind_construction(term);
    bind_findings(term);
    bind_heat(m);
}
