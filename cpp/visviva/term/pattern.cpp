#include "visviva/term/pattern.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace visviva {

Pattern::Pattern(const std::vector<int>& node, const std::vector<char>& fixed) : number_(node.size(), -1) {
    const int n = static_cast<int>(node.size());
    for (int u = 0; u < n;) {
        int end = u;
        bool free = false;
        for (; end < n && node[end] == node[u]; ++end) free = free || !fixed[end];
        for (int k = u; free && k < end; ++k) {
            number_[k] = static_cast<int>(first_.size());
            if (fixed[k]) held_.push_back(k);
        }
        if (free) first_.push_back(u), size_.push_back(end - u);
        u = end;
    }
    pairs_.resize(first_.size());
}

void Pattern::leave_uncoupled() {
    std::vector<char> coupled(first_.size(), 0);
    for (std::size_t i = 0; i < pairs_.size(); ++i)
        for (int j : pairs_[i]) coupled[i] = coupled[j] = 1;
    std::vector<int> left(first_.size(), -1);
    int n = 0;
    for (std::size_t i = 0; i < first_.size(); ++i)
        if (coupled[i]) {
            left[i] = n, first_[n] = first_[i], size_[n] = size_[i];
            pairs_[n++].swap(pairs_[i]);
        }
    first_.resize(n), size_.resize(n), pairs_.resize(n);
    for (auto& cols : pairs_)
        for (int& j : cols) j = left[j];
    for (int& i : number_) i = i < 0 ? -1 : left[i];
    held_.erase(std::remove_if(held_.begin(), held_.end(), [&](int u) { return number_[u] < 0; }),
                held_.end());
}

void Pattern::finish(Csr& csr) {
    const int n_nodes = static_cast<int>(first_.size());
    csr.unknown.clear(), csr.equation.assign(number_.size(), -1), csr.col.clear();
    for (int k = 0; k < n_nodes; ++k)
        for (int c = 0; c < size_[k]; ++c) {
            csr.equation[first_[k] + c] = static_cast<int>(csr.unknown.size());
            csr.unknown.push_back(first_[k] + c);
        }
    csr.n = static_cast<int>(csr.unknown.size());
    offset_.resize(n_nodes), start_.resize(n_nodes), length_.resize(n_nodes);
    std::int64_t total = 0;
    for (int i = 0; i < n_nodes; ++i) {
        auto& cols = pairs_[i];
        if (size_[i] > 1) cols.push_back(i);  // identities of held unknowns need a diagonal
        std::sort(cols.begin(), cols.end());
        cols.erase(std::unique(cols.begin(), cols.end()), cols.end());
        cols.shrink_to_fit();
        length_[i] = 0;
        for (int j : cols) {
            offset_[i].push_back(static_cast<int>(length_[i]));
            length_[i] += size_[j];
        }
        start_[i] = total;
        total += length_[i] * size_[i];
    }
    n_entries_ = total;
    if (csr.col.capacity() < static_cast<std::size_t>(total)) csr.col.reserve(total + total / 8);
    csr.row.assign(1, 0);
    csr.row.reserve(csr.n + 1);
    for (int i = 0; i < n_nodes; ++i)
        for (int c = 0; c < size_[i]; ++c) {
            for (int j : pairs_[i])
                for (int k = 0; k < size_[j]; ++k) csr.col.push_back(csr.equation[first_[j]] + k);
            csr.row.push_back(static_cast<std::int64_t>(csr.col.size()));
        }
    std::vector<int> held;
    for (int u : held_) held.push_back(csr.equation[u]);
    held_ = std::move(held);
}

Pattern Pattern::without_equations() const { return Pattern(number_.size()); }

std::int64_t Pattern::position(int row, int col) const {
    const int i = number_[row], j = number_[col];
    if (i < 0 || j < 0) return -1;
    const auto& cols = pairs_[i];
    const auto found = std::lower_bound(cols.begin(), cols.end(), j);
    if (found == cols.end() || *found != j)
        throw std::logic_error("the tangent has no entry in row " + std::to_string(row) + ", column " +
                               std::to_string(col) + ": no term has coupled these unknowns");
    const auto at = found - cols.begin();
    return start_[i] + (row - first_[i]) * length_[i] + offset_[i][at] + (col - first_[j]);
}

Pattern::Rows Pattern::rows(int unknown) const {
    const int i = number_[unknown];
    return i < 0 ? Rows{-1, 0, 0} : Rows{i, start_[i], start_[i] + size_[i] * length_[i]};
}

std::int64_t Pattern::row_length(int row) const { return number_[row] < 0 ? 0 : length_[number_[row]]; }

std::int64_t Pattern::row_start(int row) const {
    const int i = number_[row];
    return i < 0 ? -1 : start_[i] + (row - first_[i]) * length_[i];
}

}  // namespace visviva
