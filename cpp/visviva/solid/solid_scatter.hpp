// Element vectors and matrices of W solid elements, added to where they belong.
#pragma once
#include "visviva/solid/solid_element.hpp"

#if defined(__AVX512VL__)
#include <immintrin.h>
#endif

namespace visviva::VISVIVA_ISA {

typedef double V2 __attribute__((vector_size(16), aligned(8)));
typedef double V4 __attribute__((vector_size(32), aligned(8)));

template <int D, int N>
VISVIVA_INLINE void solid_scatter_forces(const SolidElement<D, N>& e, const V* r, int n, double* to) {
    for (int a = 0; a < e.nodes(); ++a) {
        const int* index = e.index(a);
        for (int c = 0; c < D; ++c)
            for (int l = 0; l < n; ++l) to[index[l] + c] += r[a * D + c][l];
    }
}

/// Three numbers; a fourth beside them may belong to another thread.
VISVIVA_INLINE V4 three(const double* from) {
#if defined(__AVX512VL__)
    return _mm256_maskz_loadu_pd(7, from);
#else
    return V4{from[0], from[1], from[2], 0.0};
#endif
}
VISVIVA_INLINE void put_three(double* to, V4 a) {
#if defined(__AVX512VL__)
    _mm256_mask_storeu_pd(to, 7, a);
#else
    for (int j = 0; j < 3; ++j) to[j] = a[j];
#endif
}

/// (a, b, c, anything) of every lane.
VISVIVA_INLINE void transpose(V a, V b, V c, V4* lanes) {
#if VISVIVA_WIDTH == 8
    const V even = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const V odd = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const V pair[4] = {__builtin_shufflevector(even, c, 0, 1, 8, 8, 2, 3, 10, 10),
                       __builtin_shufflevector(odd, c, 0, 1, 9, 9, 2, 3, 11, 11),
                       __builtin_shufflevector(even, c, 4, 5, 12, 12, 6, 7, 14, 14),
                       __builtin_shufflevector(odd, c, 4, 5, 13, 13, 6, 7, 15, 15)};
    for (int l = 0; l < 4; ++l) {
        lanes[l / 2 * 4 + l % 2] = __builtin_shufflevector(pair[l], pair[l], 0, 1, 2, 3);
        lanes[l / 2 * 4 + l % 2 + 2] = __builtin_shufflevector(pair[l], pair[l], 4, 5, 6, 7);
    }
#else
    for (int l = 0; l < W; ++l) lanes[l] = V4{a[l], b[l], c[l], 0.0};
#endif
}

/// Where the block (a, b) of W elements starts among the values; -1 for what has no equations.
template <int D, int N>
VISVIVA_INLINE void solid_places(const SolidElement<D, N>& e, int a, int b, std::int64_t* place) {
    const std::int64_t row = static_cast<std::int64_t>(e.block) * e.nodes() + a;
    const std::int64_t* start = e.v.row + row * L8 + e.lane;
    const std::uint16_t* offset = e.v.offset + (row * e.nodes() + b) * L8 + e.lane;
    for (int l = 0; l < W; ++l) place[l] = offset[l] == 0xffff ? -1 : start[l] + offset[l];
}

// Adds the blocks (a, b) of W elements, K[i][j] or its transpose, to the matrix.
template <int D, int N, bool transposed>
VISVIVA_INLINE void solid_scatter_block(const SolidElement<D, N>& e, int a, int b, const V* K,
                                        double* values) {
    std::int64_t place[W];
    solid_places(e, a, b, place);
    const std::int64_t* length =
        e.v.length + (static_cast<std::int64_t>(e.block) * e.nodes() + a) * L8 + e.lane;
    constexpr int row = transposed ? 1 : D, column = transposed ? D : 1;
    if constexpr (D == 3) {
        V4 lanes[3][W];
        VISVIVA_FLATTEN
        for (int i = 0; i < 3; ++i)
            transpose(K[i * row], K[i * row + column], K[i * row + 2 * column], lanes[i]);
        VISVIVA_FLATTEN
        for (int l = 0; l < W; ++l) {
            if (place[l] < 0) continue;
            double* to = values + place[l];
            V4 sum[3];  // all loads before the first store, which they need not wait for then
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) sum[i] = three(to + i * length[l]) + lanes[i][l];
            VISVIVA_FLATTEN
            for (int i = 0; i < 3; ++i) put_three(to + i * length[l], sum[i]);
        }
    } else {
        for (int l = 0; l < W; ++l) {
            if (place[l] < 0) continue;
            double* to = values + place[l];
            for (int i = 0; i < D; ++i)
                for (int j = 0; j < D; ++j) to[i * length[l] + j] += K[i * row + j * column][l];
        }
    }
}

/// W blocks K[i][j] of element matrices, or their transposes, as they stand in the matrix.
struct SolidBlock {
    const V* K;
    bool transposed;
    VISVIVA_INLINE V operator()(int i, int j) const { return K[transposed ? 3 * j + i : 3 * i + j]; }
};

#if VISVIVA_WIDTH >= 4
/// Six numbers beside each other.
struct Six {
    V4 first;
    V2 last;
};

VISVIVA_INLINE void add_six(double* to, Six a) {
    const V4 first = *reinterpret_cast<const V4*>(to) + a.first;
    const V2 last = *reinterpret_cast<const V2*>(to + 4) + a.last;
    *reinterpret_cast<V4*>(to) = first;
    *reinterpret_cast<V2*>(to + 4) = last;
}

/// The six numbers of row i of two blocks, of every lane.
VISVIVA_INLINE void transpose(SolidBlock a, SolidBlock b, int i, Six* lanes) {
    const V in[6] = {a(i, 0), a(i, 1), a(i, 2), b(i, 0), b(i, 1), b(i, 2)};
    VISVIVA_FLATTEN
    for (int odd = 0; odd < 2; ++odd) {
        V pair[3];  // two numbers of every second lane
        VISVIVA_FLATTEN
        for (int k = 0; k < 3; ++k) {
            const V &x = in[2 * k], &y = in[2 * k + 1];
#if VISVIVA_WIDTH == 8
            pair[k] = odd ? __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15)
                          : __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
#else
            pair[k] =
                odd ? __builtin_shufflevector(x, y, 1, 5, 3, 7) : __builtin_shufflevector(x, y, 0, 4, 2, 6);
#endif
        }
        const V &p = pair[0], &q = pair[1], &last = pair[2];
#if VISVIVA_WIDTH == 8
        lanes[odd] = {__builtin_shufflevector(p, q, 0, 1, 8, 9), __builtin_shufflevector(last, last, 0, 1)};
        lanes[odd + 2] = {__builtin_shufflevector(p, q, 2, 3, 10, 11),
                          __builtin_shufflevector(last, last, 2, 3)};
        lanes[odd + 4] = {__builtin_shufflevector(p, q, 4, 5, 12, 13),
                          __builtin_shufflevector(last, last, 4, 5)};
        lanes[odd + 6] = {__builtin_shufflevector(p, q, 6, 7, 14, 15),
                          __builtin_shufflevector(last, last, 6, 7)};
#else
        lanes[odd] = {__builtin_shufflevector(p, q, 0, 1, 4, 5), __builtin_shufflevector(last, last, 0, 1)};
        lanes[odd + 2] = {__builtin_shufflevector(p, q, 2, 3, 6, 7),
                          __builtin_shufflevector(last, last, 2, 3)};
#endif
    }
}

/// Adds the blocks (a, b) and (a, c) of W elements if the matrix has all of them side by side, as those of
/// neighbours in rows of nodes; false if not.
template <int N>
VISVIVA_INLINE bool solid_scatter_pair(const SolidElement<3, N>& e, int a, int b, int c, SolidBlock of_b,
                                       SolidBlock of_c, double* values) {
    std::int64_t first[W], second[W];
    solid_places(e, a, b, first), solid_places(e, a, c, second);
    bool beside = true;
    for (int l = 0; l < W; ++l) beside = beside && first[l] >= 0 && second[l] == first[l] + 3;
    if (!beside) return false;
    const std::int64_t* length =
        e.v.length + (static_cast<std::int64_t>(e.block) * e.nodes() + a) * L8 + e.lane;
    VISVIVA_FLATTEN
    for (int i = 0; i < 3; ++i) {
        Six lanes[W];
        transpose(of_b, of_c, i, lanes);
        VISVIVA_FLATTEN
        for (int l = 0; l < W; ++l) add_six(values + first[l] + i * length[l], lanes[l]);
    }
    return true;
}
#endif

/// Adds the row of blocks (a, 0), (a, 1), ... of W element matrices K[a][b], of which a symmetric one holds
/// a <= b.
template <int D, int N>
VISVIVA_INLINE void solid_scatter_row(const SolidElement<D, N>& e, int a, const V* K, bool symmetric,
                                      double* values) {
    const int n = e.nodes();
    auto lower = [=](int b) { return symmetric && b < a; };
    auto block = [=](int b) { return K + (lower(b) ? b * n + a : a * n + b) * D * D; };
    auto scatter = [&](int b) {
        lower(b) ? solid_scatter_block<D, N, true>(e, a, b, block(b), values)
                 : solid_scatter_block<D, N, false>(e, a, b, block(b), values);
    };
    int k = 0;
#if VISVIVA_WIDTH >= 4
    for (; D == 3 && k + 2 <= n; k += 2) {
        const bool back =
            N == 8 && k % 4 == 2;  // around the faces of bricks every second edge runs backwards
        const int b = back ? k + 1 : k, c = back ? k : k + 1;
        if constexpr (D == 3)
            if (solid_scatter_pair(e, a, b, c, {block(b), lower(b)}, {block(c), lower(c)}, values)) continue;
        scatter(b), scatter(c);
    }
#endif
    for (; k < n; ++k) scatter(k);
}

// The numbers of `rows` rows of W elements to where Python finds them, `size` to an element.
VISVIVA_INLINE void put_rows(const V* row, int rows, std::int64_t element, std::int64_t size,
                             std::int64_t first, int lanes, double* out) {
    for (int l = 0; l < lanes; ++l)
        for (int k = 0; k < rows; ++k) out[(element + l) * size + first + k] = row[k][l];
}

}  // namespace visviva::VISVIVA_ISA
