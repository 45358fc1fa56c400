// Products of block matrices with vectors, and of blocks. A row's sum is formed in one order, whoever
// computes it.
#pragma once
#include "visviva/base/simd.hpp"
#include "visviva/linear/block_rows.hpp"

namespace visviva::VISVIVA_ISA {

template <class T, int L>
struct LanesOf {
    typedef T type __attribute__((vector_size(L * sizeof(T)), aligned(sizeof(T))));
};
template <class T>
struct LanesOf<T, 1> {
    typedef T type;
};

constexpr int lanes_for(int rows) { return rows == 1 ? 1 : rows == 2 ? 2 : rows <= 4 ? 4 : 8; }

// Lanes are the rows of a block; those beyond hold numbers of the next column, which nobody reads.
template <class T, int R, int C>
void multiply_blocks(const BlockView<T>& a, const T* x, T* y, int begin, int end) {
    constexpr int L = lanes_for(R);
    using Lanes = typename LanesOf<T, L>::type;
    for (int i = begin; i < end; ++i) {
        Lanes sum[C] = {};
        for (std::int64_t k = a.row[i]; k < a.row[i + 1]; ++k) {
            const T *p = a.value + k * (R * C), *xk = x + static_cast<std::int64_t>(a.col[k]) * C;
            for (int c = 0; c < C; ++c) sum[c] += *reinterpret_cast<const Lanes*>(p + c * R) * xk[c];
        }
        for (int c = 1; c < C; ++c) sum[0] += sum[c];
        T* yi = y + static_cast<std::int64_t>(i) * R;
        if constexpr (R == 1)
            yi[0] = sum[0];
        else
            for (int r = 0; r < R; ++r) yi[r] = sum[0][r];
    }
}

template <int rows, int inner, int cols, class B>
void add_product_of(const double* a, const B* b, double* c) {
    for (int r = 0; r < rows; ++r, c += cols) {
        double sum[cols];
        for (int j = 0; j < cols; ++j) sum[j] = c[j];
        for (int k = 0; k < inner; ++k)
            for (int j = 0; j < cols; ++j) sum[j] += a[k * rows + r] * b[k * cols + j];
        for (int j = 0; j < cols; ++j) c[j] = sum[j];
    }
}

template <class B>
void add_product(const double* a, const B* b, double* c, int rows, int inner, int cols) {
    auto is = [&](int r, int k, int n) { return rows == r && inner == k && cols == n; };
    if (is(3, 3, 6)) return add_product_of<3, 3, 6>(a, b, c);
    if (is(6, 3, 6)) return add_product_of<6, 3, 6>(a, b, c);
    if (is(6, 6, 6)) return add_product_of<6, 6, 6>(a, b, c);
    for (int r = 0; r < rows; ++r, c += cols)
        for (int k = 0; k < inner; ++k)
            for (int j = 0; j < cols; ++j) c[j] += a[k * rows + r] * b[k * cols + j];
}

template <class T>
void multiply_any(const BlockView<T>& a, const T* x, T* y, int begin, int end) {
    for (int i = begin; i < end; ++i) {
        T* yi = y + static_cast<std::int64_t>(i) * a.rows;
        for (int r = 0; r < a.rows; ++r) yi[r] = 0;
        for (std::int64_t k = a.row[i]; k < a.row[i + 1]; ++k) {
            const T* p = a.value + k * a.rows * a.cols;
            const T* xk = x + static_cast<std::int64_t>(a.col[k]) * a.cols;
            for (int c = 0; c < a.cols; ++c)
                for (int r = 0; r < a.rows; ++r) yi[r] += p[c * a.rows + r] * xk[c];
        }
    }
}

template <class T>
void block_multiply(const BlockView<T>& a, const T* x, T* y, int begin, int end) {
    auto is = [&](int rows, int cols) { return a.rows == rows && a.cols == cols; };
    if (is(1, 1)) return multiply_blocks<T, 1, 1>(a, x, y, begin, end);
    if (is(2, 2)) return multiply_blocks<T, 2, 2>(a, x, y, begin, end);
    if (is(3, 3)) return multiply_blocks<T, 3, 3>(a, x, y, begin, end);
    if (is(5, 5)) return multiply_blocks<T, 5, 5>(a, x, y, begin, end);
    if (is(6, 6)) return multiply_blocks<T, 6, 6>(a, x, y, begin, end);
    if (is(2, 3)) return multiply_blocks<T, 2, 3>(a, x, y, begin, end);
    if (is(3, 2)) return multiply_blocks<T, 3, 2>(a, x, y, begin, end);
    if (is(3, 6)) return multiply_blocks<T, 3, 6>(a, x, y, begin, end);
    if (is(6, 3)) return multiply_blocks<T, 6, 3>(a, x, y, begin, end);
    multiply_any(a, x, y, begin, end);
}

}  // namespace visviva::VISVIVA_ISA
