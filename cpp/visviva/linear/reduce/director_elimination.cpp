#include "visviva/linear/reduce/director_elimination.hpp"

#include <algorithm>
#include <cmath>

namespace visviva {

DirectorElimination::DirectorElimination(std::vector<HeldLength> lengths)
    : Reduction(", directors on their spheres", "a multiplier does not act on its director"),
      lengths_(std::move(lengths)) {}

void DirectorElimination::analyze(const Csr& full, const std::vector<char>& fixed,
                                  const std::vector<int>& node) {
    *this = DirectorElimination(std::move(lengths_));  // nothing of an earlier pattern stays
    full_ = &full;
    owner_.assign(full.n, -1), component_.assign(full.n, 0), gone_.assign(full.n, 0);
    own_.assign(full.n, 0.0);
    for (const HeldLength& length : lengths_)
        if (acts_on_node(length, node)) choose(length, fixed);
    number_left(full, gone_);
    find_pattern();
    find_places();
}

// Patterns couple whole nodes, and what is given by other nodes has taken its multiplier's row there.
bool DirectorElimination::acts_on_node(const HeldLength& length, const std::vector<int>& node) const {
    const int multiplier = full_->equation[length.multiplier];
    if (multiplier < 0) return false;
    return std::all_of(full_->col.begin() + full_->row[multiplier],
                       full_->col.begin() + full_->row[multiplier + 1], [&](int j) {
                           return j == multiplier || node[full_->unknown[j]] == node[length.unknown] ||
                                  node[full_->unknown[j]] == node[length.multiplier];
                       });
}

void DirectorElimination::choose(const HeldLength& length, const std::vector<char>& fixed) {
    Director d{};
    d.multiplier = full_->equation[length.multiplier];
    for (int c = 0; c < 3; ++c) {
        const int u = length.unknown + c, equation = full_->equation[u];
        if (!fixed[u] && equation < 0) return;  // it left before
        if (!fixed[u]) d.equation[d.n++] = equation;
    }
    if (fixed[length.multiplier] || d.n == 0) return;
    if (!alike(d.equation[0], d.equation[d.n / 2]) || !alike(d.equation[0], d.equation[d.n - 1])) return;
    for (int c = 0; c < d.n; ++c) {
        const int i = d.equation[c];
        d.row[c] = place_of(*full_, d.multiplier, i), d.col[c] = place_of(*full_, i, d.multiplier);
        owner_[i] = n(), component_[i] = c;
    }
    gone_[d.equation[d.n - 1]] = gone_[d.multiplier] = 1;
    directors_.push_back(d);
}

bool DirectorElimination::alike(int i, int j) const {
    const auto col = full_->col.begin();
    return std::equal(col + full_->row[i], col + full_->row[i + 1], col + full_->row[j],
                      col + full_->row[j + 1]);
}

// Rows of a director's components all have the pattern of any of them, but for its multiplier, which leaves.
void DirectorElimination::find_pattern() {
    const Csr& f = *full_;
    left_.row.assign(1, 0);
    for (int i = 0; i < f.n; ++i) {
        if (kept_[i] < 0) continue;
        for (auto e = f.row[i]; e < f.row[i + 1]; ++e)
            if (kept_[f.col[e]] >= 0) left_.col.push_back(kept_[f.col[e]]);
        left_.row.push_back(static_cast<std::int64_t>(left_.col.size()));
    }
    values_.assign(left_.col.size(), 0.0);
}

void DirectorElimination::find_places() {
    const Csr& f = *full_;
    place_.assign(f.col.size(), -1);
    std::vector<int> first(directors_.size());
    std::int64_t widest = 0;
    for (int i = 0; i < f.n; ++i) {
        if (kept_[i] < 0 && owner_[i] < 0) continue;  // a multiplier that has left
        bool touched = false;
        int next = 0;
        for (auto e = f.row[i]; e < f.row[i + 1]; ++e) {
            const int j = f.col[e], owner = owner_[j];
            if (owner >= 0 && component_[j] == 0) first[owner] = next;
            if (owner >= 0) touched = true, place_[e] = first[owner];
            if (kept_[j] < 0) continue;
            if (owner < 0) place_[e] = next;
            ++next;
        }
        if (touched) touched_.push_back(i);
        widest = std::max<std::int64_t>(widest, next);
    }
    sum_.assign(widest + 1, 0.0);
}

namespace {

// The plane normal to a vector of n components: columns of Householder's reflection that turns it onto the
// last axis, whose sign is that of `side`, so that planes of neighbouring vectors have neighbouring bases.
template <class Plane>
bool span(Plane& p, int n, double side) {
    p.squared = 0;
    for (int c = 0; c < n; ++c) p.squared += p.normal[c] * p.normal[c];
    const double length = std::copysign(std::sqrt(p.squared), side);
    double u[3] = {}, uu = 0;
    for (int c = 0; c < n; ++c) {
        u[c] = p.normal[c] + (c == n - 1 ? length : 0.0);
        uu += u[c] * u[c];
    }
    for (int c = 0; c < n; ++c)
        for (int k = 0; k + 1 < n; ++k) p.basis[c][k] = (c == k ? 1.0 : 0.0) - 2 * u[c] * u[k] / uu;
    return std::isfinite(p.squared) && p.squared > 0 && uu > 0;
}

}  // namespace

bool DirectorElimination::read_planes() {
    for (Director& d : directors_) {
        for (int c = 0; c < d.n; ++c)
            d.moves.normal[c] = full_values_[d.row[c]], d.loads.normal[c] = full_values_[d.col[c]];
        const double side = d.moves.normal[d.n - 1];
        if (!span(d.moves, d.n, side) || !span(d.loads, d.n, side))
            return fail_at(full_->unknown[d.multiplier]);
    }
    return true;
}

// The row times T, to row `at` of what is left and, for a director's, the ones after it, by its loads.
void DirectorElimination::add_row(int i, int at, const double* loads) {
    const Csr& f = *full_;
    const auto width = left_.row[at + 1] - left_.row[at];
    std::fill(sum_.begin(), sum_.begin() + width, 0.0);
    for (auto e = f.row[i]; e < f.row[i + 1]; ++e) {
        if (place_[e] < 0) continue;
        const int j = f.col[e];
        double* to = sum_.data() + place_[e];
        if (owner_[j] < 0) {
            *to += full_values_[e];
            continue;
        }
        const Director& d = directors_[owner_[j]];
        const double* basis = d.moves.basis[component_[j]];
        for (int k = 0; k + 1 < d.n; ++k) to[k] += basis[k] * full_values_[e];
    }
    const int n_rows = owner_[i] < 0 ? 1 : directors_[owner_[i]].n - 1;
    for (int k = 0; k < n_rows; ++k) {
        double* to = values_.data() + left_.row[at + k];
        for (std::int64_t c = 0; c < width; ++c) to[c] += loads[k] * sum_[c];
    }
}

bool DirectorElimination::reduce(const double* values) {
    full_values_ = values;
    message_.clear();
    if (!read_planes()) return false;
    std::fill(values_.begin(), values_.end(), 0.0);
    const double one = 1;
    for (int i = 0; i < full_->n; ++i) {
        if (owner_[i] >= 0) {
            const Director& d = directors_[owner_[i]];
            if (d.n > 1) add_row(i, kept_[d.equation[0]], d.loads.basis[component_[i]]);
        } else if (kept_[i] >= 0) {
            add_row(i, kept_[i], &one);
        }
    }
    return true;
}

double DirectorElimination::along(int row, const std::vector<double>& d) const {
    double sum = 0;
    for (auto e = full_->row[row]; e < full_->row[row + 1]; ++e) sum += full_values_[e] * d[full_->col[e]];
    return sum;
}

// With dx = T dx_left + own: r_left = L^T (r + K own)
void DirectorElimination::condense(std::vector<double>& r) {
    const Csr& f = *full_;
    for (Director& d : directors_) {
        d.own = -r[f.unknown[d.multiplier]] / d.moves.squared;
        for (int c = 0; c < d.n; ++c) own_[d.equation[c]] = d.own * d.moves.normal[c];
    }
    for (int i : touched_) r[f.unknown[i]] += along(i, own_);
    for (const Director& d : directors_) {
        double left[2] = {0, 0};
        for (int c = 0; c < d.n; ++c)
            for (int k = 0; k + 1 < d.n; ++k) left[k] += d.loads.basis[c][k] * r[f.unknown[d.equation[c]]];
        for (int k = 0; k + 1 < d.n; ++k) r[f.unknown[d.equation[k]]] = left[k];
    }
}

void DirectorElimination::recover(const double* r, double* d) const {
    const Csr& f = *full_;
    std::vector<double> x(f.n);
    for (const Director& v : directors_) {
        double left[2] = {0, 0};
        for (int k = 0; k + 1 < v.n; ++k) left[k] = d[f.unknown[v.equation[k]]];
        for (int c = 0; c < v.n; ++c) {
            double& to = d[f.unknown[v.equation[c]]];
            to = v.own * v.moves.normal[c];
            for (int k = 0; k + 1 < v.n; ++k) to += v.moves.basis[c][k] * left[k];
        }
        d[f.unknown[v.multiplier]] = 0;
    }
    for (int i = 0; i < f.n; ++i) x[i] = d[f.unknown[i]];
    for (const Director& v : directors_) {
        double force = 0;
        for (int c = 0; c < v.n; ++c)
            force += v.loads.normal[c] * (r[f.unknown[v.equation[c]]] + along(v.equation[c], x));
        d[f.unknown[v.multiplier]] = -force / v.loads.squared;
    }
}

}  // namespace visviva
