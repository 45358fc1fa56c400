#include "visviva/linear/reduce/contact_condensation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace visviva {

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

void ContactCondensation::add_product(const double* d, double* r) const {
    const Csr& f = *full_;
    for (int i = 0; i < f.n; ++i) {
        double sum = 0;
        for (auto e = f.row[i]; e < f.row[i + 1]; ++e) sum += full_values_[e] * d[f.unknown[f.col[e]]];
        r[f.unknown[i]] += sum;
    }
}

double ContactCondensation::size(const double* d) const {
    double largest = 0;
    for (int i = 0; i < full_->n; ++i)
        if (!gone_[i]) largest = std::max(largest, std::abs(d[full_->unknown[i]]));
    return largest;
}

bool ContactCondensation::solve(const double* r, const Place& place, double* d, LinearSolver& rest,
                                double tolerance) {
    message_.clear();
    return Reduction::solve(r, place, d, rest, tolerance) && (!rough_ || refine(r, place, d, rest));
}

// Until rounding is left; solvers that iterate leave more than that, and Newton's method goes on anyway. What
// was left out acts through the multipliers alone: increments are mixed so that the corrections of these are
// least (Anderson 1965), which ends after as many as there are, whether or not single corrections grow.
bool ContactCondensation::refine(const double* r, const Place& place, double* d, LinearSolver& rest) {
    constexpr int most = 30;
    constexpr double rounding = 1e-15, good = 1e-9;
    const double whole = size(d);
    const auto n = static_cast<Eigen::Index>(full_->equation.size());
    Eigen::MatrixXd changes(n, most), steps(n, most);  // of corrections, and of what they correct
    Eigen::MatrixXd seen(nodes_.size(), most);         // the changes in multipliers
    Eigen::Map<Eigen::VectorXd> x(d, n);
    Eigen::VectorXd more(n), more_before, step;
    auto multipliers = [&](const Eigen::VectorXd& all) {
        Eigen::VectorXd own(nodes_.size());
        for (std::size_t k = 0; k < nodes_.size(); ++k) own[k] = all[full_->unknown[nodes_[k].multiplier]];
        return own;
    };
    double before = whole;
    for (int k = 0; k < most && rest.report().n_iterations == 0; ++k) {
        residual_.assign(r, r + n);
        more.setZero();
        add_product(d, residual_.data());
        if (!Reduction::solve(residual_.data(), place, more.data(), rest, 0)) return false;
        const double now = size(more.data());
        if (now <= rounding * whole || (now <= good * whole && now > 0.5 * before)) {
            if (now < before) x += more;
            return true;
        }
        if (k > 0) {
            changes.col(k - 1) = more - more_before, steps.col(k - 1) = step;
            seen.col(k - 1) = multipliers(changes.col(k - 1));
        }
        step = more;
        if (k > 0) {
            const Eigen::VectorXd share = seen.leftCols(k).colPivHouseholderQr().solve(multipliers(more));
            step -= (changes.leftCols(k) + steps.leftCols(k)) * share;
        }
        x += step;
        more_before = more, before = now;
    }
    if (rest.report().n_iterations > 0) return true;
    message_ =
        "condensed pressures press too much on each other's nodes; keep them among the equations, "
        "Contact(condensed=False)";
    singular_unknown_ = -1;
    return false;
}

}  // namespace visviva
