#include "visviva/system/monotone.hpp"

#include <algorithm>

namespace visviva {

void Monotone::set(std::vector<int> unknowns) {
    unknowns_ = std::move(unknowns);
    for (int u : unknowns_) rests_[u] = 1;
    accept();
}

void Monotone::halt(const std::vector<char>& halted, const double* dx) {
    halts_ = !halted.empty();
    halts_ ? (void)(halted_ = halted) : std::fill(halted_.begin(), halted_.end(), 0);
    for (int u : unknowns_)
        if (!halted_[u]) rests_[u] = dx[u] <= 0;
    begin_step();
}

bool Monotone::project(double* dx) {
    bool moved = false;
    changed_ = false;
    for (int u : unknowns_) {
        if (halted_[u]) continue;
        if (!rests_[u] && dx[u] < 0) {
            changed_ |= dx[u] < -rounding;
            rests_[u] = dx[u] < -rounding;
            dx[u] = 0, moved = true;
        } else if (rests_[u] && dx[u] != 0) {
            dx[u] = 0, moved = true;
        }
    }
    return moved;
}

void Monotone::release(const double* r, const double* diagonal) {
    int worst = -1;
    double largest = 0;
    const bool all = changes_ < patience;
    for (int u : unknowns_) {
        if (!rests_[u] || halted_[u] || !(-r[u] > rounding * std::max(diagonal[u], 0.0))) continue;
        if (all) rests_[u] = 0, changed_ = true;
        if (-r[u] > largest * diagonal[u]) largest = diagonal[u] > 0 ? -r[u] / diagonal[u] : 1e300, worst = u;
    }
    if (!all && worst >= 0) rests_[worst] = 0, changed_ = true;
    changes_ += changed_;
}

void Monotone::mask(const Csr& csr, double* values) const {
    if (!acts()) return;
    for (int i = 0; i < csr.n; ++i) {
        const int u = csr.unknown[i];
        for (auto k = csr.row[i]; k < csr.row[i + 1]; ++k) {
            const int v = csr.unknown[csr.col[k]];
            if (halted_[u] != halted_[v] || (u != v && (rests_[u] || rests_[v])))
                values[k] = 0;
            else if (u == v && rests_[u])
                values[k] = 1;
        }
    }
}

void Monotone::clear(double* r) const {
    if (!acts()) return;
    for (std::size_t u = 0; u < rests_.size(); ++u)
        if (rests_[u] || halted_[u]) r[u] = 0;
}

void Monotone::clip(double* dx) const {
    for (int u : unknowns_) dx[u] = rests_[u] ? 0.0 : std::max(dx[u], 0.0);
}

std::vector<double> Monotone::flags() const {
    std::vector<double> flags;
    for (int u : unknowns_) flags.push_back(rests_[u]);
    return flags;
}

void Monotone::set_flags(const std::vector<double>& flags) {
    for (std::size_t k = 0; k < unknowns_.size() && k < flags.size(); ++k)
        rests_[unknowns_[k]] = flags[k] != 0;
    accept();
}

}  // namespace visviva
