#include "visviva/contact/contact_term.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "visviva/base/parallel.hpp"
#include "visviva/base/stopwatch.hpp"
#include "visviva/contact/complement.hpp"
#include "visviva/term/pattern.hpp"

namespace visviva {

namespace {

using Map = Eigen::Map<const Eigen::VectorXd>;

constexpr double touching = 1e-9;  // part of a vertex's share of the surface
// Part of a vertex' area that the other surface must cover: with less, its gap also closes where the cover
// vanishes, and Newton's method goes there, while the multiplier grows without bound.
constexpr double least_cover = 1e-3;
// Parts of the reach by which surfaces may leave what the search has swept, until it is done again, and at
// all; and by which the end of a step may move until stencils are made again.
constexpr double again = 0.125, too_far = 0.35, moved = 0.03;
constexpr double most_parts = 100;  // of a step, at which surfaces are looked at on their way

Map vector_of(const std::vector<double>& a) { return {a.data(), static_cast<Eigen::Index>(a.size())}; }

// Forces along the relative motion that complete the work of the gradient to the change of the gap, and how
// much of them: (gap1 - gap0 - g . D) / p . D, see the theory of contact in the documentation.
struct Correction {
    Complement complement;
    double size, c = 0;
    Correction(const Eigen::VectorXd& x, const Eigen::VectorXd& D, const Eigen::VectorXd& masses, int dim)
        : complement(x, D, masses, dim), size(complement.size()) {
        if (size <= 1e-14 * complement.spread()) size = 0;  // what would be mended is less than rounding
    }
    void complete(double defect) { c = size > 0 ? defect / size : 0; }
};

}  // namespace

// What takes its time in the segments, and not in the forces around them.
template <class F>
void ContactTerm::segments(F f) {
    double spent = 0;
    {
        const Stopwatch watch(spent);
        f();
    }
    costs_.segments += spent, costs_.forces -= spent;
}

ContactTerm::ContactTerm(std::shared_ptr<Gaps> gaps, ContactOptions options, double reach)
    : gaps_(std::move(gaps)), options_(std::move(options)), reach_(reach) {
    const std::size_t n = gaps_->n();
    for (auto* a : {&gap0_, &area0_, &gap1_, &area1_, &gapt_, &rate0_, &S_, &dS_gap_, &R_}) a->assign(n, 0.0);
    for (auto* a : {&active_, &active_at_tangent_, &slips_, &slips_at_tangent_, &covered_}) a->assign(n, 0);
    if (has_multipliers()) gaps_->keep_sides();
    at_start_.resize(n), at_theta_.resize(n), at_end_.resize(n), masses_.resize(n);
    if (!has_friction()) return;
    const Eigen::Vector2d none = Eigen::Vector2d::Zero();
    grips_.resize(n), traction_.resize(n), base_.assign(n, none), free_.assign(n, none);
    carried_.assign(n, 0.0), redundant_.assign(n, none);
    elastic_.assign(2 * n, 0.0), stored_.assign(n, 0.0);
    for (Record* r : {&now_, &before_, &at_tangent_})
        r->X.assign(gaps_->skin().constant.size(), 0.0), r->traction = elastic_;
}

int ContactTerm::n_multipliers() const {
    return (has_multipliers() ? 1 : 0) + (has_tangential() ? gaps_->skin().dim - 1 : 0);
}

std::vector<int> ContactTerm::multipliers(int A) const {
    std::vector<int> m;
    if (has_multipliers()) m.push_back(options_.multiplier[A]);
    for (int i = 0; has_tangential() && i + 1 < gaps_->skin().dim; ++i)
        m.push_back(options_.friction.multiplier[A] + i);
    return m;
}

// --- which gaps there are
// -----------------------------------------------------------------------------------
// A vertex that has left what the search has swept by more than a margin; -1: none.
int ContactTerm::beyond(const double* X, double margin) const {
    if (from_.empty()) return 0;
    for (std::size_t i = 0; i < from_.size(); ++i)
        if (X[i] < std::min(from_[i], to_[i]) - margin || X[i] > std::max(from_[i], to_[i]) + margin)
            return static_cast<int>(i / 3);
    return -1;
}

// Looks a few steps ahead, so that the tangent's pattern lasts.
bool ContactTerm::search(const Way& way) {
    constexpr double steps_ahead = 4;
    const Stopwatch watch(costs_.search);
    changes_ = -1;
    gaps_->skin().positions(way.x0, X0_), gaps_->skin().positions(way.x1, X1_);
    if (beyond(X0_.data(), again * reach_) < 0 && beyond(X1_.data(), again * reach_) < 0) {
        narrow();
        return false;
    }
    from_ = X0_, to_ = X1_, known_.clear();
    for (std::size_t i = 0; i < to_.size(); ++i) {
        const double step = to_[i] - from_[i], ahead = steps_ahead * std::clamp(step, -reach_, reach_);
        to_[i] = from_[i] + (std::abs(step) > std::abs(ahead) ? step : ahead);
    }
    const bool changed = gaps_->search(from_.data(), to_.data());
    forget_gradients();
    narrow();
    return changed;
}

// Stencils for the present step.
void ContactTerm::narrow() {
    if (gaps_->narrow(X0_.data(), X1_.data())) forget_gradients();
    narrowed_ = X1_;
}

Refusal ContactTerm::refuse(const Context& c) {
    const Stopwatch watch(costs_.search);
    gaps_->skin().positions(c.vectors.x0, X0_), gaps_->skin().positions(c.vectors.x1, X1_);
    if (const int v = beyond(X1_.data(), too_far * reach_); v >= 0)
        return refused(v, "the surfaces moved farther in the step than their search had reached,");
    std::vector<Approach> approach;
    gaps_->approaches(X0_.data(), X1_.data(), approach);
    auto ways = [](const Approach& a) { return a.way > 0 ? a.way / a.sight : 0; };
    const auto fastest = std::max_element(approach.begin(), approach.end(),
                                          [&](auto& a, auto& b) { return ways(a) < ways(b); });
    const double parts = fastest == approach.end() ? 0 : std::ceil(2 * ways(*fastest));
    if (parts > most_parts)
        return refused(static_cast<int>(fastest - approach.begin()),
                       "the surfaces come nearer by more than can be followed in a step,");
    if (const int A = passes(approach, static_cast<int>(parts)); A >= 0)
        return refused(A, "the surfaces pass through each other within the step,");
    if (c.step.motion[0][0] == 0) return {};  // load steps are no ways: equilibria at both ends count
    if (const int A = gaps_->strays(X0_.data(), X1_.data(), gap0_.data(), gap1_.data()); A >= 0)
        return refused(A, "the first surface comes in by one side and out by another, past an edge,");
    return {};
}

Refusal ContactTerm::refused(int vertex, const std::string& why) const {
    const Skin& skin = gaps_->skin();
    const double* x = &X1_[3 * vertex];
    char near[96];
    std::snprintf(near, sizeof near, " near (%.4g, %.4g, %.4g)", x[0], x[1], x[2]);
    const int form = skin.first[vertex];
    return {form < skin.first[vertex + 1] ? skin.unknown[form] : -1, name + ": " + why + near};
}

double ContactTerm::depth(int A, const std::vector<double>& gap, const std::vector<double>& area) const {
    return is_covered(A, area) ? std::max(-gap[A] / area[A], 0.0) : 0;
}

bool ContactTerm::is_covered(int A, const std::vector<double>& area) const {
    return area[A] > least_cover * options_.area[A];
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

void ContactTerm::write_memory(std::vector<double>& m) const {
    m.insert(m.end(), active_at_tangent_.begin(), active_at_tangent_.end());
    m.push_back(pushed_out_ ? 1 : 0), m.push_back(from_.empty() ? 0 : 1);
    m.insert(m.end(), from_.begin(), from_.end()), m.insert(m.end(), to_.begin(), to_.end());
    gaps_->write_memory(m);
    for (const Record* r : {&now_, &before_, &at_tangent_}) {
        if (!has_history()) break;
        m.insert(m.end(), r->X.begin(), r->X.end());
        m.insert(m.end(), r->traction.begin(), r->traction.end());
    }
}

// The kept tangent will be made again, which needs its active set.
bool ContactTerm::read_memory(const double*& m) {
    for (char& active : active_) active = *m++ != 0;
    pushed_out_ = *m++ != 0;
    const bool changed = read_search(m);
    gaps_->read_memory(m);
    for (Record* r : {&now_, &before_, &at_tangent_})
        for (std::vector<double>* part : {&r->X, &r->traction}) {
            if (!has_history()) break;
            std::copy_n(m, part->size(), part->begin());
            m += part->size();
        }
    return changed;
}

void ContactTerm::hold() {
    held_ = {S_, gap1_, area1_, forces_, friction_forces_, active_, slips_, grips_, traction_};
}

void ContactTerm::release() {
    S_ = held_.S, gap1_ = held_.gap1, area1_ = held_.area1;
    forces_ = held_.forces, friction_forces_ = held_.friction_forces;
    active_ = held_.active, slips_ = held_.slips, grips_ = held_.grips, traction_ = held_.traction;
    known_.clear();
}

bool ContactTerm::read_search(const double*& m) {
    const std::size_t n = gaps_->skin().constant.size();
    forget_gradients(), known_.clear();
    if (*m++ == 0) {
        from_.clear(), to_.clear();
        return false;
    }
    from_.assign(m, m + n), to_.assign(m + n, m + 2 * n);
    m += 2 * n;
    return gaps_->search(from_.data(), to_.data());
}

template <class F>
void ContactTerm::each_form(const std::vector<int>& vertices, F f) const {
    const Skin& skin = gaps_->skin();
    for (int v = 0; v < static_cast<int>(vertices.size()); ++v)
        for (int k = skin.first[vertices[v]]; k < skin.first[vertices[v] + 1]; ++k) f(v, k);
}

void ContactTerm::couple(Pattern& pattern) const {
    const Skin& skin = gaps_->skin();
    for (int A = 0; A < gaps_->n(); ++A) {
        const std::vector<int> own = multipliers(A);
        for (int a : own)
            for (int b : own) pattern.couple(a, b);
        each_form(gaps_->neighbours(A), [&](int, int k) {
            for (int i = 0; i < (skin.mesh_node[k] ? 1 : skin.dim); ++i)
                for (int a : own)
                    pattern.couple(skin.unknown[k] + i, a), pattern.couple(a, skin.unknown[k] + i);
        });
    }
    couple_vertices(pattern);
}

// Vertices that belong to the same gap, each pair once.
void ContactTerm::couple_vertices(Pattern& pattern) const {
    const Skin& skin = gaps_->skin();
    std::vector<std::vector<int>> gaps(skin.n_vertices());
    for (int A = 0; A < gaps_->n(); ++A)
        for (int v : gaps_->neighbours(A)) gaps[v].push_back(A);
    auto rows = [&](int k) { return skin.mesh_node[k] ? 1 : skin.dim; };
    std::vector<int> seen(skin.n_vertices(), -1), others;
    for (int v = 0; v < skin.n_vertices(); ++v) {
        others.clear();
        for (int A : gaps[v])
            for (int w : gaps_->neighbours(A))
                if (seen[w] != v) seen[w] = v, others.push_back(w);
        for (int k = skin.first[v]; k < skin.first[v + 1]; ++k)
            for (int i = 0; i < rows(k); ++i)
                each_form(others, [&](int, int l) {
                    for (int j = 0; j < rows(l); ++j)
                        pattern.couple(skin.unknown[k] + i, skin.unknown[l] + j);
                });
    }
}

void ContactTerm::connect(const Pattern& pattern) {
    pattern_ = pattern, border_places_.clear();
    places_.assign(gaps_->n(), {});
}

// --- pressures
// ----------------------------------------------------------------------------------------------
void ContactTerm::begin(const double* x0) {
    changes_ = -1, known_at_.clear();
    gaps_->skin().positions(x0, X0_);
    settle();
    if (X0_ == known_) {
        gap0_ = gap1_, area0_ = area1_;
    } else {
        const Stopwatch watch(costs_.segments);
        gaps_->values(X0_.data(), gap0_.data(), area0_.data());
    }
    if (has_history()) recall();
}

void ContactTerm::settle() {
    const Stopwatch watch(costs_.segments);
    if (gaps_->settle(X0_.data())) known_.clear(), forget_gradients();
}

void ContactTerm::find_gaps() {
    if (X1_ == known_) return;
    segments([&] { gaps_->values(X1_.data(), gap1_.data(), area1_.data()); });
    known_ = X1_;
}

// Line searches and books come back to where gradients are known.
void ContactTerm::find_gradients() {
    if (known_at_ == Xt_ && known_of_ == active_) return;
    segments([&] { gaps_->gradients(Xt_.data(), active_, at_theta_); });
    known_at_ = Xt_, known_of_ = active_;
}

void ContactTerm::evaluate(const Context& c, bool chooses, bool gradients) {
    const Skin& skin = gaps_->skin();
    skin.positions(c.vectors.x0, X0_), skin.positions(c.vectors.x1, X1_);
    bool stays = narrowed_.size() == X1_.size();
    for (std::size_t i = 0; stays && i < X1_.size(); ++i)
        stays = std::abs(X1_[i] - narrowed_[i]) < moved * reach_;
    if (!stays) narrow();
    find_gaps();
    const double t = theta(c.step);
    Xt_.resize(X0_.size()), D_.resize(X0_.size());
    for (std::size_t i = 0; i < X0_.size(); ++i)
        Xt_[i] = (1 - t) * X0_[i] + t * X1_[i], D_[i] = X1_[i] - X0_[i];
    const bool at_theta = !has_multipliers() && !is_discrete(c.step);
    std::vector<double> area(gap1_.size());
    if (at_theta) segments([&] { gaps_->values(Xt_.data(), gapt_.data(), area.data()); });
    if (rebounds() && holds(c)) find_rates(c);
    if (chooses && has_multipliers()) choose_active(c);
    for (int A = 0; A < gaps_->n(); ++A) press(A, c, gapt_[A]);
    if (is_discrete(c.step)) segments([&] { find_masses(gradients); });
    if (!has_friction()) return;
    impacts_ = has_tangential() && rebounds() && holds(c) && begins_with_impact(c);
    segments([&] { gaps_->grips(Xt_.data(), active_, gradients, grips_); });
    parallel_for(gaps_->n(), [&](int A) { rub(A, c); });
    if (is_inertial(c) && gaps_->skin().is_rigid()) find_redundant();
}

// Those of the start of the step; where surfaces hardly face each other then, with those of its end. Whatever
// else is in the stencils, forces follow from both ends of the step.
void ContactTerm::find_masses(bool gradients) {
    std::vector<char> before(gaps_->n()), fresh(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A) {
        before[A] = !gaps_->stencil(A).empty() && is_covered(A, area0_);
        fresh[A] = active_[A] && !before[A];
    }
    if (massed_ != X0_) {
        for (Grip& g : masses_) g.weight_gradient.resize(0, 0);
        gaps_->masses(X0_.data(), before, false, masses_), massed_ = X0_;
    }
    if (std::none_of(fresh.begin(), fresh.end(), [](char f) { return f; })) return;
    std::vector<Grip> start(gaps_->n());
    gaps_->masses(X0_.data(), fresh, false, start);
    gaps_->masses(X1_.data(), fresh, gradients, masses_);
    for (int A = 0; A < gaps_->n(); ++A)
        if (fresh[A]) masses_[A].weight += start[A].weight;
}

// At the start of the step; what is held must not open by rounding.
bool ContactTerm::closed(int A) const {
    const double rounding = rebounds() ? touching * reach_ * area0_[A] : 0;
    return area0_[A] > 0 && gap0_[A] <= rounding;
}

// How fast closed gaps close when the step begins.
void ContactTerm::find_rates(const Context& c) {
    gaps_->skin().increments(c.vectors.v0, V0_);
    if (rates_at_ == X0_ && rates_of_ == V0_) return;
    rates_at_ = X0_, rates_of_ = V0_;
    std::vector<char> wanted(gaps_->n());
    for (int A = 0; A < gaps_->n(); ++A) wanted[A] = closed(A);
    segments([&] { gaps_->gradients(X0_.data(), wanted, at_start_); });
    for (int A = 0; A < gaps_->n(); ++A)
        rate0_[A] = wanted[A] ? vector_of(at_start_[A].gradient).dot(stencil_of(A, V0_)) : 0.0;
}

// What a gap has to change by so that the scheme's rate at the end is the restitution times that of closing.
double ContactTerm::rebound(int A, const Context& c) const {
    const double* v1 = c.step.motion[2];
    return -(options_.restitution + v1[1]) / v1[0] * std::min(rate0_[A], 0.0);
}

// The gap below which there is pressure. In time what overlaps shall not close further, but opening it would
// give energy: so it is with conserving impact, and where a vertex was not covered enough to carry before.
double ContactTerm::least_gap(int A, const Context& c) const {
    if (c.step.motion[0][0] == 0) return 0;
    if (rebounds()) return (pushes_out() ? std::max(gap0_[A], 0.0) : gap0_[A]) + rebound(A, c);
    const double rounding = options_.conserving ? 0 : touching * area0_[A] * std::sqrt(area0_[A]);
    const bool holds = options_.conserving || (!options_.presses_out && gap0_[A] < -rounding);
    return holds ? std::min(gap0_[A], 0.0) : 0.0;
}

// Without inertia what just touches holds: bodies may rest on nothing else.
double ContactTerm::slack(int A, const Context& c) const {
    return c.step.motion[0][0] != 0 ? 0 : touching * area1_[A] * size(A);
}

bool ContactTerm::wants_pressure(int A, const Context& c) const {
    if (area1_[A] == 0 || !covered_[A] || (holds(c) && !closed(A))) return false;
    const double lambda = c.vectors.x1[options_.multiplier[A]];
    const double k = options_.stiffness[A], pressure = lambda - k * (gap1_[A] - least_gap(A, c));
    // rounding shall not change what was chosen in this step
    const double rounding = changes_ < 0 ? 0 : 1e-12 * k * area1_[A] * size(A);
    return pressure + k * slack(A, c) > (active_[A] ? -rounding : rounding);
}

// Once covered in the iterations of a step, a vertex may carry until its end. Conserving impact asks for its
// start alone.
void ContactTerm::cover(const Context& c) {
    const bool by_start = holds(c);
    for (int A = 0; A < gaps_->n(); ++A) {
        if (changes_ < 0) covered_[A] = is_covered(A, area0_);
        if (!by_start && is_covered(A, area1_)) covered_[A] = 1;
    }
}

// All at once at first; should that go round in circles, the first gap alone that wants to change does, which
// ends for every matrix with positive principal minors (Murty 1974).
void ContactTerm::choose_active(const Context& c) {
    constexpr int patience = 6;
    bool changed = false;
    unsettled_ = false;
    cover(c);
    for (int A = 0; A < gaps_->n(); ++A) {
        const char wanted = wants_pressure(A, c);
        if (wanted == active_[A]) continue;
        if (changed && changes_ >= patience) {
            unsettled_ = true;
            break;
        }
        active_[A] = wanted, changed = true;
    }
    if (changes_ < 0 || changed) ++changes_;
}

// In statics bodies may be held by contact alone: the augmentation keeps their tangents regular. With inertia
// multipliers serve as they are, so that a change of the active set changes nothing but their rows and
// columns. Nor does the augmentation do work: the multiplier alone is the force that a load step begins with.
double ContactTerm::augmentation(int A, const Context& c) const {
    const bool plain = c.step.motion[0][0] != 0 && (!has_friction() || rebounds());
    return plain || c.backwards ? 0 : options_.stiffness[A];
}

// The pressure at a gap, not negative once the active set has settled.
void ContactTerm::press(int A, const Context& c, double gap_theta) {
    const double k = options_.stiffness[A];
    S_[A] = dS_gap_[A] = R_[A] = 0;
    const bool alone = gaps_->stencil(A).empty() || (area0_[A] == 0 && area1_[A] == 0);
    if (!has_multipliers() && alone) {
        active_[A] = 0;  // no gap of nothing is closed
        return;
    }
    if (!has_multipliers() && is_discrete(c.step)) {
        press_discretely(A, c);
    } else if (!has_multipliers()) {
        if (gap_theta < slack(A, c)) S_[A] = -k * gap_theta, dS_gap_[A] = -k;
    } else {
        const double lambda = c.vectors.x1[options_.multiplier[A]], closing = gap1_[A] - least_gap(A, c);
        const double c_A = augmentation(A, c);
        if (active_[A])
            S_[A] = lambda - c_A * closing, dS_gap_[A] = -c_A, R_[A] = -closing;
        else
            R_[A] = -lambda / k;
        return;
    }
    active_[A] = dS_gap_[A] != 0;
}

double ContactTerm::potential(int A, double gap) const {
    const double depth = std::min(gap, 0.0);
    return 0.5 * options_.stiffness[A] * depth * depth;
}

// S (gap1 - gap0) = W(gap0) - W(gap1) for W = k / 2 <-gap>^2, and what a damper takes of penetration; both
// together do not pull.
void ContactTerm::press_discretely(int A, const Context& c) {
    const double k = options_.stiffness[A], a = std::min(gap0_[A], 0.0), b = std::min(gap1_[A], 0.0);
    const double change = gap1_[A] - gap0_[A];
    if (a == gap0_[A] && b == gap1_[A]) {
        S_[A] = -0.5 * k * (a + b), dS_gap_[A] = -0.5 * k;
    } else if (a != b) {
        S_[A] = 0.5 * k * (a - b) * (a + b) / change;
        dS_gap_[A] = -(k * b + S_[A]) / change;
    }
    if (options_.damping.empty() || c.step.motion[0][0] == 0) return;
    const double rate = options_.damping[A] / c.step.h;
    S_[A] -= rate * (b - a);
    if (b < 0) dS_gap_[A] -= rate;
    if (S_[A] <= 0) S_[A] = dS_gap_[A] = 0;
}

// --- forces
// -------------------------------------------------------------------------------------------------
Eigen::VectorXd ContactTerm::stencil_of(int A, const std::vector<double>& X) const {
    const auto& stencil = gaps_->stencil(A);
    Eigen::VectorXd x(3 * stencil.size());
    for (std::size_t v = 0; v < stencil.size(); ++v)
        for (int i = 0; i < 3; ++i) x[3 * v + i] = X[3 * stencil[v] + i];
    return x;
}

// Per pressure, on the stencil's vertices: the gradient, completed to a discrete one where the scheme wants
// it.
void ContactTerm::force(int A, const Context& c, Eigen::VectorXd& f) const {
    f = vector_of(at_theta_[A].gradient);
    if (!is_discrete(c.step)) return;
    const Eigen::VectorXd D = stencil_of(A, D_);
    Correction correction(stencil_of(A, Xt_), D, masses_[A].weight, gaps_->skin().dim);
    correction.complete(gap1_[A] - gap0_[A] - f.dot(D));
    f += correction.c * correction.complement.momentum();
}

void ContactTerm::residual(const Context& c, double* r) {
    const Stopwatch watch(costs_.forces);
    evaluate(c, true);
    unsettled_gaps_.clear();
    for (int A = 0; A < gaps_->n(); ++A)
        if (active_[A] != active_at_tangent_[A] || slips_[A] != slips_at_tangent_[A])
            unsettled_gaps_.push_back(A);
    find_gradients();
    Eigen::VectorXd f;
    for (int A = 0; A < gaps_->n(); ++A) {
        if (has_multipliers()) r[options_.multiplier[A]] += R_[A];
        for (int i = 0; has_tangential() && i + 1 < gaps_->skin().dim; ++i)
            r[options_.friction.multiplier[A] + i] +=
                (traction_[A].value[i] - base_[A][i]) / tangential(A, c) - yields(A, i, c);
        if (!active_[A]) continue;
        force(A, c, f);
        const auto& stencil = gaps_->stencil(A);
        f *= -S_[A];
        if (has_friction()) f += sliding(A).force(traction_[A].value);
        for (std::size_t v = 0; v < stencil.size(); ++v)
            gaps_->skin().add_force(stencil[v], f.data() + 3 * v, 1.0, r);
    }
}

// S df/dx1, minus what follows from the change of S: in the place of the second derivatives.
Eigen::Map<ContactTerm::Matrix> ContactTerm::stiffness(int A, const Context& c, const Eigen::VectorXd& g1,
                                                       const Eigen::VectorXd& f) {
    Gap& gap = at_theta_[A];
    const Eigen::VectorXd g = vector_of(gap.gradient);
    if (S_[A] == 0) gap.hessian.assign(g.size() * g.size(), 0.0);
    Eigen::Map<Matrix> K(gap.hessian.data(), g.size(), g.size());
    const double t = theta(c.step);
    if (t != 1) K *= t;
    if (dS_gap_[A] != 0) K.noalias() += (dS_gap_[A] * f) * g1.transpose();
    if (S_[A] == 0 || !is_discrete(c.step)) return K;
    const Eigen::VectorXd D = stencil_of(A, D_);
    Correction correction(stencil_of(A, Xt_), D, masses_[A].weight, gaps_->skin().dim);
    correction.complete(gap1_[A] - gap0_[A] - g.dot(D));
    if (correction.size == 0) return K;
    const Eigen::VectorXd p = correction.complement.momentum(), &m = masses_[A].weight;
    Eigen::MatrixXd dp = correction.complement.derivative(t);
    for (Eigen::Index v = 0; v < m.size(); ++v) dp.middleRows<3>(3 * v) *= m[v];
    Eigen::VectorXd d_size = 2 * (dp.transpose() * correction.complement.motion());
    if (const Eigen::MatrixXd& dm = masses_[A].weight_gradient; dm.size() > 0) {
        dp += correction.complement.by_masses() * dm;
        d_size += dm.transpose() * correction.complement.size_by_masses();
    }
    const Eigen::VectorXd dc = (g1 - g - t * vector_of(gap.along) - correction.c * d_size) / correction.size;
    K.noalias() += (S_[A] * p) * dc.transpose();
    K += (S_[A] * correction.c) * dp;
    return K;
}

void ContactTerm::tangent(const Context& c, double* values) {
    const bool mass_alone = c.step.theta == 0 && c.step.theta_g == 0 && c.step.motion[0][0] == 0;
    if (mass_alone) return;  // at an instant, where the augmentation of closed gaps would be taken for mass
    const Stopwatch watch(costs_.forces);
    // a restart makes this tangent again
    gaps_->skin().positions(c.vectors.x0, X0_), gaps_->skin().positions(c.vectors.x1, X1_);
    narrow();
    evaluate(c, false, true);
    active_at_tangent_ = active_, slips_at_tangent_ = slips_;
    gaps_->mark_tangent();
    if (has_history()) at_tangent_ = {X0_, elastic_};
    std::vector<char> unpressed(active_.size());
    for (std::size_t A = 0; A < active_.size(); ++A) unpressed[A] = active_[A] && S_[A] == 0;
    const bool at_theta = (!has_multipliers() && !is_discrete(c.step)) || theta(c.step) == 1;
    segments([&] {
        if (std::any_of(unpressed.begin(), unpressed.end(), [](char u) { return u; }))
            gaps_->gradients(Xt_.data(), unpressed, at_theta_);
        gaps_->seconds(Xt_.data(), S_, is_discrete(c.step) ? D_.data() : nullptr, at_theta_);
        if (!at_theta) gaps_->gradients(X1_.data(), active_, at_end_);
    });
    known_at_ = Xt_, known_of_ = active_;
    border_places_.clear();
    std::vector<Border> borders(gaps_->n());
    parallel_for(gaps_->n(), [&](int A) {
        Eigen::VectorXd g1, f;
        if (active_[A]) {
            g1 = vector_of((at_theta ? at_theta_ : at_end_)[A].gradient);
            if (at_theta) g1 *= theta(c.step);
            force(A, c, f);
        }
        borders[A] = border(A, c, g1, f);
        if (!active_[A]) return;
        Eigen::Map<Matrix> K = stiffness(A, c, g1, f);
        if (has_friction()) add_friction(A, c, g1, K, borders[A]);
    });
    for (int A = 0; A < gaps_->n(); ++A) {
        if (active_[A]) scatter_stiffness(A, values);
        scatter(A, borders[A], values);
    }
}

// Where the active set alone has changed in a time step, only rows and columns of multipliers have.
bool ContactTerm::amend(const Context& c, double* values) {
    if (!has_multipliers() || has_friction() || c.step.motion[0][0] == 0) return false;
    const Stopwatch watch(costs_.forces);
    active_at_tangent_ = active_;
    segments([&] { gaps_->gradients(X1_.data(), active_, at_end_); });
    for (const std::int64_t at : border_places_) values[at] = 0;
    border_places_.clear();
    Eigen::VectorXd g1, f;
    for (int A = 0; A < gaps_->n(); ++A) {
        if (active_[A]) g1 = vector_of(at_end_[A].gradient), force(A, c, f);
        scatter(A, border(A, c, g1, f), values);
    }
    return true;
}

// Four corners of a box press on a plane where three would do, and what sticks may be held by a support as
// well. So little give in the tangent of a step, and none in the residual, leaves alone what changes nothing.
// Where rigid bodies rub, so little would let rounding pull vertices that stick far over Coulomb's limit: they
// get a part of the compliance that the step's inertia has.
double ContactTerm::ease(int A, const Context& c) const {
    constexpr double little = 1e-10, of_inertia = 2.5e-4;
    const bool instant =
        c.step.h > 0 && !c.step.has_length();  // where modes take closed gaps for constraints
    if (instant || (!options_.rigid && !has_tangential())) return 0;
    const double mass = std::abs(c.step.motion[1][0]) * options_.friction.inertia[A];
    if (is_inertial(c)) return of_inertia / tangential(A, c);
    const double stiffness = augmentation(A, c) + mass;
    return little / (stiffness > 0 ? stiffness : options_.stiffness[A]);
}

// Only what is redundant gives way in the residual as well, until it has vanished.
double ContactTerm::yields(int A, int i, const Context& c) const {
    return redundant_.empty() || redundant_[A][i] == 0 ? 0 : ease(A, c) * redundant_[A][i];
}

// Without friction; where there is no contact multipliers vanish.
ContactTerm::Border ContactTerm::border(int A, const Context& c, const Eigen::VectorXd& g1,
                                        const Eigen::VectorXd& f) const {
    const int m = n_multipliers(), normal = has_multipliers() ? 1 : 0;
    Border b;
    b.square.setZero(m, m);
    if (normal && !active_[A]) b.square(0, 0) = -1 / options_.stiffness[A];
    for (int i = normal; i < m; ++i) b.square(i, i) = -1 / tangential(A, c);
    if (!active_[A]) return b;
    if (normal) b.square(0, 0) -= ease(A, c);
    if (m > normal)  // what slips has its traction by Coulomb's law
        b.square.bottomRightCorner(m - normal, m - normal) -=
            ease(A, c) * traction_[A].by_trial.topLeftCorner(m - normal, m - normal);
    b.row.setZero(m, g1.size()), b.column.setZero(g1.size(), m);
    if (normal) b.row.row(0) = -g1.transpose(), b.column.col(0) = -f;
    return b;
}

// Where blocks of nodes begin in the tangent, for all pairs of a stencil's forms, and all entries of its
// multipliers; found once per stencil.
const ContactTerm::Places& ContactTerm::places(int A) {
    const Skin& skin = gaps_->skin();
    Places& p = places_[A];
    if (p.known && p.stencil == gaps_->stencil(A)) return p;
    p.known = true, p.stencil = gaps_->stencil(A), p.blocks.clear(), p.border.clear();
    const std::vector<int> own = multipliers(A);
    for (int i : own)
        for (int j : own) p.border.push_back(pattern_->position(i, j));
    each_form(p.stencil, [&](int, int k) {
        for (int j : own)
            for (int i = 0; i < skin.dim; ++i) {
                p.border.push_back(pattern_->position(j, skin.unknown[k] + i));
                p.border.push_back(pattern_->position(skin.unknown[k] + i, j));
            }
        each_form(p.stencil, [&](int, int l) {
            const bool block = skin.mesh_node[k] && skin.mesh_node[l];
            p.blocks.push_back(block ? pattern_->position(skin.unknown[k], skin.unknown[l]) : -1);
        });
    });
    return p;
}

namespace {
// Adds a block of rows that are `apart` to values in rows of some length.
template <int dim>
void add_block(const double* block, std::size_t apart, double factor, double* values, std::int64_t length) {
    for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) values[i * length + j] += factor * block[i * apart + j];
}
}  // namespace

void ContactTerm::scatter_stiffness(int A, double* values) {
    const Skin& skin = gaps_->skin();
    const auto& stencil = gaps_->stencil(A);
    const std::size_t apart = 3 * stencil.size();
    const double* K = at_theta_[A].hessian.data();
    const std::int64_t* place = places(A).blocks.data();
    each_form(stencil, [&](int v, int k) {
        const int row = skin.unknown[k];
        const std::int64_t length = pattern_->row_length(row);
        each_form(stencil, [&](int w, int l) {
            const double factor = -skin.weight[k] * skin.weight[l];
            const double* block = K + 3 * v * apart + 3 * w;
            const std::int64_t first = *place++;
            if (first >= 0 && skin.dim == 3)
                return add_block<3>(block, apart, factor, values + first, length);
            if (first >= 0) return add_block<2>(block, apart, factor, values + first, length);
            if (skin.mesh_node[k] && skin.mesh_node[l]) return;
            for (int i = 0; i < skin.dim; ++i)
                for (int j = 0; j < skin.dim; ++j) {
                    const std::int64_t at = pattern_->position(row + i, skin.unknown[l] + j);
                    if (at >= 0) values[at] += factor * block[i * apart + j];
                }
        });
    });
}

void ContactTerm::scatter(int A, const Border& b, double* values) {
    const Skin& skin = gaps_->skin();
    const Eigen::Index m = b.square.rows();
    if (m == 0) return;
    const std::int64_t* place = places(A).border.data();
    auto add = [&](double value) {
        const std::int64_t at = *place++;
        if (at >= 0) values[at] += value, border_places_.push_back(at);
    };
    for (Eigen::Index i = 0; i < m; ++i)
        for (Eigen::Index j = 0; j < m; ++j) add(b.square(i, j));
    if (!active_[A]) return;
    each_form(gaps_->stencil(A), [&](int v, int k) {
        for (Eigen::Index j = 0; j < m; ++j)
            for (int i = 0; i < skin.dim; ++i) {
                add(skin.weight[k] * b.row(j, 3 * v + i));
                add(skin.weight[k] * b.column(3 * v + i, j));
            }
    });
}

// --- books
// --------------------------------------------------------------------------------------------------
void ContactTerm::add_to_vertices(int A, const Eigen::VectorXd& f, std::vector<double>& sum) const {
    const auto& stencil = gaps_->stencil(A);
    for (std::size_t v = 0; v < stencil.size(); ++v)
        for (int i = 0; i < 3; ++i) sum[3 * stencil[v] + i] += f[3 * v + i];
}

// A step taken backwards, as statics books its work, leaves the forces of the step itself.
void ContactTerm::ledger(const Context& c, const double*, LedgerSums& sums) {
    if (!c.backwards) return book(c, sums);
    const auto forces = forces_, friction = friction_forces_;
    book(c, sums);
    forces_ = forces, friction_forces_ = friction;
}

// Whether a gap of rigid bodies closes as the step begins, so that its pressure is that of an impact.
bool ContactTerm::collides(int A, const Context& c) const {
    return rebounds() && holds(c) && active_[A] && closes(A, c);
}

bool ContactTerm::closes(int A, const Context& c) const {
    return -c.step.h * rate0_[A] > touching * reach_ * area0_[A];
}

// An impulse changes the kinetic energy by its work along the mean of the velocities before and after it.
// Increments of the scheme are those only if it goes on with that mean.
void ContactTerm::find_way(const Context& c) {
    const double* v1 = c.step.motion[2];
    gaps_->skin().increments(c.vectors.v0, V0_);
    mean_way_.resize(D_.size());
    for (std::size_t i = 0; i < D_.size(); ++i)
        mean_way_[i] = 0.5 * c.step.h * (v1[0] * D_[i] + (1 + v1[1]) * V0_[i]);
}

Impact ContactTerm::impact(int A, const Eigen::VectorXd& f) const {
    Impact hit{work_account, S_[A] * f.dot(stencil_of(A, D_) - stencil_of(A, mean_way_)), 0, {}};
    if (has_friction()) hit.rubbed = slip_work(A, D_) - slip_work(A, mean_way_);
    const Skin& skin = gaps_->skin();
    each_form(gaps_->stencil(A), [&](int, int k) { hit.unknowns.push_back(skin.unknown[k]); });
    return hit;
}

void ContactTerm::book(const Context& c, LedgerSums& sums) {
    const Stopwatch watch(costs_.forces);
    evaluate(c, false);
    find_gradients();
    forces_.assign(X1_.size(), 0.0), friction_forces_.assign(X1_.size(), 0.0);
    const bool bends = c.step.motion[2][1] != -1;  // velocities in a step otherwise than by their mean
    if (rebounds() && bends) find_way(c);
    Eigen::VectorXd f;
    for (int A = 0; A < gaps_->n(); ++A) {
        if (!has_multipliers()) sums.energy[energy_account] += potential(A, gap1_[A]);
        if (!options_.damping.empty())
            sums.work[work_account] +=
                S_[A] * (gap1_[A] - gap0_[A]) + potential(A, gap1_[A]) - potential(A, gap0_[A]);
        const bool collided = bends && collides(A, c);
        const std::vector<double>& way = collided ? mean_way_ : D_;
        if (has_friction()) book_friction(A, c, way, sums);
        if (!active_[A]) continue;
        force(A, c, f);
        if (collided) sums.impacts.push_back(impact(A, f));
        add_to_vertices(A, S_[A] * f, forces_);
        if (has_friction()) add_to_vertices(A, -sliding(A).force(traction_[A].value), friction_forces_);
        if (has_multipliers()) sums.work[work_account] += S_[A] * f.dot(stencil_of(A, way));
    }
}

void ContactTerm::accept(const Context& c) {
    if (c.step.motion[0][0] == 0) {  // the books of statics have gone back along the path
        gaps_->skin().positions(c.vectors.x0, X0_);
        settle();
        evaluate(c, true);
    }
    if (c.step.motion[0][0] != 0) pushed_out_ = true;
    if (has_history()) keep(c);
    begin(c.vectors.x1);
}

}  // namespace visviva
