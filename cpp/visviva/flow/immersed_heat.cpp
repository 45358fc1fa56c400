#include "visviva/flow/immersed_heat.hpp"

namespace visviva {

void ImmersedHeat::couple(Pattern& pattern) const {
    for (int k = 0; k < body_->n(); ++k) {
        if (warmth_.conductance[k] == 0) continue;
        const int own = warmth_.balance[k], warm = warmth_.temperature[k];
        pattern.couple(own, warm), pattern.couple(warm, own);
        for (int u : body_->coupled(k)) {
            const int T = warmth_.of_velocity(u);
            pattern.couple(own, T), pattern.couple(T, own);
            pattern.couple(warm, T), pattern.couple(T, warm);
            for (int w : body_->coupled(k)) pattern.couple(T, warmth_.of_velocity(w));
        }
    }
}

// f(point, temperatures of fluid and body) of points that the fluid holds.
template <class F>
void ImmersedHeat::each(const Context& c, F f) const {
    auto middle = [&](int u) { return c.vectors.x0[u] + c.step.theta * (c.vectors.x1[u] - c.vectors.x0[u]); };
    for (int k = 0; k < body_->n(); ++k) {
        if (warmth_.conductance[k] == 0 || !body_->holds(k)) continue;
        double around = 0;
        body_->each_weight(k, [&](int u, double w) { around += w * middle(warmth_.of_velocity(u)); });
        const int warm = warmth_.temperature[k];
        f(k, around, warmth_.entropy ? c.vectors.x1[warm] : middle(warm));
    }
}

void ImmersedHeat::residual(const Context& c, double* r) {
    each(c, [&](int k, double around, double own) {
        const double heat = warmth_.conductance[k] * (around - own);
        r[warmth_.balance[k]] -= warmth_.entropy ? heat / own : heat;
        body_->each_weight(k, [&](int u, double w) { r[warmth_.of_velocity(u)] += w * heat; });
    });
}

void ImmersedHeat::tangent(const Context& c, double* values) {
    auto add = [&](int row, int column, double value) {
        const std::int64_t at = pattern_->position(row, column);
        if (at >= 0) values[at] += value;
    };
    each(c, [&](int k, double around, double own) {
        const double h = warmth_.conductance[k], t = c.step.theta;
        const double by = warmth_.entropy ? 1 / own : 1, rise = warmth_.entropy ? 1 : t;
        const int row = warmth_.balance[k], warm = warmth_.temperature[k];
        add(row, warm, h * by * rise + (warmth_.entropy ? h * (around - own) * by * by : 0));
        body_->each_weight(k, [&](int u, double w) {
            const int T = warmth_.of_velocity(u);
            add(row, T, -h * by * t * w), add(T, warm, -h * w * rise);
            body_->each_weight(
                k, [&](int v, double other) { add(T, warmth_.of_velocity(v), h * t * w * other); });
        });
    });
}

}  // namespace visviva
