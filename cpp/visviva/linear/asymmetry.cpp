#include "visviva/linear/asymmetry.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace visviva {

namespace {

// Part of the largest entry: what cancels may leave less, whose inverse overflows.
constexpr double vanishing = 1e-60;

struct Rows {
    std::span<const std::int64_t> row;
    std::span<const int> col;
    std::span<const double> value;

    int n() const { return static_cast<int>(row.size()) - 1; }
    double at(int i, int j) const {
        const auto begin = col.begin() + row[i], end = col.begin() + row[i + 1];
        const auto found = std::lower_bound(begin, end, j);
        return found != end && *found == j ? value[found - col.begin()] : 0.0;
    }
};

std::vector<double> factors(const Rows& a) {
    double greatest = 0;
    for (const double value : a.value) greatest = std::max(greatest, std::abs(value));
    auto size = [&](double value) { return std::abs(value) > vanishing * greatest ? std::abs(value) : 0.0; };
    std::vector<double> scale(a.n(), 0.0), largest(a.n());
    for (int i = 0; i < a.n(); ++i)
        if (const double diagonal = size(a.at(i, i)); diagonal > 0) scale[i] = 1 / std::sqrt(diagonal);
    for (int round = 0; round < 5; ++round) {
        for (int i = 0; i < a.n(); ++i) {
            largest[i] = 0;
            for (auto k = a.row[i]; k < a.row[i + 1]; ++k)
                largest[i] = std::max(largest[i],
                                      size(a.value[k]) * scale[a.col[k]] * (scale[i] > 0 ? scale[i] : 1.0));
        }
        for (int i = 0; i < a.n(); ++i)
            if (largest[i] > 0 && scale[i] == 0)
                scale[i] = 1 / largest[i];
            else if (largest[i] > 1)
                scale[i] /= std::sqrt(largest[i]);
    }
    return scale;
}

}  // namespace

Asymmetry asymmetry(std::span<const std::int64_t> row, std::span<const int> col,
                    std::span<const double> value) {
    const Rows a{row, col, value};
    const std::vector<double> scale = factors(a);
    Asymmetry found;
    for (int i = 0; i < a.n(); ++i)
        for (auto k = row[i]; k < row[i + 1]; ++k) {
            const double lack = std::abs(value[k] - a.at(col[k], i)) * scale[i] * scale[col[k]];
            if (lack > found.size) found = {lack, i};
        }
    return found;
}

}  // namespace visviva
