#include "visviva/contact/contact_heat.hpp"

namespace visviva {

// What passes at a gap, with derivatives by its variables: positions of the stencil's vertices (3 k), their
// temperatures (k), multipliers (3).
struct ContactHeat::Flow {
    double area = 0, theta[2] = {}, heat[2] = {};  // mean temperatures, heat per time into both sides
    Eigen::VectorXd share;                         // of each vertex in what its side gets
    Eigen::RowVectorXd theta_by[2], heat_by[2];
    Eigen::MatrixXd share_by;
};

// Forms of a gap's stencil that carry heat: f(place of the vertex, form, side).
template <class F>
void ContactHeat::each_warm(int A, F f) const {
    const auto& stencil = contact_->gaps().stencil(A);
    contact_->gaps().skin().each_form(stencil, [&](int v, int k) {
        if (warmth_.balance[k] >= 0) f(v, k, is_first(stencil[v]) ? 0 : 1);
    });
}

void ContactHeat::couple(Pattern& pattern) const {
    const Skin& skin = contact_->gaps().skin();
    for (int A = 0; A < contact_->n(); ++A) {
        std::vector<int> all = contact_->gaps().neighbours(A);
        all.push_back(A);
        const std::vector<int> multipliers = contact_->multipliers(A);
        skin.each_form(all, [&](int, int k) {
            const int row = warmth_.balance[k];
            if (row < 0) return;
            for (int m : multipliers) pattern.couple(row, m), pattern.couple(m, row);
            skin.each_form(all, [&](int, int l) {
                for (int i = 0; i < skin.dim; ++i)
                    pattern.couple(row, skin.unknown[l] + i), pattern.couple(skin.unknown[l] + i, row);
                if (warmth_.temperature[l] >= 0)
                    pattern.couple(row, warmth_.temperature[l]), pattern.couple(warmth_.temperature[l], row);
            });
        });
    }
}

double ContactHeat::temperature(int form, int side, const Context& c) const {
    const int u = warmth_.temperature[form];
    const double end = c.vectors.x1[u];
    return warmth_.entropy[side] ? end : c.vectors.x0[u] + c.step.theta * (end - c.vectors.x0[u]);
}

void ContactHeat::evaluate(const Context& c, bool gradients, bool by_rates) {
    contact_->find_passages(c, gradients, by_rates, passages_);
    pressure_.resize(passages_.size());
    for (std::size_t A = 0; A < passages_.size(); ++A) pressure_[A] = passages_[A].pressure;
    conductances_.assign(pressure_.size(), 0.0), slopes_.assign(pressure_.size(), 0.0);
    if (conductance_) conductance_(pressure_, conductances_, slopes_);
}

ContactHeat::Flow ContactHeat::flow(int A, const Context& c, bool gradients) const {
    const Passage& p = passages_[A];
    const auto& stencil = contact_->gaps().stencil(A);
    const Skin& skin = contact_->gaps().skin();
    const Eigen::Index k = p.weight.size(), n = 4 * k + 3;
    Flow f;
    Eigen::VectorXd T = Eigen::VectorXd::Zero(k);
    each_warm(A, [&](int v, int form, int side) { T[v] += skin.weight[form] * temperature(form, side, c); });
    const double sign = warmth_.carries[0] ? -1 : 1;
    for (Eigen::Index v = 0; v < k; ++v)
        if (is_heated(stencil[v])) f.area += sign * p.weight[v];
    f.share = p.weight.cwiseAbs() / f.area;
    for (Eigen::Index v = 0; v < k; ++v) {
        if (is_first(stencil[v]) == (p.weight[v] > 0)) f.share[v] *= -1;
        f.theta[is_first(stencil[v]) ? 0 : 1] += f.share[v] * T[v];
    }
    const bool both = warmth_.carries[0] && warmth_.carries[1];
    const double h = both ? conductances_[A] : 0, jump = f.theta[1] - f.theta[0];
    const double per_time = rate(c);
    f.heat[0] = h * f.area * jump + warmth_.share * per_time * p.rubbed;
    f.heat[1] = -h * f.area * jump + (1 - warmth_.share) * per_time * p.rubbed;
    if (!gradients) return f;

    Eigen::RowVectorXd area_by = Eigen::RowVectorXd::Zero(3 * k);
    for (Eigen::Index v = 0; v < k; ++v)
        if (is_heated(stencil[v])) area_by += sign * p.weight_by_place.row(v);
    f.share_by.resize(k, 3 * k);
    for (auto* by : {&f.theta_by[0], &f.theta_by[1], &f.heat_by[0], &f.heat_by[1]}) by->setZero(n);
    for (Eigen::Index v = 0; v < k; ++v) {
        const int side = is_first(stencil[v]) ? 0 : 1;
        f.share_by.row(v) = ((side == 0 ? -1 : 1) * p.weight_by_place.row(v) - f.share[v] * area_by) / f.area;
        f.theta_by[side].head(3 * k) += T[v] * f.share_by.row(v);
        f.theta_by[side][3 * k + v] += f.share[v];
    }
    Eigen::RowVectorXd by = h * f.area * (f.theta_by[1] - f.theta_by[0]);
    by.head(3 * k) += h * jump * area_by;
    if (both) {
        const double by_pressure = slopes_[A] * f.area * jump;
        by.head(3 * k) += by_pressure * p.pressure_by_place;
        by[4 * k] += by_pressure * p.pressure_by_multiplier;
    }
    f.heat_by[0] = by, f.heat_by[1] = -by;
    if (p.rubbed_by_place.size() == 0) return f;
    for (int side = 0; side < 2; ++side) {
        const double part = per_time * (side == 0 ? warmth_.share : 1 - warmth_.share);
        f.heat_by[side].head(3 * k) += part * p.rubbed_by_place;
        f.heat_by[side].tail<3>() += part * p.rubbed_by_multiplier;
    }
    return f;
}

// What was elastic in the slip where surfaces part heats the vertex of the first, or, where that carries no
// heat, evenly the vertices of the second that are near: f(forms with their parts, heat per time,
// temperature).
template <class F>
void ContactHeat::each_parted(const Context& c, F f) const {
    const Skin& skin = contact_->gaps().skin();
    const int side = warmth_.carries[0] ? 0 : 1;
    const double own = side == 0 ? warmth_.share : 1 - warmth_.share;
    const double taken = warmth_.carries[0] && warmth_.carries[1] ? 1 : own;
    for (int A = 0; A < contact_->n(); ++A) {
        const double heat = taken * rate(c) * passages_[A].rubbed;
        if (passages_[A].active || heat == 0) continue;
        std::vector<std::pair<int, double>> parts;
        double sum = 0, T = 0;
        const auto& stencil = contact_->gaps().stencil(A);
        each_warm(A, [&](int v, int form, int of) {
            if (of != side || (side == 0 && stencil[v] != A)) return;
            parts.emplace_back(form, skin.weight[form]), sum += skin.weight[form];
        });
        for (auto& [form, part] : parts) part /= sum, T += part * temperature(form, side, c);
        f(parts, heat, T);
    }
}

// Of steps the books go back too, where h, slips and what they have made are negative.
double ContactHeat::rate(const Context& c) { return std::abs(c.step.h) > Step::no_length ? 1 / c.step.h : 0; }

void ContactHeat::residual(const Context& c, double* r) {
    evaluate(c, false);
    const Skin& skin = contact_->gaps().skin();
    const bool entropy = warmth_.entropy[warmth_.carries[0] ? 0 : 1];
    each_parted(c, [&](const auto& parts, double heat, double T) {
        for (const auto& [form, part] : parts) r[warmth_.balance[form]] -= part * heat / (entropy ? T : 1);
    });
    for (int A = 0; A < contact_->n(); ++A) {
        if (!passages_[A].active) continue;
        const Flow f = flow(A, c, false);
        if (!(f.area > 0)) continue;
        each_warm(A, [&](int v, int form, int side) {
            const double by = warmth_.entropy[side] ? f.theta[side] : 1;
            r[warmth_.balance[form]] -= skin.weight[form] * f.share[v] * f.heat[side] / by;
        });
    }
}

void ContactHeat::tangent(const Context& c, double* values) {
    evaluate(c, true);
    const Skin& skin = contact_->gaps().skin();
    const bool entropy = warmth_.entropy[warmth_.carries[0] ? 0 : 1];
    each_parted(c, [&](const auto& parts, double heat, double T) {
        if (!entropy) return;
        for (const auto& [form, part] : parts)
            for (const auto& [other, share] : parts)
                if (const std::int64_t at =
                        pattern_->position(warmth_.balance[form], warmth_.temperature[other]);
                    at >= 0)
                    values[at] += part * share * heat / (T * T);
    });
    for (int A = 0; A < contact_->n(); ++A) {
        if (!passages_[A].active) continue;
        const Flow f = flow(A, c, true);
        if (!(f.area > 0)) continue;
        const std::vector<int> multipliers = contact_->multipliers(A);
        const Eigen::Index k = f.share.size();
        auto add = [&](int row, int column, double value) {
            const std::int64_t at = pattern_->position(row, column);
            if (at >= 0) values[at] += value;
        };
        each_warm(A, [&](int v, int form, int side) {
            const double by = warmth_.entropy[side] ? 1 / f.theta[side] : 1;
            Eigen::RowVectorXd g = f.share[v] * by * f.heat_by[side];
            g.head(3 * k) += by * f.heat[side] * f.share_by.row(v);
            if (warmth_.entropy[side]) g -= f.share[v] * f.heat[side] * by * by * f.theta_by[side];
            g *= -skin.weight[form];
            const int row = warmth_.balance[form];
            skin.each_form(contact_->gaps().stencil(A), [&](int w, int l) {
                for (int i = 0; i < skin.dim; ++i)
                    add(row, skin.unknown[l] + i, skin.weight[l] * g[3 * w + i]);
            });
            each_warm(A, [&](int w, int l, int other) {
                const double rise = warmth_.entropy[other] ? 1 : c.step.theta;
                add(row, warmth_.temperature[l], rise * skin.weight[l] * g[3 * k + w]);
            });
            for (std::size_t m = 0; m < multipliers.size(); ++m)
                add(row, multipliers[m], g[4 * k + contact_->multiplier_place(m)]);
        });
    }
}

void ContactHeat::ledger(const Context& c, const double*, LedgerSums& sums) {
    evaluate(c, false, false);
    if (!c.backwards) conducted_.assign(contact_->n(), 0.0);
    each_parted(c, [&](const auto& parts, double heat, double) {
        if (!parts.empty()) sums.work[work_account] += c.step.h * heat;
    });
    for (int A = 0; A < contact_->n(); ++A) {
        if (!passages_[A].active) continue;
        const Flow f = flow(A, c, false);
        if (!(f.area > 0)) continue;
        if (!c.backwards) conducted_[A] = f.heat[0];
        for (int side = 0; side < 2; ++side)
            if (warmth_.carries[side]) sums.work[work_account] += c.step.h * f.heat[side];
    }
}

}  // namespace visviva
