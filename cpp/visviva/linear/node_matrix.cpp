#include "visviva/linear/node_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "visviva/base/parallel.hpp"
#include "visviva/linear/sparse_dispatch.hpp"

namespace visviva {

constexpr int largest_block = 6;
constexpr int piece = 512;          // block rows of a task
constexpr double largest_fill = 2;  // entries of blocks over entries of the pattern

void NodeMatrix::analyze(const Csr& pattern, const Blocks& blocks) {
    csr_ = &pattern, blocks_of_ = &blocks;
    partition(blocks.node, blocks.place);
    make_pattern();
    if (static_cast<double>(a_.n_values()) > largest_fill * static_cast<double>(pattern.col.size())) {
        partition({}, {});
        make_pattern();
    }
    const auto is_algebraic = [](char of) { return of != 0; };
    borrows_ = pattern.n >= borrow_from_ &&
               std::none_of(blocks.algebraic.begin(), blocks.algebraic.end(), is_algebraic);
    if (borrows_)
        a_.value = {};
    else
        a_.allocate();
    shared_.assign(a_.n(), 0);
    for (int b = 0; b < a_.n(); ++b) shared_[b] = share_columns(b);
    if (is_single_) {
        single_.rows = a_.rows, single_.cols = a_.cols, single_.row = a_.row, single_.col = a_.col;
        single_.allocate(), x_.resize(size()), y_.resize(size());
    }
    algebraic_.assign(a_.n(), 0);
    level_.assign(a_.n(), 1.0);
    kinds_.assign(size(), Kind::filling), block_.resize(pattern.n);
    for (int i = 0; i < pattern.n; ++i) {
        const bool algebraic = !blocks.algebraic.empty() && blocks.algebraic[i];
        block_[i] = slot_[i] / a_.rows;
        kinds_[slot_[i]] = algebraic ? Kind::algebraic : Kind::differential;
        if (algebraic) algebraic_[block_[i]] = 1;
    }
}

std::vector<double> NodeMatrix::modes() const {
    std::vector<int> equation(size(), -1);
    for (int i = 0; i < csr_->n; ++i) equation[slot_[i]] = i;
    std::vector<double> by_slot(size() * n_modes(), 0.0);
    blocks_of_->modes(equation, by_slot.data());
    return by_slot;
}

// Blocks have the size that most nodes have, or those together that stand at one place; larger ones are cut
// into several.
void NodeMatrix::partition(const std::vector<int>& node, const std::vector<int>& place) {
    order_.resize(csr_->n);
    std::iota(order_.begin(), order_.end(), 0);
    std::vector<int> start = node;
    if (start.empty()) {
        start.resize(csr_->n + 1);
        std::iota(start.begin(), start.end(), 0);
    }
    if (!place.empty()) {
        std::stable_sort(order_.begin(), order_.end(), [&](int i, int j) { return place[i] < place[j]; });
        start.clear();
        for (int k = 0; k < csr_->n; ++k)
            if (k == 0 || place[order_[k]] != place[order_[k - 1]]) start.push_back(k);
        start.push_back(csr_->n);
    }
    std::vector<int> count(largest_block + 1, 0);
    for (std::size_t k = 0; k + 1 < start.size(); ++k)
        count[std::min(start[k + 1] - start[k], largest_block)] += start[k + 1] - start[k];
    a_.rows = a_.cols = static_cast<int>(std::max_element(count.begin(), count.end()) - count.begin());
    a_.rows = a_.cols = std::max(a_.rows, 1);
    first_.clear(), slot_.resize(csr_->n);
    for (std::size_t k = 0; k + 1 < start.size(); ++k)
        for (int i = start[k]; i < start[k + 1]; i += a_.rows) first_.push_back(i);
    first_.push_back(csr_->n);
    for (std::size_t b = 0; b + 1 < first_.size(); ++b)
        for (int k = first_[b]; k < first_[b + 1]; ++k)
            slot_[order_[k]] = static_cast<int>(b) * a_.rows + k - first_[b];
}

void NodeMatrix::make_pattern() {
    const int n = static_cast<int>(first_.size()) - 1;
    a_.row.assign(1, 0), a_.col.clear();
    std::vector<int> seen(n, -1), cols;
    for (int b = 0; b < n; ++b) {
        cols.assign(1, b), seen[b] = b;
        for (int i = first_[b]; i < first_[b + 1]; ++i)
            for (auto k = csr_->row[order_[i]]; k < csr_->row[order_[i] + 1]; ++k) {
                const int c = slot_[csr_->col[k]] / a_.rows;
                if (seen[c] != b) cols.push_back(c), seen[c] = b;
            }
        std::sort(cols.begin(), cols.end());
        a_.col.insert(a_.col.end(), cols.begin(), cols.end());
        a_.row.push_back(static_cast<std::int64_t>(a_.col.size()));
    }
}

// The largest of what f(begin, end) makes of pieces of 0 .. n.
template <class F>
static double largest_of(int n, F f) {
    std::vector<double> part((n + piece - 1) / piece, 0.0);
    in_pieces(n, piece, [&](int begin, int end) { part[begin / piece] = f(begin, end); });
    return part.empty() ? 0 : *std::max_element(part.begin(), part.end());
}

// Room for a row of blocks.
static double* row_of(const BlockRows<double>& a, int b, std::vector<double>& room) {
    const auto size = static_cast<std::size_t>(a.row[b + 1] - a.row[b]) * a.rows * a.cols;
    if (room.size() < size) room.resize(size);
    return room.data();
}

bool NodeMatrix::fill(const double* values) {
    std::vector<char> finite(a_.n());
    const double largest = largest_of(is_single_ ? csr_->n : 0, [&](int begin, int end) {
        double some = 0;
        for (int i = begin; i < end; ++i)
            some = std::max(some, std::abs(values[csr_->row[i]]));  // an entry of each row will do
        return some;
    });
    scale_ = largest > 0 ? 1 / largest : 1;
    values_ = values;
    in_pieces(a_.n(), piece, [&](int begin, int end) {
        std::vector<double> room;
        for (int b = begin; b < end; ++b) {
            double* to = borrows_ ? row_of(a_, b, room) : a_.block(a_.row[b]);
            finite[b] = is_finite(b, values);
            if (!borrows_ || is_single_) fill(b, values, to);
            if (is_single_) copy_single(b, to);
        }
    });
    for (int b = 0; levels_ && b < a_.n(); ++b)  // by the stiffness in other rows
        if (algebraic_[b]) level(b);
    return std::find(finite.begin(), finite.end(), 0) == finite.end();
}

// Whether the rows of a block row follow each other with the same columns, as those of a node do.
bool NodeMatrix::share_columns(int b) const {
    const int first = order_[first_[b]], n = first_[b + 1] - first_[b];
    const auto row = csr_->col.begin() + csr_->row[first], next = csr_->col.begin() + csr_->row[first + 1];
    for (int r = 1; r < n; ++r) {
        const int i = order_[first_[b] + r];
        const auto begin = csr_->col.begin() + csr_->row[i], end = csr_->col.begin() + csr_->row[i + 1];
        if (i != first + r || !std::equal(row, next, begin, end)) return false;
    }
    return true;
}

// Columns of both patterns ascend, field by field where several stand at one place: a walk along both for
// each finds every entry's place. Rows that share their columns walk together.
void NodeMatrix::fill(int b, const double* values, double* to) const {
    const int m = a_.rows, used = first_[b + 1] - first_[b], together = shared_[b] ? used : 1;
    const std::int64_t first = a_.row[b];
    std::fill_n(to, (a_.row[b + 1] - first) * m * m, 0.0);
    for (int row = first_[b]; row < first_[b + 1]; row += together) {
        const std::int64_t begin = csr_->row[order_[row]], n = csr_->row[order_[row] + 1] - begin;
        std::int64_t at = first;
        for (std::int64_t k = 0; k < n; ++k) {
            const int column = csr_->col[begin + k], slot = slot_[column], c = block_[column];
            if (a_.col[at] > c) at = first;
            while (a_.col[at] < c) ++at;
            double* entry = to + ((at - first) * m + slot - c * m) * m + row - first_[b];
            for (int r = 0; r < together; ++r) entry[r] = values[begin + r * n + k];
        }
    }
    const auto begin = a_.col.begin() + first,
               diagonal = std::lower_bound(begin, a_.col.begin() + a_.row[b + 1], b);
    for (int r = used; r < m; ++r) to[((diagonal - begin) * m + r) * m + r] = 1;
}

bool NodeMatrix::is_finite(int b, const double* values) const {
    bool finite = true;
    for (int row = first_[b]; row < first_[b + 1]; ++row)
        for (auto k = csr_->row[order_[row]]; k < csr_->row[order_[row] + 1]; ++k)
            finite = finite && std::isfinite(values[k]);
    return finite;
}

void NodeMatrix::copy_single(int b, const double* from) {
    std::transform(from, from + (a_.row[b + 1] - a_.row[b]) * a_.rows * a_.rows, single_.block(a_.row[b]),
                   [this](double a) { return static_cast<float>(scale_ * a); });
}

BlockReader NodeMatrix::reader() const {
    if (!borrows_) return a_;
    return {a_, [this](int b, std::vector<double>& room) -> const double* {
                double* to = row_of(a_, b, room);
                fill(b, values_, to);
                return to;
            }};
}

// Constraints of a node of their own, which fill its first row.
void NodeMatrix::level(int b) {
    const int m = a_.rows;
    double squares = 0, stiffness = 0;
    for (auto k = a_.row[b]; k < a_.row[b + 1]; ++k) {
        const int j = a_.col[k];
        if (algebraic_[j]) continue;
        const auto begin = a_.col.begin() + a_.row[j], end = a_.col.begin() + a_.row[j + 1];
        const double* diagonal = a_.block(std::lower_bound(begin, end, j) - a_.col.begin());
        for (int c = 0; c < m; ++c) {
            const double square = a_.block(k)[c * m] * a_.block(k)[c * m];
            squares += square, stiffness += square * std::abs(diagonal[c * m + c]);
        }
    }
    level_[b] = squares > 0 && stiffness > 0 ? stiffness / (squares * std::sqrt(squares)) : 1;
    for (auto k = a_.row[b]; k < a_.row[b + 1]; ++k)
        for (int c = 0; c < m; ++c) a_.block(k)[c * m] *= level_[b];
    if (is_single_) copy_single(b, a_.block(a_.row[b]));
}

void multiply(const BlockRows<double>& a, const double* x, double* y) {
    in_pieces(a.n(), piece,
              [&](int begin, int end) { sparse_kernels().block_multiply(a.view(), x, y, begin, end); });
}

void NodeMatrix::multiply(const double* x, double* y) const {
    if (is_single_)
        multiply_single(x, y);
    else
        multiply_double(x, y);
}

void NodeMatrix::multiply_double(const double* x, double* y) const {
    if (borrows_)
        multiply_borrowed(x, y);
    else
        visviva::multiply(a_, x, y);
}

// R rows that follow each other and have the same columns, which come from memory once.
template <int R>
static void multiply_rows(const Csr& a, const double* values, int i, const double* x, double* sum) {
    const auto begin = a.row[i], n = a.row[i + 1] - begin;
    constexpr int chains = 4;  // of additions that need not wait for each other
    double s[chains][R] = {};
    std::int64_t k = 0;
    for (; k + chains <= n; k += chains)
        for (int c = 0; c < chains; ++c) {
            const double at = x[a.col[begin + k + c]];
            for (int r = 0; r < R; ++r) s[c][r] += values[begin + r * n + k + c] * at;
        }
    for (; k < n; ++k)
        for (int r = 0; r < R; ++r) s[0][r] += values[begin + r * n + k] * x[a.col[begin + k]];
    for (int r = 0; r < R; ++r) sum[r] = (s[0][r] + s[1][r]) + (s[2][r] + s[3][r]);
}

void NodeMatrix::multiply_borrowed(const double* x, double* y) const {
    const int m = a_.rows;
    by_equation_.resize(csr_->n);
    for (int i = 0; i < csr_->n; ++i) by_equation_[i] = x[slot_[i]];
    in_pieces(a_.n(), piece, [&](int begin, int end) {
        for (int b = begin; b < end; ++b) {
            const int used = first_[b + 1] - first_[b];
            double* to = y + static_cast<std::ptrdiff_t>(b) * m;
            const double* from = by_equation_.data();
            if (used == 3 && shared_[b])
                multiply_rows<3>(*csr_, values_, order_[first_[b]], from, to);
            else
                for (int r = 0; r < used; ++r)
                    multiply_rows<1>(*csr_, values_, order_[first_[b] + r], from, to + r);
            std::copy(x + (to - y) + used, x + (to - y) + m, to + used);  // equations of nothing
        }
    });
}

void NodeMatrix::multiply_single(const double* x, double* y) const {
    const double largest = largest_of(a_.n(), [&](int begin, int end) {
        double part = 0;
        for (int i = begin * a_.rows; i < end * a_.rows; ++i) part = std::max(part, std::abs(x[i]));
        return part;
    });
    if (!(largest > 0 && std::isfinite(largest))) {
        std::copy(x, x + size(), y);
        return;
    }
    const double back = largest / scale_;
    in_pieces(a_.n(), piece, [&](int begin, int end) {
        for (int i = begin * a_.rows; i < end * a_.rows; ++i) x_[i] = static_cast<float>(x[i] / largest);
    });
    in_pieces(a_.n(), piece, [&](int begin, int end) {
        sparse_kernels().block_multiply_single(single_.view(), x_.data(), y_.data(), begin, end);
        for (int i = begin * a_.rows; i < end * a_.rows; ++i) y[i] = back * y_[i];
    });
}

void NodeMatrix::gather(const double* r, double* b) const {
    std::fill(b, b + size(), 0.0);
    for (int i = 0; i < csr_->n; ++i) b[slot_[i]] = -level_[slot_[i] / a_.rows] * r[csr_->unknown[i]];
}

void NodeMatrix::scatter(const double* x, double* d) const {
    for (int i = 0; i < csr_->n; ++i) d[csr_->unknown[i]] = x[slot_[i]];
}

}  // namespace visviva
