#include "visviva/system/monotone.hpp"

#include <iterator>

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
            rests_[u] = dx[u] < -rounding;
            if (rests_[u]) changed_ = true, ++returns_[u];
            dx[u] = 0, moved = true;
        } else if (rests_[u] && dx[u] != 0) {
            dx[u] = 0, moved = true;
        }
    }
    if (changed_) advances_ = 0;
    return moved;
}

bool Monotone::is_pressed(int u, const double* r, const double* diagonal) const {
    return rests_[u] && !halted_[u] && -r[u] > rounding * std::max(diagonal[u], 0.0);
}

void Monotone::release(const double* r, const double* diagonal, const Csr& csr, const Total& total) {
    std::vector<char> freed(rests_.size(), 0);
    int worst = -1, n = 0;
    double largest = 0;
    for (int u : unknowns_) {
        if (!is_pressed(u, r, diagonal)) continue;
        if (returns_[u] < patience) freed[u] = 1, ++n;
        if (-r[u] > largest * diagonal[u]) largest = diagonal[u] > 0 ? -r[u] / diagonal[u] : 1e300, worst = u;
    }
    if (n == 0 && worst >= 0) freed[worst] = 1, ++n;
    if (n == 0) return;
    for (int u : unknowns_)
        if (freed[u]) rests_[u] = 0;
    const int layers = advances_ < waits ? 0 : 1 << std::min(advances_ - waits, 20);
    for (int layer = 0; layer < layers && spread(freed, csr, total); ++layer);
    changed_ = true, ++advances_;
}

// A front that went too far comes back by itself: what would shrink comes to rest again.
bool Monotone::spread(std::vector<char>& freed, const Csr& csr, const Total& total) {
    std::vector<double> reached(rests_.size(), 0.0);
    for (int i = 0; i < csr.n; ++i)
        if (freed[csr.unknown[i]])
            for (auto k = csr.row[i]; k < csr.row[i + 1]; ++k) reached[csr.unknown[csr.col[k]]] = 1;
    total(reached);
    bool any = false;
    for (int u : unknowns_) {
        const bool follows = rests_[u] && !halted_[u] && returns_[u] < doubt && reached[u] > 0;
        freed[u] = follows;
        if (follows) rests_[u] = 0, any = true;
    }
    return any;
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

std::vector<int> Monotone::resting() const {
    std::vector<int> found;
    std::copy_if(unknowns_.begin(), unknowns_.end(), std::back_inserter(found),
                 [&](int u) { return rests_[u] != 0; });
    return found;
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
