#include "visviva/linear/reduce/slave_elimination.hpp"

#include <algorithm>

namespace visviva {

SlaveElimination::SlaveElimination(std::vector<Dependence> dependences)
    : Reduction(", tied nodes eliminated", ""), dependences_(std::move(dependences)) {}

void SlaveElimination::analyze(const Csr& full, const std::vector<char>& fixed,
                               const std::vector<int>& node) {
    *this = SlaveElimination(std::move(dependences_));  // nothing of an earlier pattern stays
    full_ = &full, own_.assign(full.n, 0.0);
    choose(fixed, node);
    std::vector<char> gone(full.n, 0);
    for (const Given& g : given_) gone[g.equation] = gone[g.multiplier] = 1;
    number_left(full, gone);
    expand();
    find_pattern();
}

// Patterns couple nodes, whether their entries vanish or not.
void SlaveElimination::choose(const std::vector<char>& fixed, const std::vector<int>& node) {
    enum : char { none, depends, supports };
    const Csr& f = *full_;
    std::vector<char> listed(fixed.size(), 0);
    for (const Dependence& d : dependences_) listed[d.unknown] = 1;
    std::vector<char> role(f.n, none);
    for (const Dependence& d : dependences_) {
        if (fixed[d.unknown]) continue;
        const int unknown = f.equation[d.unknown], multiplier = f.equation[d.multiplier];
        if (unknown < 0 || role[unknown] != none) continue;
        const int begin = static_cast<int>(links_.size());
        bool chained = false;
        for (auto e = f.row[multiplier]; e < f.row[multiplier + 1]; ++e) {
            const int other = f.col[e];
            const int u = f.unknown[other];
            if (other == unknown || other == multiplier || fixed[u]) continue;
            if (listed[u] && node[u] == node[d.unknown]) continue;  // zero, the node's pattern alone
            chained = chained || role[other] == depends;
            links_.push_back({other, e, place_of(f, other, multiplier), 0, 0});
        }
        if (chained) {
            links_.resize(begin);
            continue;
        }
        role[unknown] = depends;
        for (std::size_t k = begin; k < links_.size(); ++k) role[links_[k].other] = supports;
        given_.push_back({unknown, multiplier, place_of(f, multiplier, unknown),
                          place_of(f, unknown, multiplier), begin, static_cast<int>(links_.size())});
    }
}

// The transformation T and its transpose.
void SlaveElimination::expand() {
    const Csr& f = *full_;
    parts_.resize(f.n), feeds_.resize(left_.n), plain_.assign(left_.n, 1);
    for (int i = 0; i < f.n; ++i)
        if (kept_[i] >= 0) parts_[i] = {{kept_[i], -1}}, feeds_[kept_[i]] = {{i, -1}};
    std::vector<char> is_given(f.n, 0);
    for (const Given& g : given_) {
        is_given[g.equation] = 1;
        for (int k = g.begin; k < g.end; ++k) {
            const int other = kept_[links_[k].other];
            parts_[g.equation].push_back({other, k});
            feeds_[other].push_back({g.equation, k});
            plain_[other] = 0;
        }
    }
    for (int i = 0; i < f.n; ++i) {
        const bool touched = std::any_of(f.col.begin() + f.row[i], f.col.begin() + f.row[i + 1],
                                         [&](int j) { return is_given[j]; });
        if (!touched) continue;
        touched_.push_back(i);
        if (kept_[i] >= 0) plain_[kept_[i]] = 0;
    }
}

void SlaveElimination::make_rows(std::vector<int>& seen) {
    const Csr& f = *full_;
    row_of_.assign(f.n, -1);
    for (int k = 0; k < left_.n; ++k)
        for (const Part& feed : feeds_[k]) {
            const int i = feed.equation;
            if (plain_[k] || row_of_[i] >= 0) continue;
            row_of_[i] = static_cast<int>(rows_.size());
            Row row{i, {}, {}};
            for (auto e = f.row[i]; e < f.row[i + 1]; ++e)
                for (const Part& p : parts_[f.col[e]])
                    if (seen[p.equation] != i) seen[p.equation] = i, row.col.push_back(p.equation);
            row.value.resize(row.col.size());
            rows_.push_back(std::move(row));
        }
}

void SlaveElimination::find_pattern() {
    const Csr& f = *full_;
    left_.row.assign(1, 0);
    std::vector<int> seen(left_.n, -1), cols;
    make_rows(seen);
    std::fill(seen.begin(), seen.end(), -1);
    for (int k = 0; k < left_.n; ++k) {
        cols.clear();
        if (plain_[k]) {
            const int i = feeds_[k][0].equation;
            for (auto e = f.row[i]; e < f.row[i + 1]; ++e)
                if (kept_[f.col[e]] >= 0) cols.push_back(kept_[f.col[e]]);
        } else {
            for (const Part& feed : feeds_[k])
                for (int col : rows_[row_of_[feed.equation]].col)
                    if (seen[col] != k) seen[col] = k, cols.push_back(col);
        }
        std::sort(cols.begin(), cols.end());
        left_.col.insert(left_.col.end(), cols.begin(), cols.end());
        left_.row.push_back(static_cast<std::int64_t>(left_.col.size()));
    }
    values_.resize(left_.col.size()), place_.assign(left_.n, -1);
}

void SlaveElimination::read_factors() {
    for (const Given& g : given_)
        for (int k = g.begin; k < g.end; ++k) {
            links_[k].moves = -full_values_[links_[k].row] / full_values_[g.row];
            links_[k].loads = -full_values_[links_[k].col] / full_values_[g.col];
        }
}

void SlaveElimination::multiply(Row& row) {
    const Csr& f = *full_;
    for (std::size_t k = 0; k < row.col.size(); ++k) place_[row.col[k]] = static_cast<std::int64_t>(k);
    std::fill(row.value.begin(), row.value.end(), 0.0);
    for (auto e = f.row[row.equation]; e < f.row[row.equation + 1]; ++e)
        for (const Part& p : parts_[f.col[e]]) row.value[place_[p.equation]] += moves(p) * full_values_[e];
}

bool SlaveElimination::reduce(const double* values) {
    const Csr& f = *full_;
    full_values_ = values;
    read_factors();
    for (Row& row : rows_) multiply(row);
    double* to = values_.data();
    for (int k = 0; k < left_.n; ++k, to = values_.data() + left_.row[k]) {
        if (plain_[k]) {
            const int i = feeds_[k][0].equation;
            for (auto e = f.row[i]; e < f.row[i + 1]; ++e)
                if (kept_[f.col[e]] >= 0) *to++ = values[e];
            continue;
        }
        std::fill(to, values_.data() + left_.row[k + 1], 0.0);
        for (auto e = left_.row[k]; e < left_.row[k + 1]; ++e) place_[left_.col[e]] = e;
        for (const Part& feed : feeds_[k]) {
            const Row& row = rows_[row_of_[feed.equation]];
            for (std::size_t c = 0; c < row.col.size(); ++c)
                values_[place_[row.col[c]]] += loads(feed) * row.value[c];
        }
    }
    return true;
}

double SlaveElimination::along(int row, const std::vector<double>& d) const {
    double sum = 0;
    for (auto e = full_->row[row]; e < full_->row[row + 1]; ++e) sum += full_values_[e] * d[full_->col[e]];
    return sum;
}

// With dx = T dx_left + own: r_left = L^T (r + K own)
void SlaveElimination::condense(std::vector<double>& r) {
    const Csr& f = *full_;
    for (const Given& g : given_) own_[g.equation] = -r[f.unknown[g.multiplier]] / full_values_[g.row];
    for (int i : touched_) r[f.unknown[i]] += along(i, own_);
    for (const Given& g : given_)
        for (int k = g.begin; k < g.end; ++k)
            r[f.unknown[links_[k].other]] += links_[k].loads * r[f.unknown[g.equation]];
}

void SlaveElimination::recover(const double* r, double* d) const {
    const Csr& f = *full_;
    for (const Given& g : given_) {
        double sum = own_[g.equation];
        for (int k = g.begin; k < g.end; ++k) sum += links_[k].moves * d[f.unknown[links_[k].other]];
        d[f.unknown[g.equation]] = sum;
        d[f.unknown[g.multiplier]] = 0;
    }
    std::vector<double> lambda(given_.size());
    for (std::size_t k = 0; k < given_.size(); ++k) {
        const int i = given_[k].equation;
        double sum = r[f.unknown[i]];
        for (auto e = f.row[i]; e < f.row[i + 1]; ++e) sum += full_values_[e] * d[f.unknown[f.col[e]]];
        lambda[k] = -sum / full_values_[given_[k].col];
    }
    for (std::size_t k = 0; k < given_.size(); ++k) d[f.unknown[given_[k].multiplier]] = lambda[k];
}

}  // namespace visviva
