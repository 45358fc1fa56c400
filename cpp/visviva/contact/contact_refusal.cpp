// Why a step that has converged may be no solution of contact: what has passed unseen.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "visviva/contact/contact_term.hpp"

namespace visviva {

namespace {

constexpr double most_parts = 100;  // of a step, at which surfaces are looked at on their way

}  // namespace

Refusal ContactTerm::refuse(const Context& c) {
    const Stopwatch watch(costs_.search);
    if (gaps_->unheld() > 0)
        return refused(0, "edges and corners meet at " + std::to_string(gaps_->n() + gaps_->unheld()) +
                              " places at once, of which " + std::to_string(gaps_->n()) +
                              " can be held: cut the bodies into some that are joined by Rigid, each with a "
                              "contact of its own, or take enforcement='penalty', which holds more,");
    gaps_->skin().positions(c.vectors.x0, X0_), gaps_->skin().positions(c.vectors.x1, X1_);
    if (const int v = search_.lost(X1_); v >= 0)
        return refused(v, "the surfaces moved farther in the step than their search had reached,");
    std::vector<Approach> approach;
    gaps_->approaches(X0_.data(), X1_.data(), approach);
    auto ways = [](const Approach& a) { return a.way > 0 ? a.way / a.sight : 0; };
    const auto fastest = std::max_element(approach.begin(), approach.end(),
                                          [&](auto& a, auto& b) { return ways(a) < ways(b); });
    const double parts = fastest == approach.end() ? 0 : std::ceil(2 * ways(*fastest));
    if (parts > most_parts)
        return refused(vertex_of(static_cast<int>(fastest - approach.begin())),
                       "the surfaces come nearer by more than can be followed in a step,");
    if (const int A = passes(approach, static_cast<int>(parts)); A >= 0)
        return refused(vertex_of(A), "the surfaces pass through each other within the step,");
    const Piercing::Finding unseen = look(c);
    if (unseen.outruns)
        return refused(0, "the bodies pass by more of their width than can be followed in a step,");
    if (unseen.sinks) {
        char deep[96];
        std::snprintf(deep, sizeof deep, "the bodies sink into each other by %.3g, unseen by gaps;",
                      unseen.worst.depth);
        return refused(unseen.worst.place.data(), 0, deep + (" " + piercing_->cure()) + ";");
    }
    if (gives_energy(c)) return refused(0, "an impact that sticks at several vertices would give energy,");
    if (const int A = rubs_too_late(c); A >= 0)
        return refused(vertex_of(A),
                       "an impact rubs, for which the elastic slip of tangential='penalty' has no time; take "
                       "tangential='multipliers', or enforcement='penalty', with which impacts last,");
    if (const int A = lands_beside(); A >= 0)
        return refused(vertex_of(A),
                       "a body lands and comes upon the edge of another floor that is flush there,");
    if (c.step.is_static()) return {};  // load steps are no ways: equilibria at both ends count
    if (const int A = climbs(c); A >= 0)
        return refused(
            vertex_of(A),
            "a vertex slides into a wall, and the force of the middle of the step, across the floor "
            "before it, would lift it and give energy; take EnergyMomentum or BackwardEuler,");
    if (const int A = gaps_->strays(X0_.data(), X1_.data(), gap0_.data(), gap1_.data()); A >= 0)
        return refused(vertex_of(A),
                       "the first surface comes in by one side and out by another, past an edge,");
    return {};
}

// A gap that closes in a step in which its body sinks into what carries it, so that it would not if that
// were known where the step begins; -1: none. Shorter steps begin with it.
int ContactTerm::lands_beside() {
    constexpr double same = 1e-3;
    if (!lies_beside()) return -1;
    Sags start, all;
    for (const auto& other : fellows_) {
        start.add(other->start), all.add(other->start);
        all.add(other->end), all.add(other->landing);
    }
    std::vector<double> gap(gaps_->n()), area(gaps_->n());
    if (!gaps_->lie(std::move(all))) return -1;
    gaps_->values(X1_.data(), gap.data(), area.data());
    gaps_->lie(std::move(start));
    for (int A = 0; A < gaps_->n(); ++A)
        if (depth(A, gap0_, area0_) == 0 && std::abs(gap[A] - gap1_[A]) > -same * gap1_[A] && gap1_[A] < 0)
            return A;
    return -1;
}

// A gap held at the end of a step on one facet by the force that another one has in its middle; -1: none.
// Shorter steps may have that on the facet on which it ends, which gives no energy.
int ContactTerm::climbs(const Context& c) const {
    if (!has_multipliers() || is_discrete(c.step) || c.step.theta == 1) return -1;
    for (int A = 0; A < gaps_->n(); ++A)
        if (active_[A] && gaps_->turns_uphill(Xt_.data(), X1_.data(), A)) return A;
    return -1;
}

// A gap that closes in an impact with an elastic traction below Coulomb's limit, though what slides there and
// what the limit allows are felt; -1: none. The impulse of such a traction vanishes with the step.
int ContactTerm::rubs_too_late(const Context& c) const {
    constexpr double felt = 1e-3;
    if (!has_friction() || has_tangential() || !rebounds() || !holds(c) || !c.step.has_length()) return -1;
    for (int A = 0; A < gaps_->n(); ++A) {
        if (!active_[A] || traction_[A].slips || !closes(A, c)) continue;
        const double closing = -rate0_[A], slides = sliding(A, stencil_of(A, V0_)).displacement().norm();
        const double braked = std::min(options_.friction.coefficient * closing, slides);
        if (braked > felt * std::max(closing, slides)) return A;
    }
    return -1;
}

Piercing::Finding ContactTerm::look(const Context& c) {
    if (!piercing_) return {};
    const double seen = std::max(deepest(), beside_ ? beside_->deepest() : 0.0);
    return piercing_->look(c.vectors.x0, c.vectors.x1, seen);
}

// How deep gaps see bodies in each other; behind a border, beside what carries them, they are in nothing.
double ContactTerm::deepest() const {
    double seen = 0;
    std::vector<double> gap(gaps_->n()), area(gaps_->n());
    gaps_->values(X1_.data(), gap.data(), area.data());
    for (int A = 0; A < gaps_->n(); ++A)
        if (!gaps_->is_beyond_border(A)) seen = std::max(seen, depth(A, gap1_, area1_));
    return seen;
}

int ContactTerm::vertex_of(int gap) const {
    const std::vector<int>& own = gaps_->stencil(gap);
    return own.empty() ? gap % std::max(gaps_->n_first(), 1) : own[0];
}

Refusal ContactTerm::refused(int vertex, const std::string& why) const {
    return refused(&X1_[3 * vertex], vertex, why);
}

Refusal ContactTerm::refused(const double* x, int vertex, const std::string& why) const {
    const Skin& skin = gaps_->skin();
    char near[96];
    std::snprintf(near, sizeof near, " near (%.4g, %.4g, %.4g)", x[0], x[1], x[2]);
    const int form = skin.first[vertex];
    return {form < skin.first[vertex + 1] ? skin.unknown[form] : -1, name + ": " + why + near};
}

double ContactTerm::depth(int A, const std::vector<double>& gap, const std::vector<double>& area) const {
    return is_covered(A, area) ? std::max(-gap[A] / area[A], 0.0) : 0;
}

// A gap at which the surfaces are deep in each other on the way, and neither where it began nor where it
// ends, or so deep at its end that they soon do not see each other any more; -1: none. What comes nearer by
// less than half of what is seen does not pass unseen.
int ContactTerm::passes(const std::vector<Approach>& approach, int n_parts) {
    // Parts of what is seen; in the middle of a body its far side is as close.
    constexpr double shallow = 0.2, deep = 0.5 - 1e-6, back = 0.1;
    auto gained = [&](int A, const std::vector<double>& gap, const std::vector<double>& area) {
        return (depth(A, gap, area) - depth(A, gap0_, area0_)) / approach[A].sight;
    };
    for (int A = 0; A < gaps_->n(); ++A)
        if (gained(A, gap1_, area1_) > 0 && depth(A, gap1_, area1_) > deep * approach[A].sight) return A;
    std::vector<double> X(X0_.size()), gap(gaps_->n()), area(gaps_->n());
    for (int part = 1; part < n_parts; ++part) {
        const double s = static_cast<double>(part) / n_parts;
        for (std::size_t i = 0; i < X.size(); ++i) X[i] = (1 - s) * X0_[i] + s * X1_[i];
        gaps_->values(X.data(), gap.data(), area.data());
        for (int A = 0; A < gaps_->n(); ++A) {
            const double on_the_way = gained(A, gap, area);
            if (on_the_way > shallow && gained(A, gap1_, area1_) < on_the_way - back) return A;
        }
    }
    return -1;
}

}  // namespace visviva
