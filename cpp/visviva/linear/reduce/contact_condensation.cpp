#include "visviva/linear/reduce/contact_condensation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace visviva {

using Eigen::VectorXd;

ContactCondensation::ContactCondensation(std::vector<NodalMultiplier> multipliers)
    : Reduction(", pressures condensed", "a contact pressure has no force on its own node"),
      multipliers_(std::move(multipliers)) {}

void ContactCondensation::analyze(const Csr& full, const std::vector<char>& fixed, const std::vector<int>&) {
    *this = ContactCondensation(std::move(multipliers_));  // nothing of an earlier pattern stays
    full_ = &full, owner_.assign(full.n, -1), gone_.assign(full.n, 0);
    choose(fixed);
    number_left(full, gone_);
    find_forces();
    find_pattern();
}

void ContactCondensation::choose(const std::vector<char>& fixed) {
    const Csr& f = *full_;
    for (const NodalMultiplier& m : multipliers_) {
        Node node{};
        node.multiplier = f.equation[m.multiplier], node.n = m.size;
        bool fits = node.multiplier >= 0;
        for (int i = 0; fits && i < m.size; ++i) {
            const int row = node.equation[i] = f.equation[m.unknown + i];
            fits = row >= 0 && !fixed[m.unknown + i] && owner_[row] < 0 &&
                   (node.column[i] = place_of(f, row, node.multiplier)) >= 0;
        }
        if (!fits || (node.square = place_of(f, node.multiplier, node.multiplier)) < 0) continue;
        for (int i = 0; i < m.size; ++i) owner_[node.equation[i]] = static_cast<int>(nodes_.size());
        gone_[node.multiplier] = 1;
        nodes_.push_back(std::move(node));
    }
}

// Patterns are symmetric: the row of a multiplier tells what feels it.
void ContactCondensation::find_forces() {
    const Csr& f = *full_;
    feeds_.resize(f.n);
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
        Node& node = nodes_[k];
        for (auto e = f.row[node.multiplier]; e < f.row[node.multiplier + 1]; ++e) {
            const int i = f.col[e];
            if (gone_[i] || owner_[i] == static_cast<int>(k)) continue;
            const std::int64_t at = place_of(f, i, node.multiplier);
            if (at < 0) continue;
            if (owner_[i] >= 0) {
                node.elsewhere.push_back(at);
            } else {
                node.on.emplace_back(i, at);
                feeds_[i].emplace_back(static_cast<int>(k), at);
            }
        }
    }
}

void ContactCondensation::find_pattern() {
    const Csr& f = *full_;
    std::vector<int> seen(left_.n, -1);
    int mark = 0;
    auto add = [&](int col, std::vector<int>& cols) {
        if (col >= 0 && seen[col] != mark) seen[col] = mark, cols.push_back(col);
    };
    auto add_row = [&](int row, std::vector<int>& cols) {
        for (auto e = f.row[row]; e < f.row[row + 1]; ++e) add(kept_[f.col[e]], cols);
    };
    for (Node& node : nodes_) {
        for (int i = 0; i < node.n; ++i) add_row(node.equation[i], node.col);
        add_row(node.multiplier, node.col);
        std::sort(node.col.begin(), node.col.end());
        node.along.resize(node.col.size()), node.constraint.resize(node.col.size());
        ++mark;
    }
    left_.row.assign(1, 0);
    std::vector<int> cols;
    for (int i = 0; i < f.n; ++i) {
        if (kept_[i] < 0) continue;
        cols.clear();
        ++mark;
        if (owner_[i] >= 0) {
            cols = nodes_[owner_[i]].col;
        } else {
            add_row(i, cols);
            for (const auto& [k, at] : feeds_[i])
                for (int col : nodes_[k].col) add(col, cols);
            if (!feeds_[i].empty()) std::sort(cols.begin(), cols.end());
        }
        left_.col.insert(left_.col.end(), cols.begin(), cols.end());
        left_.row.push_back(static_cast<std::int64_t>(left_.col.size()));
    }
    values_.resize(left_.col.size()), place_.assign(left_.n, -1);
}

// A row of the full system by the columns of a node.
void ContactCondensation::gather(int row, const Node& node, double* out) {
    const Csr& f = *full_;
    for (std::size_t k = 0; k < node.col.size(); ++k)
        place_[node.col[k]] = static_cast<std::int64_t>(k), out[k] = 0;
    for (auto e = f.row[row]; e < f.row[row + 1]; ++e)
        if (const int col = kept_[f.col[e]]; col >= 0) out[place_[col]] = full_values_[e];
}

bool ContactCondensation::read(Node& node) {
    constexpr double rounding = 1e-13;
    node.own = full_values_[node.square], node.squared = 0;
    for (int i = 0; i < node.n; ++i) {
        node.b[i] = full_values_[node.column[i]];
        node.squared += node.b[i] * node.b[i];
    }
    if (node.squared == 0) return node.own != 0;
    for (const std::int64_t at : node.elsewhere)
        rough_ = rough_ || std::abs(full_values_[at]) > rounding * std::sqrt(node.squared);
    return true;
}

// The node's rows: what is across the force stays, along it stands the constraint, scaled to its stiffness
// there.
void ContactCondensation::replace(Node& node) {
    double* rows[largest_node];
    for (int i = 0; i < node.n; ++i) {
        rows[i] = values_.data() + left_.row[kept_[node.equation[i]]];
        gather(node.equation[i], node, rows[i]);
    }
    if (node.squared == 0) return;
    gather(node.multiplier, node, node.constraint.data());
    double stiffness = 0, slope = 0;  // along the force
    for (std::size_t k = 0; k < node.col.size(); ++k) {
        node.along[k] = 0;
        for (int i = 0; i < node.n; ++i) node.along[k] += node.b[i] * rows[i][k] / node.squared;
    }
    const double length = std::sqrt(node.squared);
    for (int i = 0; i < node.n; ++i) {
        const auto k = place_[kept_[node.equation[i]]];
        stiffness += node.along[k] * node.b[i], slope += node.constraint[k] * node.b[i] / length;
    }
    node.scale = stiffness != 0 && slope != 0 ? std::abs(stiffness / slope) : 1;
    for (int i = 0; i < node.n; ++i)
        for (std::size_t k = 0; k < node.col.size(); ++k)
            rows[i][k] += node.b[i] * (node.scale / length * (node.constraint[k] - node.own * node.along[k]) -
                                       node.along[k]);
}

bool ContactCondensation::reduce(const double* values) {
    const Csr& f = *full_;
    full_values_ = values, rough_ = false, message_.clear();
    for (Node& node : nodes_) {
        if (!read(node)) return fail_at(f.unknown[node.multiplier]);
        replace(node);
    }
    for (int i = 0; i < f.n; ++i) {
        if (kept_[i] < 0 || owner_[i] >= 0) continue;
        double* to = values_.data() + left_.row[kept_[i]];
        if (feeds_[i].empty()) {
            for (auto e = f.row[i]; e < f.row[i + 1]; ++e)
                if (kept_[f.col[e]] >= 0) *to++ = values[e];
            continue;
        }
        std::fill(to, values_.data() + left_.row[kept_[i] + 1], 0.0);
        for (auto e = left_.row[kept_[i]]; e < left_.row[kept_[i] + 1]; ++e) place_[left_.col[e]] = e;
        for (auto e = f.row[i]; e < f.row[i + 1]; ++e)
            if (const int col = kept_[f.col[e]]; col >= 0) values_[place_[col]] += values[e];
        for (const auto& [number, at] : feeds_[i]) {
            const Node& node = nodes_[number];
            const double force = values[at];
            if (node.squared == 0 || force == 0) continue;
            for (std::size_t k = 0; k < node.col.size(); ++k)
                values_[place_[node.col[k]]] -= force * node.along[k];
        }
    }
    return true;
}

double ContactCondensation::along(const Node& node, const double* r) const {
    double sum = 0;
    for (int i = 0; i < node.n; ++i) sum += node.b[i] * r[full_->unknown[node.equation[i]]] / node.squared;
    return sum;
}

void ContactCondensation::condense(std::vector<double>& r) {
    const Csr& f = *full_;
    for (const Node& node : nodes_) {
        if (node.squared == 0) continue;
        const double along = this->along(node, r.data());
        const double rest =
            node.scale / std::sqrt(node.squared) * (r[f.unknown[node.multiplier]] - node.own * along);
        for (int i = 0; i < node.n; ++i) r[f.unknown[node.equation[i]]] += node.b[i] * (rest - along);
        for (const auto& [i, at] : node.on) r[f.unknown[i]] -= full_values_[at] * along;
    }
}

void ContactCondensation::recover(const double* r, double* d) const {
    const Csr& f = *full_;
    for (const Node& node : nodes_) {
        double& multiplier = d[f.unknown[node.multiplier]];
        if (node.squared == 0) {
            multiplier = -r[f.unknown[node.multiplier]] / node.own;
            continue;
        }
        multiplier = -along(node, r);
        for (std::size_t k = 0; k < node.col.size(); ++k)
            multiplier -= node.along[k] * d[left_.unknown[node.col[k]]];
    }
}

// residual_ = r + K d with the whole matrix, and the largest error of a row on whose node others may press,
// above what is allowed. Rows are measured by their own terms, small ones by the largest, whose rounding may
// have come to them.
double ContactCondensation::measure(const double* r, const double* d, double allowed) {
    constexpr double small = 1e-5;
    const Csr& f = *full_;
    residual_.assign(r, r + f.equation.size()), terms_.assign(f.n, 0.0);
    double largest = 0, worst = 0;
    for (int i = 0; i < f.n; ++i) {
        double& sum = residual_[f.unknown[i]];
        terms_[i] = std::abs(sum);
        for (auto e = f.row[i]; e < f.row[i + 1]; ++e) {
            const double term = full_values_[e] * d[f.unknown[f.col[e]]];
            sum += term, terms_[i] += std::abs(term);
        }
        if (owner_[i] >= 0) largest = std::max(largest, terms_[i]);
    }
    for (int i = 0; i < f.n; ++i)
        if (const double left = std::abs(residual_[f.unknown[i]]) - allowed; owner_[i] >= 0 && left > 0)
            worst = std::max(worst, left / (terms_[i] + small * largest));
    return worst;
}

VectorXd ContactCondensation::multipliers(const VectorXd& d) const {
    VectorXd own(nodes_.size());
    for (std::size_t k = 0; k < nodes_.size(); ++k) own[k] = d[full_->unknown[nodes_[k].multiplier]];
    return own;
}

bool ContactCondensation::solve(const double* r, const Place& place, double* d, LinearSolver& rest,
                                double tolerance) {
    message_.clear();
    if (!Reduction::solve(r, place, d, rest, tolerance)) return false;
    if (!rough_) return true;
    double squares = 0;
    for (int u : left_.unknown) squares += right_[u] * right_[u];
    return refine(r, place, d, rest, rest.report().tolerance * std::sqrt(squares));
}

// Until rounding is left, or what `rest` may leave if it iterates. What was left out acts through the
// multipliers alone: increments are mixed so that the corrections of these are least (Anderson 1965), which
// ends after as many as there are, whether or not single corrections grow. Whether it has ended the residual
// of the whole system tells, and nothing else: where constraints hold every unknown, multipliers may be
// wrong while corrections of all others are rounding.
bool ContactCondensation::refine(const double* r, const Place& place, double* d, LinearSolver& rest,
                                 double allowed) {
    constexpr int most = 30;
    constexpr double rounding = 1e-15, good = 1e-9;
    const auto n = static_cast<Eigen::Index>(full_->equation.size());
    Eigen::MatrixXd changes(n, most), steps(n, most);  // of corrections, and of what they correct
    Eigen::MatrixXd seen(nodes_.size(), most);         // the changes in multipliers
    Eigen::Map<VectorXd> x(d, n);
    VectorXd more(n), more_before, step;
    double error = measure(r, d, allowed), before = INFINITY;
    for (int k = 0; k < most && error > rounding && !(error <= good && error > 0.5 * before); ++k) {
        more.setZero();
        if (!Reduction::solve(residual_.data(), place, more.data(), rest, 0)) return false;
        step = more;
        if (k > 0) {
            changes.col(k - 1) = more - more_before, seen.col(k - 1) = multipliers(changes.col(k - 1));
            const VectorXd share = seen.leftCols(k).colPivHouseholderQr().solve(multipliers(more));
            step -= (changes.leftCols(k) + steps.leftCols(k)) * share;
        }
        steps.col(k) = step, x += step, more_before = more;
        before = error, error = measure(r, d, allowed);
    }
    if (error <= good) return true;
    message_ =
        "condensed pressures press too much on each other's nodes; keep them among the equations, "
        "Contact(condensed=False)";
    singular_unknown_ = -1;
    return false;
}

}  // namespace visviva
