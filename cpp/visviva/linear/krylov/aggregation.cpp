#include "visviva/linear/krylov/aggregation.hpp"

#include <algorithm>
#include <utility>

#include "visviva/base/parallel.hpp"
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

// Pieces of 0 .. n of which each thread keeps marks for all columns: few of them.
int piece_of(int n) { return std::max(64, (n + 63) / 64); }

// Rows of pieces, one after another; what has been copied is let go.
template <class Rows, class Values>
void join(std::vector<Rows>& parts, Rows& whole, Values values) {
    std::size_t n = 0, size = 0;
    for (const Rows& part : parts) n += part.col.size(), size += (part.*values).size();
    whole.col.reserve(n), (whole.*values).reserve(size + BlockRows<double>::padding);
    for (Rows& one : parts) {
        const Rows part = std::move(one);
        const std::int64_t before = whole.row.back();
        for (std::size_t i = 1; i < part.row.size(); ++i) whole.row.push_back(before + part.row[i]);
        whole.col.insert(whole.col.end(), part.col.begin(), part.col.end());
        (whole.*values).insert((whole.*values).end(), (part.*values).begin(), (part.*values).end());
    }
}

}  // namespace

BlockRows<float> Prolongation::up() && {
    BlockRows<float> b;
    b.rows = rows, b.cols = cols, b.row = std::move(row), b.col = std::move(col), b.value = std::move(block);
    std::vector<float> by_rows(static_cast<std::size_t>(rows) * cols);
    for (std::size_t k = 0; k < b.col.size(); ++k) {
        float* to = b.block(static_cast<std::int64_t>(k));
        std::copy_n(to, by_rows.size(), by_rows.data());
        for (int r = 0; r < rows; ++r)
            for (int c = 0; c < cols; ++c) to[c * rows + r] = by_rows[r * cols + c];
    }
    b.value.resize(b.n_values() + b.padding, 0.0F);
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
            std::copy_n(at(k), rows * cols, b.block(to));
        }
    return b;
}

Prolongation smoothed(const BlockReader& matrix, const BlockRows<float>& inverse, double factor,
                      const Aggregates& tentative) {
    const BlockRows<double>& a = matrix.pattern;
    const int m = a.rows, size = m * tentative.cols, piece = piece_of(a.n());
    const auto add = sparse_kernels().add_product;
    const auto add_tentative = sparse_kernels().add_product_single;
    const Prolongation empty{tentative.n, m, tentative.cols, {0}, {}, {}};
    std::vector<Prolongation> parts((a.n() + piece - 1) / piece, empty);
    in_pieces(a.n(), piece, [&](int begin, int end) {
        Prolongation& p = parts[begin / piece];
        Row sum(tentative.n, size);
        std::vector<double> d(static_cast<std::size_t>(m) * m), own(size), room;
        for (int i = begin; i < end; ++i) {
            const double* block = matrix.row(i, room);
            for (auto k = a.row[i]; k < a.row[i + 1]; ++k, block += m * m)
                if (const int j = tentative.of[a.col[k]]; j >= 0)
                    add_tentative(block, &tentative.block[static_cast<std::size_t>(a.col[k]) * size],
                                  sum.place(j), m, m, tentative.cols);
            std::transform(inverse.block(i), inverse.block(i) + m * m, d.begin(),
                           [factor](float value) { return -factor * static_cast<double>(value); });
            for (std::size_t k = 0; k < sum.col.size(); ++k) {
                std::fill(own.begin(), own.end(), 0.0);
                if (sum.col[k] == tentative.of[i])
                    std::copy_n(&tentative.block[static_cast<std::size_t>(i) * size], size, own.begin());
                add(d.data(), &sum.block[k * size], own.data(), m, m, tentative.cols);
                p.col.push_back(sum.col[k]);
                for (const double value : own) p.block.push_back(static_cast<float>(value));
            }
            p.row.push_back(static_cast<std::int64_t>(p.col.size()));
            sum.clear();
        }
    });
    Prolongation whole = empty;
    join(parts, whole, &Prolongation::block);
    return whole;
}

// A coarse row I is (A^T P_I)^T P with the column I of P.
BlockRows<double> coarse_matrix(const BlockReader& matrix, const Prolongation& p) {
    const BlockRows<double>& a = matrix.pattern;
    const int m = p.rows, n = p.cols, piece = piece_of(p.n_coarse);
    const auto add = sparse_kernels().add_product_single;
    std::vector<std::vector<std::pair<int, std::int64_t>>> column(p.n_coarse);  // rows and places in P
    for (int i = 0; i < p.n(); ++i)
        for (auto k = p.row[i]; k < p.row[i + 1]; ++k) column[p.col[k]].push_back({i, k});
    BlockRows<double> c;
    c.rows = c.cols = n;
    std::vector<BlockRows<double>> parts((p.n_coarse + piece - 1) / piece, c);
    in_pieces(p.n_coarse, piece, [&](int begin, int end) {
        BlockRows<double>& part = parts[begin / piece];
        Row fine(a.n(), m * n), coarse(p.n_coarse, n * n);
        std::vector<double> turned(static_cast<std::size_t>(m) * m), room;
        std::vector<int> order;
        for (int big = begin; big < end; ++big) {
            for (const auto& [i, q] : column[big]) {
                const double* block = matrix.row(i, room);
                for (auto k = a.row[i]; k < a.row[i + 1]; ++k, block += m * m) {
                    for (int r = 0; r < m; ++r)
                        for (int j = 0; j < m; ++j) turned[j * m + r] = block[r * m + j];
                    add(turned.data(), p.at(q), fine.place(a.col[k]), m, m, n);
                }
            }
            for (std::size_t k = 0; k < fine.col.size(); ++k)
                for (auto q = p.row[fine.col[k]]; q < p.row[fine.col[k] + 1]; ++q)
                    add(&fine.block[k * m * n], p.at(q), coarse.place(p.col[q]), n, m, n);
            order = coarse.col;
            std::sort(order.begin(), order.end());
            for (int j : order) {
                const double* from = &coarse.block[static_cast<std::size_t>(coarse.at[j]) * n * n];
                part.col.push_back(j);
                part.value.resize(part.n_values());
                double* to = &part.value[part.n_values() - static_cast<std::size_t>(n) * n];
                for (int r = 0; r < n; ++r)
                    for (int k = 0; k < n; ++k) to[r * n + k] = from[k * n + r];  // by columns
            }
            part.row.push_back(static_cast<std::int64_t>(part.col.size()));
            fine.clear(), coarse.clear();
        }
    });
    join(parts, c, &BlockRows<double>::value);
    c.value.resize(c.n_values() + c.padding, 0.0);
    return c;
}

}  // namespace visviva
