#include "visviva/linear/reduce/element_condensation.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace visviva {

namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

ElementCondensation::ElementCondensation(std::vector<int> element)
    : Reduction(", unknowns of elements condensed",
                "an element does not resist its own enhanced strains or pressures"),
      element_(std::move(element)) {}

void ElementCondensation::analyze(const Csr& full, const std::vector<char>&, const std::vector<int>&) {
    *this = ElementCondensation(std::move(element_));  // nothing of an earlier pattern stays
    local_.resize(full.n);
    for (int i = 0; i < full.n; ++i) local_[i] = element_[full.unknown[i]] >= 0;
    number_left(full, local_);
    find_pattern();
    describe_all();
}

// The pattern without rows and columns of local unknowns: elements couple all they touch, so nothing is
// added.
void ElementCondensation::find_pattern() {
    const Csr& f = *full_;
    left_.row.assign(1, 0);
    for (int i = 0; i < f.n; ++i) {
        if (local_[i]) continue;
        for (auto k = f.row[i]; k < f.row[i + 1]; ++k)
            if (!local_[f.col[k]]) left_.col.push_back(kept_[f.col[k]]);
        left_.row.push_back(static_cast<std::int64_t>(left_.col.size()));
    }
    values_.resize(left_.col.size());
}

void ElementCondensation::describe_all() {
    const int n = static_cast<int>(element_.size());
    for (int u = 0, end = 0; u < n; u = end) {
        for (end = u + 1; end < n && element_[end] == element_[u];) ++end;
        if (element_[u] < 0 || full_->equation[u] < 0) continue;
        elements_.push_back(
            {u, end - u, 0, 0, outer_.size(), place_.size(), inverse_.size(), follow_.size()});
        describe(elements_.back());
    }
    lead_.resize(follow_.size());
}

// Where an element finds its matrices, and where what it leaves goes.
void ElementCondensation::describe(Element& e) {
    const Csr& f = *full_;
    const int first = f.equation[e.unknown];
    e.own = place(f, first, first) - f.row[first];
    std::vector<Run> runs;
    for (auto k = f.row[first]; k < f.row[first + 1]; ++k) {
        const int j = f.col[k];
        if (j >= first && j < first + e.n) continue;
        if (local_[j]) throw std::invalid_argument("unknowns of two elements alone are coupled");
        if (runs.empty() || outer_.back() + 1 != j) runs.push_back({e.n_outer, 0});
        outer_.push_back(j), ++runs.back().size, ++e.n_outer;
    }
    for (int a = 0; a < e.n_outer; ++a) {
        const int i = outer_[e.outer + a];
        column_.push_back(place(f, i, first));
        for (const Run& run : runs)
            place_.push_back(place(left_, kept_[i], kept_[outer_[e.outer + run.first]]));
    }
    runs_.push_back(std::move(runs));
    inverse_.resize(inverse_.size() + e.n * e.n), follow_.resize(follow_.size() + e.n * e.n_outer);
}

std::int64_t ElementCondensation::place(const Csr& csr, int row, int col) const {
    const std::int64_t at = place_of(csr, row, col);
    if (at < 0) throw std::invalid_argument("an element does not couple all that it touches");
    return at;
}

void ElementCondensation::copy(const double* values) {
    const Csr& f = *full_;
    double* to = values_.data();
    for (int i = 0; i < f.n; ++i)
        for (auto k = f.row[i]; !local_[i] && k < f.row[i + 1]; ++k)
            if (!local_[f.col[k]]) *to++ = values[k];
}

bool ElementCondensation::reduce(const double* values) {
    copy(values);
    message_.clear();
    for (const Element& e : elements_) {
        if (!eliminate(e, values)) return fail_at(e.unknown);
        subtract(e);
    }
    return true;
}

bool ElementCondensation::eliminate(const Element& e, const double* values) {
    const Csr& f = *full_;
    const int first = f.equation[e.unknown];
    Rows own(e.n, e.n), others(e.n, e.n_outer);
    for (int a = 0; a < e.n; ++a) {
        const double* row = values + f.row[first + a];
        std::copy_n(row + e.own, e.n, own.row(a).data());
        std::copy_n(row, e.own, others.row(a).data());
        std::copy_n(row + e.own + e.n, e.n_outer - e.own, others.row(a).data() + e.own);
    }
    for (int i = 0; i < e.n_outer; ++i)
        std::copy_n(values + column_[e.outer + i], e.n, &lead_[e.follow + static_cast<std::size_t>(i) * e.n]);
    const Eigen::PartialPivLU<Rows> lu(own);
    if (!(lu.matrixLU().diagonal().cwiseAbs().minCoeff() > 0)) return false;
    Eigen::Map<Rows>(&inverse_[e.inverse], e.n, e.n) = lu.inverse();
    Eigen::Map<Rows>(&follow_[e.follow], e.n, e.n_outer) = lu.solve(others);
    return true;
}

// values_ -= C X, row by row
void ElementCondensation::subtract(const Element& e) {
    const auto& runs = runs_[&e - elements_.data()];
    std::vector<double> row(e.n_outer);
    for (int i = 0; i < e.n_outer; ++i) {
        std::fill(row.begin(), row.end(), 0.0);
        const double* c = &lead_[e.follow + static_cast<std::size_t>(i) * e.n];
        for (int a = 0; a < e.n; ++a) {
            const double* x = &follow_[e.follow + static_cast<std::size_t>(a) * e.n_outer];
            for (int j = 0; j < e.n_outer; ++j) row[j] += c[a] * x[j];
        }
        for (std::size_t k = 0; k < runs.size(); ++k) {
            double* to = &values_[place_[e.runs + i * runs.size() + k]];
            for (int j = 0; j < runs[k].size; ++j) to[j] -= row[runs[k].first + j];
        }
    }
}

void ElementCondensation::condense(std::vector<double>& r) {
    std::vector<double> y;
    for (const Element& e : elements_) {
        y.assign(e.n, 0.0);
        for (int a = 0; a < e.n; ++a)
            for (int b = 0; b < e.n; ++b) y[a] += inverse_[e.inverse + a * e.n + b] * r[e.unknown + b];
        for (int i = 0; i < e.n_outer; ++i)
            for (int a = 0; a < e.n; ++a)
                r[full_->unknown[outer_[e.outer + i]]] -=
                    lead_[e.follow + static_cast<std::size_t>(i) * e.n + a] * y[a];
    }
}

void ElementCondensation::recover(const double* r, double* d) const {
    for (const Element& e : elements_)
        for (int a = 0; a < e.n; ++a) {
            double sum = 0;
            for (int b = 0; b < e.n; ++b) sum += inverse_[e.inverse + a * e.n + b] * r[e.unknown + b];
            const double* x = &follow_[e.follow + static_cast<std::size_t>(a) * e.n_outer];
            for (int j = 0; j < e.n_outer; ++j) sum += x[j] * d[full_->unknown[outer_[e.outer + j]]];
            d[e.unknown + a] = -sum;
        }
}

}  // namespace visviva
