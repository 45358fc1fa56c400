// Numeric part of the block LU solver: compiled once per instruction set, hence no templates of the library.
// The including file defines VISVIVA_ISA, the name of the namespace that keeps the variants apart.
#pragma once

#include "visviva/base/simd.hpp"
#include "visviva/linear/block_lu.hpp"

#if defined(__clang__)
#define VISVIVA_UNROLL _Pragma("clang loop unroll(full)")
#else
#define VISVIVA_UNROLL _Pragma("GCC unroll 8")
#endif

namespace visviva::VISVIVA_ISA::block_lu {

VISVIVA_INLINE VI first_lanes(int count) {
    static const long long number[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    VI lane;
    __builtin_memcpy(&lane, number, sizeof lane);
    return lane < static_cast<long long>(count);
}

// The first `count` lanes, zeros behind.
VISVIVA_INLINE V head(V v, int count) { return first_lanes(count) ? v : V{}; }

// Copies lines one behind the other. May run over the end by less than W numbers.
VISVIVA_INLINE double* copy_lines(double* to, const double* from, std::ptrdiff_t stride, int lines,
                                  int count) {
    for (int j = 0; j < lines; ++j, to += count)
        for (int i = 0; i < count; i += W) vstore(to + i, vload(from + j * stride + i));
    return to;
}

// A pivot block P D = L U. N is its size, or 0 for any size up to the largest.
template <int N>
struct Diagonal {
    static constexpr int capacity = N > 0 ? N : lu_max_block;
    static constexpr int width = (capacity + 7) / 8 * 8;
    int size;
    int row[capacity];         // original row of each row
    double inverse[capacity];  // of the diagonal of U
    double l[capacity][capacity];
    alignas(64) double u[capacity][width];
    alignas(64) double scale[width];
    alignas(64) double inverse_l[capacity][width];  // columns of inv(L) P
    alignas(64) double inverse_u[capacity][width];  // columns of inv(U)

    int n() const { return N > 0 ? N : size; }
    int padded() const { return (n() + W - 1) / W * W; }
};

template <int N>
void fetch(const LuView& view, const LuPivot& pivot, double regularization, Diagonal<N>& d) {
    d.size = pivot.n;
    const int n = d.n();
    const double* from = view.upper + pivot.data;
    for (int c = 0; c < d.padded(); c += W) {
        VISVIVA_UNROLL
        for (int i = 0; i < n; ++i) vstore(&d.u[i][c], head(vload(from + i * (n + pivot.r) + c), n - c));
    }
    VISVIVA_UNROLL
    for (int i = 0; i < n; ++i) {
        const double seen = view.scale[pivot.x + i];
        d.u[i][i] -= regularization * seen * view.multiplier[pivot.x + i];
        d.scale[i] = seen;
        d.row[i] = i;
    }
}

template <int N>
void exchange(Diagonal<N>& d, int i, int j) {
    for (int c = 0; c < d.padded(); c += W) {
        const V v = vload(&d.u[i][c]);
        vstore(&d.u[i][c], vload(&d.u[j][c]));
        vstore(&d.u[j][c], v);
    }
    for (int c = 0; c < d.n(); ++c) {
        const double v = d.l[i][c];
        d.l[i][c] = d.l[j][c];
        d.l[j][c] = v;
    }
    const int row = d.row[i];
    d.row[i] = d.row[j];
    d.row[j] = row;
}

// Gaussian elimination with row exchanges. A pivot is zero when it is round-off of what made it.
template <int N>
bool decompose(Diagonal<N>& d) {
    constexpr double round_off = 1e-14, largest = 1.7e308;
    const int n = d.n();
    VISVIVA_UNROLL
    for (int j = 0; j < n; ++j) {
        int best = j;
        double size = __builtin_fabs(d.u[j][j]);
        VISVIVA_UNROLL
        for (int i = j + 1; i < n; ++i) {
            const double other = __builtin_fabs(d.u[i][j]);
            best = other > size ? i : best;
            size = other > size ? other : size;
        }
        if (best != j) exchange(d, best, j);
        const double a = d.scale[j], b = d.scale[d.row[j]];
        double made = a < b ? a : b;
        for (int k = 0; k < j; ++k) {
            const double part = __builtin_fabs(d.l[j][k] * d.u[k][j]);
            made = part > made ? part : made;
        }
        if (!(size > round_off * made && size < largest)) return false;
        d.inverse[j] = 1.0 / d.u[j][j];
        VISVIVA_UNROLL
        for (int i = j + 1; i < n; ++i) {
            const double factor = d.u[i][j] * d.inverse[j];
            d.l[i][j] = factor;
            for (int c = 0; c < d.padded(); c += W)
                vstore(&d.u[i][c], vload(&d.u[i][c]) - factor * vload(&d.u[j][c]));
        }
    }
    return true;
}

// v := inv(L) v, by rows.
template <int N>
inline void divide_by_l(const Diagonal<N>& d, V* v) {
    const int n = d.n();
    VISVIVA_UNROLL
    for (int i = 1; i < n; ++i) {
        VISVIVA_UNROLL
        for (int a = 0; a < i; ++a) v[i] -= d.l[i][a] * v[a];
    }
}

// v := v inv(U), by columns.
template <int N>
inline void divide_by_u(const Diagonal<N>& d, V* v) {
    const int n = d.n();
    VISVIVA_UNROLL
    for (int j = 0; j < n; ++j) {
        VISVIVA_UNROLL
        for (int a = 0; a < j; ++a) v[j] -= d.u[a][j] * v[a];
        v[j] *= d.inverse[j];
    }
}

// v := v inv(L), by columns.
template <int N>
VISVIVA_INLINE void divide_by_l_right(const Diagonal<N>& d, V* v) {
    const int n = d.n();
    VISVIVA_UNROLL
    for (int j = n - 2; j >= 0; --j) {
        VISVIVA_UNROLL
        for (int a = j + 1; a < n; ++a) v[j] -= d.l[a][j] * v[a];
    }
}

// Lanes c... of the columns of the identity.
VISVIVA_INLINE void identity(V* v, int n, int c) {
    VISVIVA_UNROLL
    for (int i = 0; i < n; ++i) v[i] = first_lanes(i + 1 - c) & ~first_lanes(i - c) ? V{} + 1.0 : V{};
}

// The triangular inverses make the sweeps of a solution products without a chain of divisions.
template <int N>
void invert(Diagonal<N>& d) {
    const int n = d.n();
    V v[Diagonal<N>::capacity];
    for (int c = 0; c < d.padded(); c += W) {
        identity(v, n, c);
        divide_by_l_right(d, v);
        VISVIVA_UNROLL
        for (int i = 0; i < n; ++i) vstore(&d.inverse_l[d.row[i]][c], v[i]);
        identity(v, n, c);
        divide_by_u(d, v);
        VISVIVA_UNROLL
        for (int i = 0; i < n; ++i) vstore(&d.inverse_u[i][c], v[i]);
    }
}

// Eliminates inside the panels: inv(L) P upper and lower inv(U) go to the scratch lines u and l.
template <int N>
void divide_panels(const LuView& view, const LuPivot& pivot, const Diagonal<N>& d, double* u, double* l) {
    const int n = d.n(), width = n + pivot.r;
    const double* upper = view.upper + pivot.data + n;
    const double* lower = view.lower + pivot.data + n;
    V a[Diagonal<N>::capacity], b[Diagonal<N>::capacity];
    for (int c = 0; c < pivot.r; c += W) {
        VISVIVA_UNROLL
        for (int i = 0; i < n; ++i) a[i] = head(vload(upper + d.row[i] * width + c), pivot.r - c);
        VISVIVA_UNROLL
        for (int i = 0; i < n; ++i) b[i] = head(vload(lower + i * width + c), pivot.r - c);
        divide_by_l(d, a);
        divide_by_u(d, b);
        V size{};
        VISVIVA_UNROLL
        for (int i = 0; i < n; ++i) {
            vstore(u + i * view.line + c, a[i]);
            vstore(l + i * view.line + c, b[i]);
            size += vabs(a[i] * b[i]);
        }
        const int* rows = view.rows + pivot.rows + c;
        for (int i = 0; i < W && c + i < pivot.r; ++i) view.scale[rows[i]] += size[i];
    }
}

// to[i][c] -= sum over a of factor[a][i] * line[a][c], i < height, c < count.
//
// A store runs over the end of a short line into the next one, with the values that were there. The next line
// is loaded before that: correct, and it need not wait for the store.
template <int N>
inline void subtract_product(double* to, int width, int height, int n_runtime, const double* factor,
                             const double* line, std::ptrdiff_t stride, int count) {
    const int n = N > 0 ? N : n_runtime;
    V v[Diagonal<N>::capacity];
    for (int c = 0; c < count; c += W) {
        VISVIVA_UNROLL
        for (int a = 0; a < n; ++a) v[a] = head(vload(line + a * stride + c), count - c);
        double* at = to + c;
        V next = vload(at);
        for (int i = 0; i < height; ++i, at += width) {
            V sum = next;
            next = vload(i + 1 < height ? at + width : at);
            VISVIVA_UNROLL
            for (int a = 0; a < n; ++a) sum -= factor[a * stride + i] * v[a];
            vstore(at, sum);
        }
    }
}

template <int N>
void update_targets(const LuView& view, const LuPivot& pivot, const double* u, const double* l) {
    for (int t = pivot.target; t < pivot.target_end; ++t) {
        const LuTarget& target = view.targets[t];
        int skip = target.n;  // the diagonal block belongs to the upper panel
        for (int k = target.run; k < target.run_end; ++k) {
            const LuRun& run = view.runs[k];
            subtract_product<N>(view.upper + target.data + run.to, target.width, target.n, pivot.n,
                                l + target.row, u + run.from, view.line, run.count);
            subtract_product<N>(view.lower + target.data + run.to + skip, target.width, target.n, pivot.n,
                                u + target.row, l + run.from + skip, view.line, run.count - skip);
            skip = 0;
        }
    }
}

// Leaves in the slabs what `LuPivot` describes; the numbers behind the slabs are restored.
template <int N>
void keep(const LuView& view, const LuPivot& pivot, const Diagonal<N>& d, const double* u, const double* l) {
    const int n = d.n();
    double* first = view.upper + pivot.data;
    double* second = view.lower + pivot.data;
    const std::ptrdiff_t size = n * (n + pivot.r);
    const V behind_first = vload(first + size), behind_second = vload(second + size);
    first = copy_lines(first, d.inverse_l[0], d.width, n, n);
    first = copy_lines(first, l, view.line, n, pivot.r);
    for (int q = 0; q < pivot.r; ++q) {
        VISVIVA_UNROLL
        for (int i = 0; i < n; ++i) *second++ = u[i * view.line + q];
    }
    second = copy_lines(second, d.inverse_u[0], d.width, n, n);
    vstore(first, behind_first);
    vstore(second, behind_second);
}

template <int N>
bool eliminate(const LuView& view, const LuPivot& pivot, double regularization) {
    Diagonal<N> d;
    fetch(view, pivot, regularization, d);
    if (!decompose(d)) return false;
    double* u = view.scratch;
    double* l = view.scratch + lu_max_block * view.line;
    divide_panels(view, pivot, d, u, l);
    update_targets<N>(view, pivot, u, l);
    invert(d);
    keep(view, pivot, d, u, l);
    return true;
}

// acc += matrix * s, the matrix by columns of n numbers, s[at[j]] or s[j] its factors.
template <int N>
struct Column {
    static constexpr int n_parts = (Diagonal<N>::capacity + W - 1) / W;
    V part[n_parts];

    void add(const double* column, double factor, int parts) {
        VISVIVA_UNROLL
        for (int c = 0; c < parts; ++c) part[c] += factor * vload(column + c * W);
    }
};

// x := matrix * x, n x n by columns; the vector may not overlap others.
template <int N>
inline void multiply(const double* matrix, double* x, int n_runtime) {
    const int n = N > 0 ? N : n_runtime, parts = (n + W - 1) / W;
    Column<N> even{}, odd{};
    int j = 0;
    VISVIVA_UNROLL
    for (; j + 1 < n; j += 2) {
        even.add(matrix + j * n, x[j], parts);
        odd.add(matrix + (j + 1) * n, x[j + 1], parts);
    }
    if (j < n) even.add(matrix + j * n, x[j], parts);
    VISVIVA_UNROLL
    for (int c = 0; c < parts; ++c) vstore(x + c * W, even.part[c] + odd.part[c]);
}

template <int N>
void forward(const LuView& view, const LuPivot& pivot, double* x) {
    const int n = N > 0 ? N : pivot.n;
    const double* matrix = view.upper + pivot.data;
    const int* rows = view.rows + pivot.rows;
    alignas(64) double y[Diagonal<N>::width];
    for (int i = 0; i < n; ++i) y[i] = x[pivot.x + i];
    multiply<N>(matrix, y, n);
    for (int i = 0; i < n; ++i) x[pivot.x + i] = y[i];
    matrix += n * n;
    for (int c = 0; c < pivot.r; c += W) {
        V sum{};
        VISVIVA_UNROLL
        for (int j = 0; j < n; ++j) sum += y[j] * vload(matrix + j * pivot.r + c);
        double part[W];
        vstore(part, sum);
        for (int i = 0; i < W && c + i < pivot.r; ++i) x[rows[c + i]] -= part[i];
    }
}

template <int N>
void backward(const LuView& view, const LuPivot& pivot, double* x) {
    const int n = N > 0 ? N : pivot.n, parts = (n + W - 1) / W, r = pivot.r;
    const double* matrix = view.lower + pivot.data;
    const int* rows = view.rows + pivot.rows;
    Column<N> even{}, odd{};
    int q = 0;
    for (; q + 1 < r; q += 2) {
        even.add(matrix + q * n, x[rows[q]], parts);
        odd.add(matrix + (q + 1) * n, x[rows[q + 1]], parts);
    }
    if (q < r) even.add(matrix + q * n, x[rows[q]], parts);
    alignas(64) double y[Diagonal<N>::width];
    for (int c = 0; c < parts; ++c) vstore(y + c * W, even.part[c] + odd.part[c]);
    for (int i = 0; i < n; ++i) y[i] = x[pivot.x + i] - y[i];
    multiply<N>(matrix + r * n, y, n);
    for (int i = 0; i < n; ++i) x[pivot.x + i] = y[i];
}

// Calls the instance for the pivot's size.
#define VISVIVA_BY_SIZE(function, size, ...) \
    switch (size) {                          \
        case 1:                              \
            return function<1>(__VA_ARGS__); \
        case 2:                              \
            return function<2>(__VA_ARGS__); \
        case 3:                              \
            return function<3>(__VA_ARGS__); \
        case 4:                              \
            return function<4>(__VA_ARGS__); \
        case 5:                              \
            return function<5>(__VA_ARGS__); \
        case 6:                              \
            return function<6>(__VA_ARGS__); \
        case 7:                              \
            return function<7>(__VA_ARGS__); \
        case 8:                              \
            return function<8>(__VA_ARGS__); \
        default:                             \
            return function<0>(__VA_ARGS__); \
    }

inline bool eliminate_any(const LuView& view, const LuPivot& pivot, double regularization) {
    VISVIVA_BY_SIZE(eliminate, pivot.n, view, pivot, regularization)
}

inline void forward_any(const LuView& view, const LuPivot& pivot, double* x) {
    VISVIVA_BY_SIZE(forward, pivot.n, view, pivot, x)
}

inline void backward_any(const LuView& view, const LuPivot& pivot, double* x) {
    VISVIVA_BY_SIZE(backward, pivot.n, view, pivot, x)
}

}  // namespace visviva::VISVIVA_ISA::block_lu

namespace visviva::VISVIVA_ISA {

/// Factorises in place; returns -1, or the caller's number of the block that is singular.
inline int lu_factor(const LuView& view, double regularization) {
    for (int i = 0; i < view.n; ++i) view.scale[i] = 0.0;
    for (int k = 0; k < view.n_pivots; ++k) {
        if (view.pivots[k].dependent != 0) view.repair(view.owner, k);
        if (!block_lu::eliminate_any(view, view.pivots[k], regularization)) return view.pivots[k].block;
    }
    return -1;
}

/// Replaces the right-hand side x by the solution.
inline void lu_solve(const LuView& view, double* x) {
    for (int k = 0; k < view.n_pivots; ++k) block_lu::forward_any(view, view.pivots[k], x);
    for (int k = view.n_pivots - 1; k >= 0; --k) block_lu::backward_any(view, view.pivots[k], x);
}

#undef VISVIVA_BY_SIZE
#undef VISVIVA_UNROLL

}  // namespace visviva::VISVIVA_ISA
