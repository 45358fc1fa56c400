#include "visviva/point/point_term.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace visviva {

namespace {
constexpr int L8 = point_lanes;
}

PointTerm::PointTerm(const PointData& d)
    : TermMemory("internal variables", 1),
      slots_(d.index, d.n, d.n_slots, d.n_slots),
      kernels_(point_kernels(d.kind)) {
    needs_rates = true;
    const PointShape& shape = kernels_.shape;
    if (static_cast<int>(d.groups.size()) != shape.n_groups)
        throw std::invalid_argument("a physics needs its groups of unknowns");
    PointView& v = view_;
    v.n = d.n, v.n_blocks = slots_.n_blocks(), v.n_points = d.n_points, v.n_slots = d.n_slots;
    v.n_par = shape.n_par, n_history_ = shape.n_history;
    int slot = 0;
    for (int g = 0; g < shape.n_groups; ++g) {
        const PointGroupData& from = d.groups[g];
        PointGroup& to = v.group[g];
        if (from.n_nodes > point_max_nodes) throw std::invalid_argument("an element has too many nodes");
        to.n_nodes = from.n_nodes, to.first_slot = slot, to.is_position = from.is_position;
        slot += from.n_nodes, v.n_unknowns += from.n_nodes * shape.group[g].components;
        int same = 0;  // a group with these weights: what is one in memory stays longer in the cache
        while (d.groups[same].weights != from.weights || d.groups[same].n_nodes != from.n_nodes) ++same;
        if (same == g)
            in_lanes(weights_[g], from.weights,
                     static_cast<std::int64_t>(d.n_points) * from.n_nodes * shape.group[g].columns, d.n);
        in_lanes(mass_[g], from.mass, from.n_nodes * (from.n_nodes + 1) / 2, d.n);
        to.weights = weights_[same].data(), to.mass = from.mass ? mass_[g].data() : nullptr;
    }
    if (slot != d.n_slots) throw std::invalid_argument("the nodes of the groups are not those of the index");
    in_lanes(w_, d.volume, d.n_points, d.n);
    const std::int64_t n_all = static_cast<std::int64_t>(d.n) * d.n_points * v.n_par;
    v.is_even = std::equal(d.par + (n_all > 0 ? v.n_par : 0), d.par + n_all, d.par);
    in_lanes(par_, d.par, v.is_even ? v.n_par : static_cast<std::int64_t>(d.n_points) * v.n_par,
             v.is_even ? std::min(d.n, 1) : d.n);
    in_lanes(reference_, d.reference, static_cast<std::int64_t>(d.n_points) * shape.n_strains, d.n);
    v.index = slots_.index(), v.w = w_.data(), v.par = par_.data();
    v.reference = d.reference ? reference_.data() : nullptr;
    const std::size_t lanes = static_cast<std::size_t>(v.n_blocks) * L8;
    lost_way_.assign(lanes, 0), v.lost_way = lost_way_.data();
    out_.assign(point_ledger_rows * lanes, 0.0);
    for (auto* h : {&history0_, &history1_, &before_, &at_tangent_})
        h->assign(lanes * d.n_points * n_history_, 0.0);
    v.history0 = history0_.data(), v.history1 = history1_.data();
}

void PointTerm::connect(const Pattern& pattern) {
    slots_.connect(pattern);
    view_.row = slots_.row(), view_.length = slots_.length(), view_.offset = slots_.offset();
}

void PointTerm::set_callback(LawCallback f, const std::vector<double>& start) {
    callback_ = std::move(f);
    const std::size_t n = static_cast<std::size_t>(view_.n_blocks) * view_.n_points * L8,
                      k = kernels_.shape.n_energy;
    for (auto* a : {&e0_, &et_, &e1_, &called_s_}) a->assign(k * n, 0.0);
    called_W_.assign(n, 0.0), called_T_.assign(k * k * n, 0.0);
    view_.called_W = called_W_.data(), view_.called_s = called_s_.data(), view_.called_T = called_T_.data();
    n_history_ = static_cast<int>(start.size());
    history0_.resize(start.size() * n);
    for (std::size_t i = 0; i < history0_.size(); ++i) history0_[i] = start[i / n];
    history1_ = before_ = at_tangent_ = history0_;
    view_.history0 = history0_.data(), view_.history1 = history1_.data();
    called_lost_.assign(start.empty() ? 0 : n, 0.0);
    view_.called_lost = start.empty() ? nullptr : called_lost_.data();
}

void PointTerm::start(const Context& c) {
    view_.backwards = c.backwards;
    std::fill(lost_way_.begin(), lost_way_.end(), 0);
    set_driven(c.signals.ate);
}

void PointTerm::drive(std::vector<std::pair<int, int>> places, int account) {
    if (!view_.is_even) throw std::invalid_argument("driven parameters are the same at all points");
    driven_ = std::move(places), drive_account_ = account;
}

void PointTerm::set_driven(const double* signals) {
    for (const auto& [place, signal] : driven_)
        std::fill_n(par_.begin() + static_cast<std::int64_t>(place) * L8, L8, signals[signal]);
}

/// Energy of the unknowns x with the parameters of some signals.
double PointTerm::energy_at(const Context& c, const double* x, const double* signals) {
    set_driven(signals);
    Vectors there = c.vectors;
    there.x0 = there.x1 = x;
    slots_.for_tasks([&](int begin, int end) {
        kernels_.ledger(view_, c.step, there, c.vectors.rate, begin, end, out_.data());
    });
    return std::accumulate(out_.begin(), out_.begin() + view_.n, 0.0);
}

void PointTerm::call_back(const Context& c, bool want_tangent) {
    start(c);
    if (!callback_) return;
    kernels_.strains(view_, c.step, c.vectors, e0_.data(), et_.data(), e1_.data());
    const int n = view_.n_blocks * view_.n_points * L8;
    LawArguments a{};
    a.n = a.stride = n, a.n_e = kernels_.shape.n_energy, a.want_tangent = want_tangent;
    a.t = c.step.te, a.h = c.backwards || !c.step.has_length() ? 0 : c.step.h, a.stress = c.step.stress;
    a.e0 = e0_.data(), a.e1 = e1_.data(), a.e_eval = et_.data();
    a.n_h = n_history_, a.h0 = history0_.data(), a.h1 = history1_.data(), a.lost = called_lost_.data();
    a.S = called_s_.data(), a.D = called_T_.data(), a.W = called_W_.data();
    callback_(a);
    const bool heats = c.step.goes_to_ends() && kernels_.shape.n_entropies > 0;
    if (heats) call_unheated(a);
    view_.unheated_W = heats ? unheated_W_.data() : nullptr;
    view_.unheated_s = heats ? unheated_s_.data() : nullptr;
}

// The same at the strains of the end with the entropies of the start.
void PointTerm::call_unheated(LawArguments a) {
    const PointShape& shape = kernels_.shape;
    unheated_e_ = e1_, unheated_W_.resize(called_W_.size()), unheated_s_.resize(called_s_.size());
    const std::ptrdiff_t n = a.n, first = shape.first_entropy * n;
    std::copy_n(e0_.begin() + first, shape.n_entropies * n, unheated_e_.begin() + first);
    a.e0 = a.e1 = a.e_eval = unheated_e_.data();
    a.S = unheated_s_.data(), a.W = unheated_W_.data(), a.want_tangent = false;
    callback_(a);
}

void PointTerm::residual(const Context& c, double* r) {
    call_back(c, false);
    slots_.for_tasks([&](int begin, int end) { kernels_.residual(view_, c.step, c.vectors, begin, end, r); });
}

void PointTerm::linearise(const Context& c, double* r, double* values) {
    call_back(c, true);
    std::copy(history0_.begin(), history0_.end(), at_tangent_.begin());
    slots_.assemble(values, [&](int begin, int end) {
        kernels_.tangent(view_, c.step, c.vectors, begin, end, r, values);
    });
}

void PointTerm::ledger(const Context& c, const double* v1, LedgerSums& sums) {
    call_back(c, false);
    slots_.for_tasks(
        [&](int begin, int end) { kernels_.ledger(view_, c.step, c.vectors, v1, begin, end, out_.data()); });
    const std::size_t stride = static_cast<std::size_t>(view_.n_blocks) * L8;
    double total[point_ledger_rows] = {};
    for (int k = 0; k < point_ledger_rows; ++k)
        for (int e = 0; e < view_.n; ++e) total[k] += out_[k * stride + e];
    // The step is taken with the parameters of its middle: they change at its start, and again at its end.
    if (!driven_.empty() && !callback_) {
        const Vectors& x = c.vectors;
        const double middle =
            energy_at(c, x.x0, c.signals.ate) - energy_at(c, x.x0, c.signals.at0) - total[0];
        total[0] = energy_at(c, x.x1, c.signals.at1);
        sums.work[drive_account_] += middle + total[0];
        set_driven(c.signals.ate);
    }
    sums.energy[energy_account] += total[0];
    if (kinetic_account >= 0) sums.energy[kinetic_account] += total[1];
    // What is lost within the material is lost once, not by halves there and back.
    if (!c.backwards) lost_ = total[9];
    if (dissipation_account >= 0) sums.work[dissipation_account] -= total[2] + (c.backwards ? -lost_ : lost_);
    for (int k = 0; k < 6; ++k) sums.momentum[6 * static_cast<std::size_t>(owner) + k] += total[3 + k];
}

Refusal PointTerm::refuse(const Context&) {
    for (int e = 0; e < view_.n; ++e)
        if (lost_way_[e])
            return {slots_.unknown(e, 0),
                    name + (kernels_.shape.n_history > 0
                                ? ": internal variables at a point of its element " + std::to_string(e) +
                                      " find no end of so long a step"
                                : ": at a point of its element " + std::to_string(e) +
                                      " the composition leaves the domain of the free "
                                      "energy's logarithms, from 0 to 1")};
    return {};
}

double PointTerm::share(const double* x1, const double* d) const {
    constexpr double most = 0.9;
    const PointView& v = view_;
    const PointGroup& g = v.group[limited_];
    const int columns = kernels_.shape.group[limited_].columns;
    double share = 1;
    for (int e = 0; e < v.n; ++e) {
        const int block = e / L8, lane = e % L8;
        const int* slots =
            v.index + (static_cast<std::int64_t>(block) * v.n_slots + g.first_slot) * L8 + lane;
        for (int q = 0; q < v.n_points; ++q) {
            const std::int64_t point = static_cast<std::int64_t>(block) * v.n_points + q;
            const double* w = g.weights + point * g.n_nodes * columns * L8 + lane;
            const double* par = v.par + (v.is_even ? 0 : point * v.n_par * L8) + lane;
            double c = 0, down = 0;
            for (int a = 0; a < g.n_nodes; ++a) {
                c += w[a * columns * L8] * x1[slots[a * L8]];
                down += w[a * columns * L8] * d[slots[a * L8]];
            }
            if (std::abs(down) > reach_ && std::isfinite(down))
                share = std::min(share, reach_ / std::abs(down));
            if (par[0] != 0 && c > 0 && down > most * c) share = std::min(share, most * c / down);
            if (par[L8] != 0 && c < 1 && -down > most * (1 - c))
                share = std::min(share, most * (1 - c) / -down);
        }
    }
    return share;
}

// The internal variables at the end are those of the accepted step: whatever was looked at since its last
// residual.
void PointTerm::accept(const Context& c) {
    if (n_history_ == 0) return;
    call_back(c, false);
    if (!callback_)  // which has given them
        slots_.for_tasks([&](int begin, int end) {
            kernels_.ledger(view_, c.step, c.vectors, c.vectors.rate, begin, end, out_.data());
        });
    std::copy(history0_.begin(), history0_.end(), before_.begin());
    std::copy(history1_.begin(), history1_.end(), history0_.begin());
}

void PointTerm::write_memory(std::vector<double>& memory) const {
    for (const auto* h : {&history0_, &before_, &at_tangent_})
        memory.insert(memory.end(), h->begin(), h->end());
}

bool PointTerm::read_memory(const double*& memory) {
    for (auto* h : {&history0_, &before_, &at_tangent_}) {
        std::copy(memory, memory + h->size(), h->begin());
        memory += h->size();
    }
    return false;
}

void PointTerm::write_history(std::vector<double>& history) const {
    history.insert(history.end(), history0_.begin(), history0_.end());
}

void PointTerm::read_history(const double*& history) {
    std::copy(history, history + history0_.size(), history0_.begin());
    history += history0_.size();
}

void PointTerm::return_to(Past past) {
    const auto& then = past == Past::step ? before_ : at_tangent_;
    std::copy(then.begin(), then.end(), history0_.begin());
}

}  // namespace visviva
