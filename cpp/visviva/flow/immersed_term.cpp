#include "visviva/flow/immersed_term.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "visviva/base/stopwatch.hpp"

namespace visviva {

ImmersedTerm::ImmersedTerm(ImmersedPoints points, Interpolation interpolate, Admission admit, Coupling couple,
                           Reach reach)
    : TermMemory("immersed", 1),
      points_(std::move(points)),
      interpolate_(std::move(interpolate)),
      admit_(std::move(admit)),
      couple_(std::move(couple)),
      reach_(std::move(reach)) {
    const std::size_t n = static_cast<std::size_t>(points_.n());
    now_.unknown.assign(n * points_.width, -1), now_.weight.assign(n * points_.width, 0.0);
    now_.start.assign(n * points_.dim, std::numeric_limits<double>::quiet_NaN()), now_.places = now_.start;
    at_tangent_ = now_;
}

template <class F>
void ImmersedTerm::each(F f) const {
    for (int k = 0; k < points_.n(); ++k)
        for (int i = 0; i < points_.dim; ++i) f(k, i, points_.multiplier[k] + i, k * points_.width);
}

double ImmersedTerm::velocity(const double* v, int first, int i) const {
    double sum = 0;
    for (int e = first; e < first + points_.width; ++e) sum += now_.weight[e] * v[now_.unknown[e] + i];
    return sum;
}

double ImmersedTerm::carrying(const Context& c, int first, int i) const {
    const double v0 = velocity(c.vectors.x0, first, i), v1 = velocity(c.vectors.x1, first, i);
    return v0 + share(c.step) * (v1 - v0);
}

// Motion of a point by the scheme: its rate times the step (statics knows no rates).
double ImmersedTerm::moved(const Context& c, int k, int i) const {
    if (!c.step.is_static()) return c.step.h * points_.value(c.vectors.rate, k, i);
    return points_.value(c.vectors.x1, k, i) - points_.value(c.vectors.x0, k, i);
}

// Points that the fluid has let go of follow nothing: their force vanishes.
bool ImmersedTerm::is_free(const std::vector<double>& weight, int first) const {
    if (!points_.leaves) return false;
    const auto begin = weight.begin() + first;
    return std::all_of(begin, begin + points_.width, [](double w) { return w == 0; });
}

std::vector<char> ImmersedTerm::within() const {
    std::vector<char> found;
    if (std::isnan(now_.places[0])) return found;
    for (int k = 0; k < points_.n(); ++k) found.push_back(!is_free(k * points_.width));
    return found;
}

bool ImmersedTerm::is_outdated() const {
    for (int k = 0; points_.leaves && k < points_.n(); ++k)
        if (is_free(k * points_.width) != is_free(at_tangent_.weight, k * points_.width)) return true;
    return false;
}

// Interpolation where the scheme evaluates forces (in the middle of the step, or at its end), as far as its
// start tells, keeps the second order, and makes the motion linear in the velocities. It stays through all
// iterations. The rates are those of the points: those of the fluid at long steps lead away from where a body
// is held.
bool ImmersedTerm::find_neighbours(const Way& way) {
    const Stopwatch watch(location_);
    bool same = is_coupled();
    each([&](int k, int i, int, int) {
        const double from = points_.value(way.x0, k, i);
        const double goes = points_.held[k * points_.dim + i] ? points_.value(way.x1, k, i) - from
                                                              : way.h * points_.value(way.rate, k, i);
        double &start = now_.start[k * points_.dim + i], &place = now_.places[k * points_.dim + i];
        const double to = from + way.theta * goes;
        same = same && start == from && place == to;
        start = from, place = to;
    });
    if (same) return false;
    interpolate_(now_.start.data(), now_.places.data(), now_.unknown.data(), now_.weight.data());
    if (reach_) reach_(now_.places.data());
    if (is_coupled()) return false;
    find_coupled(way);
    return true;
}

Refusal ImmersedTerm::refused(const Lost& lost) const {
    if (lost.point < 0) return {};
    return {points_.vector[static_cast<std::size_t>(lost.point) * points_.terms], name + ": " + lost.why};
}

Refusal ImmersedTerm::refuse(const Context& c) {
    const Stopwatch watch(location_);
    std::vector<double> ends(now_.start.size()), starts(now_.start.size());
    each([&](int k, int i, int, int) {
        starts[k * points_.dim + i] = points_.value(c.vectors.x0, k, i);
        ends[k * points_.dim + i] = points_.value(c.vectors.x1, k, i);
    });
    return refused(admit_(starts.data(), ends.data()));
}

// The pattern, and the weights of the kept tangent; those of the next step follow from its start.
void ImmersedTerm::write_memory(std::vector<double>& m) const {
    m.push_back(static_cast<double>(coupled_.size()));
    for (const auto& all : coupled_) {
        m.push_back(static_cast<double>(all.size()));
        m.insert(m.end(), all.begin(), all.end());
    }
    m.insert(m.end(), at_tangent_.unknown.begin(), at_tangent_.unknown.end());
    m.insert(m.end(), at_tangent_.weight.begin(), at_tangent_.weight.end());
    m.insert(m.end(), at_tangent_.places.begin(), at_tangent_.places.end());
}

bool ImmersedTerm::read_memory(const double*& m) {
    coupled_.resize(static_cast<std::size_t>(*m++));
    for (auto& all : coupled_) {
        all.resize(static_cast<std::size_t>(*m++));
        for (int& u : all) u = static_cast<int>(*m++);
    }
    for (int& u : at_tangent_.unknown) u = static_cast<int>(*m++);
    for (double& w : at_tangent_.weight) w = *m++;
    for (double& p : at_tangent_.places) p = *m++;
    follow(at_tangent_);
    std::fill(now_.start.begin(), now_.start.end(), std::numeric_limits<double>::quiet_NaN());
    return true;
}

void ImmersedTerm::restore_evaluation(const std::any& kept) { follow(std::any_cast<const Weights&>(kept)); }

// Elements around are told where that is elsewhere than before.
void ImmersedTerm::follow(const Weights& weights) {
    const bool elsewhere = now_.places != weights.places;
    now_ = weights;
    if (reach_ && elsewhere) reach_(now_.places.data());
}

// Whether the pattern holds what is followed now.
bool ImmersedTerm::is_coupled() const {
    bool known = !coupled_.empty();
    for (std::size_t e = 0; known && e < now_.unknown.size(); ++e)
        known = is_coupled(static_cast<int>(e) / points_.width, now_.unknown[e]);
    return known;
}

bool ImmersedTerm::is_coupled(int point, int unknown) const {
    return std::binary_search(coupled_[point].begin(), coupled_[point].end(), unknown);
}

// The pattern lasts for some steps if it holds what comes next.
void ImmersedTerm::find_coupled(const Way& way) {
    std::vector<double> moves(now_.start.size());
    each([&](int k, int i, int, int) {
        moves[k * points_.dim + i] = points_.value(way.x1, k, i) - points_.value(way.x0, k, i);
    });
    coupled_ = couple_(now_.places.data(), moves.data());
    for (std::size_t e = 0; e < now_.unknown.size(); ++e)
        coupled_[e / points_.width].push_back(now_.unknown[e]);
    for (auto& all : coupled_) {
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
    }
}

// f(row, column) of every entry, two by two those of a constraint and its transpose.
template <class F>
void ImmersedTerm::each_coupled(F f) const {
    if (coupled_.empty()) return;
    each([&](int k, int i, int m, int) {
        for (int t = k * points_.terms; t < (k + 1) * points_.terms; ++t)
            f(m, points_.vector[t] + i), f(points_.vector[t] + i, m);
        for (int v : coupled_[k]) f(m, v + i), f(v + i, m);
        if (points_.leaves) f(m, m);
    });
}

void ImmersedTerm::list_entries(std::vector<std::pair<int, int>>& entries) const {
    each_coupled([&](int row, int col) { entries.emplace_back(row, col); });
}

void ImmersedTerm::set_positions(const std::vector<std::int64_t>& positions) { position_ = positions; }

void ImmersedTerm::residual(const Context& c, double* r) {
    const auto& x1 = c.vectors.x1;
    each([&](int k, int i, int m, int first) {
        r[m] += is_free(first) ? x1[m] : moved(c, k, i) - c.step.h * carrying(c, first, i);
        for (int t = k * points_.terms; t < (k + 1) * points_.terms; ++t)
            r[points_.vector[t] + i] += points_.weight[t] * x1[m];
        for (int e = first; e < first + points_.width; ++e) r[now_.unknown[e] + i] -= now_.weight[e] * x1[m];
    });
}

void ImmersedTerm::tangent(const Context& c, double* values) {
    at_tangent_ = now_;
    std::size_t at = 0;
    const double h = c.step.h * share(c.step), own = c.step.is_static() ? 1 : c.step.h * c.step.motion[0][0];
    each([&](int k, int, int, int first) {
        const std::vector<int>& all = coupled_[k];
        const bool free = is_free(first);
        for (int t = k * points_.terms; t < (k + 1) * points_.terms; ++t)
            for (const double factor : {free ? 0.0 : own, 1.0})
                values[position_[at++]] += factor * points_.weight[t];
        for (int e = first; e < first + points_.width; ++e) {
            const auto place = std::lower_bound(all.begin(), all.end(), now_.unknown[e]) - all.begin();
            const std::size_t to = at + 2 * static_cast<std::size_t>(place);
            values[position_[to]] -= h * now_.weight[e];
            values[position_[to + 1]] -= now_.weight[e];
        }
        at += 2 * all.size();
        if (points_.leaves) values[position_[at++]] += free ? 1.0 : 0.0;
    });
}

// Work of the fluid on the solid and of the solid on the fluid, and the loss where nodes go ahead; the
// defect is how far nodes have moved otherwise.
// What moves with the fluid over steps has no rate to keep at an instant.
void ImmersedTerm::ledger(const Context& c, const double*, LedgerSums& sums) {
    double* defect = &sums.defect[2 * static_cast<std::size_t>(component[0])];
    const auto &x0 = c.vectors.x0, &x1 = c.vectors.x1;
    each([&](int k, int i, int m, int first) {
        if (is_free(first)) return;
        const double apart = moved(c, k, i) - c.step.h * carrying(c, first, i);
        const double ahead = c.step.h * points_.damping * (velocity(x1, first, i) - velocity(x0, first, i));
        sums.work[account[0]] -= x1[m] * apart;
        sums.work[account[1]] -= x1[m] * ahead;
        defect[0] = std::max(defect[0], std::abs(apart));
    });
}

}  // namespace visviva
