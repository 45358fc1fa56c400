// By what violations of constraints are weighed.
#include <algorithm>
#include <cmath>

#include "visviva/base/vector_dispatch.hpp"
#include "visviva/system/system.hpp"

namespace visviva {

// From the tangent's rows of constraints: by what their violation is weighed to compare with relative
// increments, and the relative increment that rounding of the configuration alone can cause.
void System::weigh_constraints() {
    noise_ = 2e-15;
    std::fill(constraint_weight_.begin(), constraint_weight_.end(), 0.0);
    for (int i = 0; i < csr_.n; ++i) {
        const int row = csr_.unknown[i];
        if (!blocks_.multiplier[row]) continue;
        double sum = 0, largest = 0, smallest = 1e300, rounding = 0;
        auto each = [&](auto f) {
            for (auto k = csr_.row[i]; k < csr_.row[i + 1]; ++k) {
                const int u = csr_.unknown[csr_.col[k]];
                if (inverse_scale_[u] > 0) f(std::abs(values_[k]), u);
            }
        };
        each([&](double g, int u) {
            sum += g / inverse_scale_[u];
            largest = std::max(largest, g / inverse_scale_[u]);
            rounding += g * std::abs(x1_[u]);
        });
        each([&](double g, int u) {
            if (g / inverse_scale_[u] > 1e-4 * largest) smallest = std::min(smallest, g / inverse_scale_[u]);
        });
        if (sum == 0) continue;
        constraint_weight_[row] = sum;
        noise_ = std::max(noise_, 4.4e-16 * (rounding + 1e-3 * sum) / smallest);
    }
    const auto& constrains = blocks_.multiplier;
    if (std::find(constrains.begin(), constrains.end(), 1) != constrains.end()) total(constraint_weight_);
    for (double& weight : constraint_weight_)
        if (weight > 0) weight = 1 / weight;
    noise_ = std::min(largest(noise_), 5e-13);
}

// Largest violation of a constraint at the last evaluation, relative like increments.
double System::constraint_error() const {
    return vector_kernels().largest(n_, r_.data(), constraint_weight_.data());
}

int System::worst_constraint() const {
    int worst = 0;
    for (int i = 0; i < n_; ++i)
        if (std::abs(r_[i]) * constraint_weight_[i] > std::abs(r_[worst]) * constraint_weight_[worst])
            worst = i;
    return worst;
}

}  // namespace visviva
