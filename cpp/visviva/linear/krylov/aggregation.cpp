#include "visviva/linear/krylov/aggregation.hpp"

#include <algorithm>

#include "visviva/linear/sparse_dispatch.hpp"

namespace visviva {

namespace {

// A row of blocks by their columns, in the order in which these come.
struct Row {
    std::vector<int> at, col;  // place of a column, or -1; columns
    std::vector<double> block;
    int size;  // of a block

    Row(int n_cols, int block_size) : at(n_cols, -1), size(block_size) {}
    double* place(int j) {
        if (at[j] < 0) {
            at[j] = static_cast<int>(col.size());
            col.push_back(j);
            block.resize(block.size() + size, 0.0);
        }
        return block.data() + static_cast<std::ptrdiff_t>(at[j]) * size;
    }
    void clear() {
        for (int j : col) at[j] = -1;
        col.clear(), block.clear();
    }
};

// Columns of P^T A P by rows, ascending.
BlockRows<double> coarse_pattern(const BlockRows<double>& a, const Prolongation& p) {
    std::vector<std::vector<int>> rows_of(p.n_coarse);  // of P, by columns
    for (int i = 0; i < p.n(); ++i)
        for (auto k = p.row[i]; k < p.row[i + 1]; ++k) rows_of[p.col[k]].push_back(i);
    BlockRows<double> c;
    c.rows = c.cols = p.cols;
    std::vector<int> seen(p.n_coarse, -1), met(p.n(), -1), cols;
    for (int big = 0; big < p.n_coarse; ++big) {
        cols.clear();
        for (int i : rows_of[big])
            for (auto k = a.row[i]; k < a.row[i + 1]; ++k) {
                if (met[a.col[k]] == big) continue;
                met[a.col[k]] = big;
                for (auto q = p.row[a.col[k]]; q < p.row[a.col[k] + 1]; ++q)
                    if (seen[p.col[q]] != big) seen[p.col[q]] = big, cols.push_back(p.col[q]);
            }
        std::sort(cols.begin(), cols.end());
        c.col.insert(c.col.end(), cols.begin(), cols.end());
        c.row.push_back(static_cast<std::int64_t>(c.col.size()));
    }
    c.allocate();
    return c;
}

void transpose_blocks(BlockRows<double>& a) {
    for (std::size_t k = 0; k < a.col.size(); ++k)
        for (int r = 0; r < a.rows; ++r)
            for (int c = 0; c < r; ++c) std::swap(a.block(k)[c * a.rows + r], a.block(k)[r * a.rows + c]);
}

}  // namespace

BlockRows<float> Prolongation::up() const {
    BlockRows<float> b;
    b.rows = rows, b.cols = cols, b.row = row, b.col = col;
    b.allocate();
    for (std::size_t k = 0; k < col.size(); ++k)
        for (int r = 0; r < rows; ++r)
            for (int c = 0; c < cols; ++c) b.block(k)[c * rows + r] = static_cast<float>(at(k)[r * cols + c]);
    return b;
}

// By rows, blocks are their transposes by columns already.
BlockRows<float> Prolongation::down() const {
    BlockRows<float> b;
    b.rows = cols, b.cols = rows, b.col.resize(col.size());
    std::vector<std::int64_t> next(n_coarse + 1, 0);
    for (int j : col) ++next[j + 1];
    for (int j = 0; j < n_coarse; ++j) next[j + 1] += next[j];
    b.row = next;
    b.allocate();
    for (int i = 0; i < n(); ++i)
        for (auto k = row[i]; k < row[i + 1]; ++k) {
            const auto to = next[col[k]]++;
            b.col[to] = i;
            std::transform(at(k), at(k) + rows * cols, b.block(to),
                           [](double value) { return static_cast<float>(value); });
        }
    return b;
}

Prolongation smoothed(const BlockRows<double>& a, const BlockRows<float>& inverse, double factor,
                      const Aggregates& tentative) {
    const int m = a.rows, size = m * tentative.cols;
    const auto add = sparse_kernels().add_product;
    Prolongation p{tentative.n, m, tentative.cols, {0}, {}, {}};
    Row sum(tentative.n, size);
    std::vector<double> d(static_cast<std::size_t>(m) * m);
    for (int i = 0; i < a.n(); ++i) {
        for (auto k = a.row[i]; k < a.row[i + 1]; ++k)
            if (const int j = tentative.of[a.col[k]]; j >= 0)
                add(a.block(k), &tentative.block[static_cast<std::size_t>(a.col[k]) * size], sum.place(j), m,
                    m, tentative.cols);
        std::transform(inverse.block(i), inverse.block(i) + m * m, d.begin(),
                       [factor](float value) { return -factor * static_cast<double>(value); });
        p.col.insert(p.col.end(), sum.col.begin(), sum.col.end());
        p.block.resize(p.col.size() * size, 0.0);
        for (std::size_t k = 0; k < sum.col.size(); ++k) {
            double* to = p.at(p.row.back() + static_cast<std::int64_t>(k));
            if (sum.col[k] == tentative.of[i])
                std::copy_n(&tentative.block[static_cast<std::size_t>(i) * size], size, to);
            add(d.data(), &sum.block[k * size], to, m, m, tentative.cols);
        }
        p.row.push_back(static_cast<std::int64_t>(p.col.size()));
        sum.clear();
    }
    return p;
}

BlockRows<double> coarse_matrix(const BlockRows<double>& a, const Prolongation& p) {
    const int m = p.rows, n = p.cols;
    const auto add = sparse_kernels().add_product;
    BlockRows<double> c = coarse_pattern(a, p);
    Row ap(p.n_coarse, m * n);
    for (int i = 0; i < a.n(); ++i) {
        if (p.row[i] == p.row[i + 1]) continue;
        for (auto k = a.row[i]; k < a.row[i + 1]; ++k)
            for (auto q = p.row[a.col[k]]; q < p.row[a.col[k] + 1]; ++q)
                add(a.block(k), p.at(q), ap.place(p.col[q]), m, m, n);
        for (auto q = p.row[i]; q < p.row[i + 1]; ++q) {
            const auto first = c.col.begin() + c.row[p.col[q]], last = c.col.begin() + c.row[p.col[q] + 1];
            for (std::size_t k = 0; k < ap.col.size(); ++k)
                add(p.at(q), &ap.block[k * m * n],
                    c.block(std::lower_bound(first, last, ap.col[k]) - c.col.begin()), n, m, n);
        }
        ap.clear();
    }
    transpose_blocks(c);
    return c;
}

}  // namespace visviva
