#include "visviva/point/assumed_term.hpp"

#include <algorithm>

namespace visviva {

AssumedTerm::AssumedTerm(const AssumedData& d)
    : slots_(d.index, d.n, d.n_slots, d.n_slots),
      products_(d.products),
      couples_(static_cast<std::size_t>(d.n_strains) * d.n_strains),
      weights_(d.weights, d.weights + static_cast<std::ptrdiff_t>(d.n_samples) * d.n_slots) {
    for (int p = 0; p < d.n_samples; ++p) {
        AssumedRange range{d.n_slots, 0};
        for (int a = 0; a < d.n_slots; ++a)
            if (weights_[p * d.n_slots + a] != 0) range = {std::min(range.begin, a), a + 1};
        seen_.push_back(range);
    }
    touched_.assign(d.n_strains, {d.n_slots, 0});
    for (const AssumedProduct& q : products_)
        for (int p : {q.left, q.right}) {
            AssumedRange& range = touched_[q.strain];
            range = {std::min(range.begin, seen_[p].begin), std::max(range.end, seen_[p].end)};
        }
    const int packed = d.n_strains * (d.n_strains + 1) / 2;
    for (int e = 0; e < d.n; ++e)
        for (int a = 0, at = 0; a < d.n_strains; ++a)
            for (int b = a; b < d.n_strains; ++b, ++at)
                if (d.stiffness[static_cast<std::size_t>(e) * packed + at] != 0)
                    couples_[a * d.n_strains + b] = couples_[b * d.n_strains + a] = 1;
    in_lanes(stiffness_, d.stiffness, packed, d.n);
    in_lanes(reference_, d.reference, d.n_strains, d.n);
    out_.assign(static_cast<std::size_t>(slots_.n_blocks()) * slot_lanes, 0.0);
    AssumedView& v = view_;
    v.n = d.n, v.n_blocks = slots_.n_blocks(), v.n_slots = d.n_slots, v.n_samples = d.n_samples;
    v.n_strains = d.n_strains, v.n_products = static_cast<int>(products_.size());
    v.index = slots_.index(), v.weights = weights_.data(), v.seen = seen_.data();
    v.touched = touched_.data(), v.product = products_.data(), v.couples = couples_.data();
    v.stiffness = stiffness_.data(), v.reference = reference_.data();
}

void AssumedTerm::connect(const Pattern& pattern) {
    slots_.connect(pattern);
    view_.row = slots_.row(), view_.length = slots_.length(), view_.offset = slots_.offset();
}

void AssumedTerm::residual(const Context& c, double* r) {
    slots_.for_tasks(
        [&](int begin, int end) { assumed_kernels().residual(view_, c.step, c.vectors, begin, end, r); });
}

void AssumedTerm::linearise(const Context& c, double* r, double* values) {
    slots_.assemble(values, [&](int begin, int end) {
        assumed_kernels().tangent(view_, c.step, c.vectors, begin, end, r, values);
    });
}

void AssumedTerm::ledger(const Context& c, const double*, LedgerSums& sums) {
    slots_.for_tasks(
        [&](int begin, int end) { assumed_kernels().energy(view_, c.vectors.x1, begin, end, out_.data()); });
    for (int e = 0; e < view_.n; ++e) sums.energy[energy_account] += out_[e];
}

}  // namespace visviva
