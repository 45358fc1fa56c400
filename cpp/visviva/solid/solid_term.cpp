#include "visviva/solid/solid_term.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace visviva {

namespace {

constexpr int L8 = solid_lanes, task_blocks = 16;  // of tasks that write apart from each other

template <class Array>
auto kept(const Array& a) {
    return a.empty() ? nullptr : a.data();
}
}  // namespace

SolidTerm::SolidTerm(const SolidData& d)
    : slots_(d.index, d.n, d.n_nodes + d.n_pressures, d.n_nodes + d.n_pressures) {
    const int na = d.n_nodes;
    if (na > solid_max_nodes) throw std::invalid_argument("an element has too many nodes");
    const int *from = slots_.index(), *end = from + std::int64_t{slots_.n_blocks()} * slots_.n_slots() * L8;
    for (; d.n_pressures && from != end; from += slots_.n_slots() * L8) {
        index_.insert(index_.end(), from, from + na * L8);
        pressure_index_.insert(pressure_index_.end(), from + na * L8, from + slots_.n_slots() * L8);
    }
    keep_geometry(d);
    in_lanes(par_, d.par, d.n_par, d.n);
    in_lanes(damping_, d.damping, 3, d.n);
    SolidView& v = view_;
    v.n = d.n, v.n_blocks = slots_.n_blocks(), v.n_nodes = na, v.n_points = d.n_points, v.dim = d.dim;
    v.n_pressures = d.n_pressures, v.n_par = d.n_par, v.kind = d.kind, v.small = d.small,
    v.damped = needs_rates = d.damping != nullptr;
    v.index = d.n_pressures ? kept(index_) : slots_.index();
    v.pressure_index = kept(pressure_index_);
    v.par = kept(par_), v.damping = kept(damping_);
    smallest_.assign(static_cast<std::size_t>(v.n_blocks) * L8, 1.0);
    v.smallest = smallest_.data();
}

void SolidTerm::keep_geometry(const SolidData& d) {
    const std::int64_t na = d.n_nodes, nq = d.n_points;
    in_lanes(X_, d.places, na * 3, d.n);
    in_lanes(G_, d.gradients, nq * na * d.dim, d.n);
    in_lanes(H_, d.hoop, nq * na, d.n);
    in_lanes(w_, d.volume, nq, d.n);
    in_lanes(mass_, d.mass, na * (na + 1) / 2, d.n);
    if (d.places) {
        std::copy_n(d.slopes, std::size(brick_.slopes), brick_.slopes);
        std::copy_n(d.weight, std::size(brick_.weight), brick_.weight);
        if (d.mass_shapes) std::copy_n(d.mass_shapes, std::size(brick_.mass), brick_.mass);
    }
    view_.X = kept(X_), view_.brick = &brick_, view_.has_mass = d.mass || d.mass_shapes;
    view_.G = kept(G_), view_.H = kept(H_), view_.w = kept(w_), view_.mass = kept(mass_);
}

void SolidTerm::set_centre(const double* gradients, const double* hoop) {
    in_lanes(centre_G_, gradients, view_.n_nodes * view_.dim, view_.n);
    in_lanes(centre_H_, hoop, view_.n_nodes, view_.n);
    view_.centre_G = centre_G_.data(), view_.centre_H = hoop ? centre_H_.data() : nullptr;
    mixed_ = &mixed_kernels(view_.dim, true);
}

void SolidTerm::set_thermal(const double* strain) {
    in_lanes(thermal_, strain, view_.n_points, view_.n);
    view_.thermal = thermal_.data();
}

void SolidTerm::set_pressure(const double* shape, const double* compliance, int measure, bool multiplier) {
    const int np = view_.n_pressures;
    in_lanes(shape_, shape, view_.n_points * np, view_.n);
    in_lanes(compliance_, compliance, np * np, view_.n);
    view_.shape = shape_.data(), view_.compliance = compliance_.data();
    view_.measure = measure, view_.multiplier = multiplier;
    mixed_ = &mixed_kernels(view_.dim, false);
}

void SolidTerm::connect(const Pattern& pattern) {
    slots_.connect(pattern);
    view_.row = slots_.row(), view_.length = slots_.length(), view_.offset = slots_.offset();
}

void SolidTerm::set_callback(LawCallback f) {
    callback_ = std::move(f);
    const std::size_t n = static_cast<std::size_t>(view_.n_blocks) * view_.n_points * L8, k = n_strains();
    for (auto* a : {&c0_, &ct_, &c1_, &user_S_}) a->assign(k * n, 0.0);
    user_W_.assign(n, 0.0), user_D_.assign(k * k * n, 0.0);
    view_.user_W = user_W_.data(), view_.user_S = user_S_.data(), view_.user_D = user_D_.data();
}

// C at the elements' centres, behind C at their points, and beyond the same heat.
void SolidTerm::strains_at_centres(const Context& c) {
    const std::size_t lanes = static_cast<std::size_t>(view_.n_blocks) * L8;
    Aligned<double> c0(6 * lanes), ct(6 * lanes), c1(6 * lanes);
    SolidView centre = view_;
    centre.n_points = 1, centre.G = view_.centre_G, centre.H = view_.centre_H, centre.thermal = nullptr;
    solid_kernels().strains(centre, c.step, c.vectors, c0.data(), ct.data(), c1.data());
    const std::size_t nq = view_.n_points, stride = lanes * nq;
    for (const auto& [from, to] : {std::pair{&c0, &c0_}, {&ct, &ct_}, {&c1, &c1_}})
        for (std::size_t k = 0; k < 6; ++k)
            for (std::size_t point = 0; point < stride; ++point) {
                const double stretch = view_.thermal ? 1 + view_.thermal[point] : 1;
                (*to)[(6 + k) * stride + point] =
                    (*from)[k * lanes + point / (nq * L8) * L8 + point % L8] / (stretch * stretch);
            }
}

void SolidTerm::call_back(const Context& c, bool want_tangent) {
    if (!callback_) return;
    solid_kernels().strains(view_, c.step, c.vectors, c0_.data(), ct_.data(), c1_.data());
    if (view_.centre_G) strains_at_centres(c);
    const int n = view_.n_blocks * view_.n_points * L8;
    callback_({n,
               n,
               n_strains(),
               0,
               want_tangent,
               c.step.te,
               c.step.h,
               c.step.stress,
               c0_.data(),
               c1_.data(),
               ct_.data(),
               nullptr,
               nullptr,
               user_S_.data(),
               user_D_.data(),
               nullptr,
               nullptr,
               nullptr,
               nullptr,
               user_W_.data()});
}

void SolidTerm::residual(const Context& c, double* r) {
    call_back(c, false);
    const auto kernel = mixed_ ? mixed_->residual : solid_kernels().residual;
    slots_.for_tasks([&](int begin, int end) { kernel(view_, c.step, c.vectors, begin, end, r); });
}

void SolidTerm::tangent(const Context& c, double* values) {
    if (!mixed_) return linearise(c, nullptr, values);
    call_back(c, true);
    slots_.assemble(
        values, [&](int begin, int end) { mixed_->tangent(view_, c.step, c.vectors, begin, end, values); });
}

void SolidTerm::linearise(const Context& c, double* r, double* values) {
    if (mixed_) return residual(c, r), tangent(c, values);
    call_back(c, true);
    const auto kernel = solid_kernels().tangent;
    slots_.assemble(values,
                    [&](int begin, int end) { kernel(view_, c.step, c.vectors, begin, end, r, values); });
}

void SolidTerm::ledger(const Context& c, const double* v1, LedgerSums& sums) {
    call_back(c, false);
    std::vector<double> of_block(static_cast<std::size_t>(solid_ledger_rows) * view_.n_blocks);
    slots_.for_tasks([&](int begin, int end) {
        const std::size_t stride = static_cast<std::size_t>(end - begin) * L8;
        Aligned<double> rows(solid_ledger_rows * stride);
        solid_kernels().ledger(view_, c.step, c.vectors, v1, begin, end, rows.data());
        if (mixed_) mixed_->energy(view_, c.step, c.vectors, begin, end, rows.data());  // instead of row 0
        for (int k = 0; k < solid_ledger_rows; ++k)
            for (int e = begin * L8; e < std::min(end * L8, view_.n); ++e)
                of_block[static_cast<std::size_t>(k) * view_.n_blocks + e / L8] +=
                    rows[k * stride + e - begin * L8];
    });
    double total[solid_ledger_rows] = {};
    for (std::size_t k = 0; k < of_block.size(); ++k) total[k / view_.n_blocks] += of_block[k];
    sums.energy[strain_account] += total[0];
    if (kinetic_account >= 0) sums.energy[kinetic_account] += total[1];
    if (damping_account >= 0) sums.work[damping_account] += total[2];
    for (int k = 0; k < 6; ++k)  // what moves away from the axis all around has no momentum but along it
        if (!view_.H || k == 1) sums.momentum[6 * static_cast<std::size_t>(owner) + k] += total[3 + k];
}

void SolidTerm::at_rest(At kernel, const double* x, int begin, int end, std::int64_t per_element,
                        double* out) {
    const Step step;
    const Vectors vectors{x, x, nullptr, nullptr};
    call_back({step, vectors, {}}, false);
    Aligned<double> smallest(smallest_.size());
    SolidView still = view_;
    still.has_mass = false, still.damped = false, still.smallest = smallest.data();
    const int first = begin / L8, last = (end + L8 - 1) / L8;
    parallel_for((last - first + task_blocks - 1) / task_blocks, [&](int task) {
        const int from = first + task * task_blocks;
        kernel(still, step, vectors, from, std::min(from + task_blocks, last),
               out + (from - first) * L8 * per_element);
    });
}

void SolidTerm::fields(const double* x, int begin, int end, double* out) {
    at_rest(mixed_ ? mixed_->fields : solid_kernels().fields, x, begin, end,
            std::int64_t{view_.n_points} * solid_field_rows, out);
}

void SolidTerm::forces(const double* x, int begin, int end, double* out) {
    at_rest(mixed_ ? mixed_->forces : solid_kernels().forces, x, begin, end,
            std::int64_t{view_.n_nodes} * view_.dim, out);
}

// Inverted elements: their energy is finite, but no body is like that.
Refusal SolidTerm::refuse(const Context& c) {
    for (int e = 0; e < view_.n; ++e) {
        if (smallest_[e] > 0) continue;
        double place[3] = {};
        for (int a = 0; a < view_.n_nodes; ++a)
            for (int k = 0; k < view_.dim; ++k)
                place[k] += c.vectors.x0[slots_.unknown(e, a) + k] / view_.n_nodes;
        char text[160];
        std::snprintf(text, sizeof text,
                      "element %d of %s near (%.4g, %.4g, %.4g) is inverted (smallest det F = %.3g)",
                      numbers[e], name.c_str(), place[0], place[1], place[2], smallest_[e]);
        return {slots_.unknown(e, 0), text};
    }
    return {};
}

}  // namespace visviva
