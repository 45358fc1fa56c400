#include "visviva/contact/tie_term.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

template <class F>
void TieTerm::each(F f) const {
    for (int k = 0; k < rows_.n(); ++k)
        for (int i = 0; i < rows_.dim; ++i)
            if (const int m = rows_.multiplier[k * rows_.dim + i]; m >= 0)
                f(k * rows_.dim + i, m, rows_.first[k], rows_.first[k + 1], i);
}

double TieTerm::value(const double* x, int begin, int end, int i) const {
    double sum = 0;
    for (int e = begin; e < end; ++e) sum += rows_.weight[e] * x[rows_.unknown[e] + i];
    return sum;
}

void TieTerm::list_entries(std::vector<std::pair<int, int>>& entries) const {
    each([&](int, int m, int begin, int end, int i) {
        for (int e = begin; e < end; ++e) {
            const int u = rows_.unknown[e] + i;
            entries.emplace_back(m, u), entries.emplace_back(u, m);
        }
    });
}

void TieTerm::set_positions(const std::vector<std::int64_t>& positions) { position_ = positions; }

void TieTerm::begin(const double* x0) {
    each([&](int k, int, int begin, int end, int i) { x0_[k] = value(x0, begin, end, i); });
}

void TieTerm::residual(const Context& c, double* r) {
    const double* x = c.vectors.x1;
    each([&](int, int m, int begin, int end, int i) {
        r[m] += value(x, begin, end, i);
        for (int e = begin; e < end; ++e) r[rows_.unknown[e] + i] += rows_.weight[e] * x[m];
    });
}

void TieTerm::tangent(const Context&, double* values) {
    std::size_t at = 0;
    each([&](int, int, int begin, int end, int) {
        for (int e = begin; e < end; ++e)
            for (int side = 0; side < 2; ++side) values[position_[at++]] += rows_.weight[e];
    });
}

void TieTerm::ledger(const Context& c, const double* v1, LedgerSums& sums) {
    double* defect = &sums.defect[2 * static_cast<std::size_t>(component[0])];
    each([&](int k, int m, int begin, int end, int i) {
        const double x1 = value(c.vectors.x1, begin, end, i);
        sums.work[account[0]] -= c.vectors.x1[m] * (x1 - x0_[k]);
        defect[0] = std::max(defect[0], std::abs(x1));
        defect[1] = std::max(defect[1], std::abs(value(v1, begin, end, i)));
        x0_[k] = x1;
    });
}

}  // namespace visviva
