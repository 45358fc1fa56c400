// Strain maps: strains that are polynomials of second order in local unknowns, written once; their values,
// rows and second derivatives follow at compile time.
#pragma once
#include <utility>

#include "visviva/base/simd.hpp"

namespace visviva::VISVIVA_ISA {

/// constant + linear . y + 1/2 y . square y of n local unknowns: a number type for strain maps at compile
/// time.
template <int n>
struct Quadratic {
    double constant = 0, linear[n] = {}, square[n][n] = {};

    static constexpr Quadratic variable(int k) {
        Quadratic q;
        q.linear[k] = 1;
        return q;
    }
    constexpr bool is_linear() const {
        for (const auto& row : square)
            for (double a : row)
                if (a != 0) return false;
        return true;
    }
};

template <int n>
constexpr Quadratic<n> operator*(double a, Quadratic<n> q) {
    q.constant *= a;
    for (int j = 0; j < n; ++j) {
        q.linear[j] *= a;
        for (int l = 0; l < n; ++l) q.square[j][l] *= a;
    }
    return q;
}
template <int n>
constexpr Quadratic<n> operator+(Quadratic<n> p, const Quadratic<n>& q) {
    p.constant += q.constant;
    for (int j = 0; j < n; ++j) {
        p.linear[j] += q.linear[j];
        for (int l = 0; l < n; ++l) p.square[j][l] += q.square[j][l];
    }
    return p;
}
template <int n>
constexpr Quadratic<n> operator-(const Quadratic<n>& p, const Quadratic<n>& q) {
    return p + -1.0 * q;
}
/// Of linear forms; a product of higher order stops the compiler.
template <int n>
constexpr Quadratic<n> operator*(const Quadratic<n>& p, const Quadratic<n>& q) {
    if (!p.is_linear() || !q.is_linear()) throw "strains are of second order at most";
    Quadratic<n> r;
    r.constant = p.constant * q.constant;
    for (int j = 0; j < n; ++j) {
        r.linear[j] = p.constant * q.linear[j] + q.constant * p.linear[j];
        for (int l = 0; l < n; ++l) r.square[j][l] = p.linear[j] * q.linear[l] + p.linear[l] * q.linear[j];
    }
    return r;
}

/// Calls f(0) to f(n - 1), with numbers known to the compiler unless there are too many.
template <int n, class F>
VISVIVA_INLINE void each(F&& f) {
    if constexpr (n <= 64)
        [&]<int... i>(std::integer_sequence<int, i...>) {
            (f(std::integral_constant<int, i>{}), ...);
        }(std::make_integer_sequence<int, n>{});
    else
        for (int i = 0; i < n; ++i) f(i);
}

/// Nonzero pattern of the strains of a map: Map::strains(y, e) fills n_strains of them from n_local
/// unknowns.
template <class Map>
struct Strains {
    static constexpr int n_e = Map::n_strains, n_y = Map::n_local;
    struct Linear {
        int k, j, at;  // strain, unknown, their entry
        double factor;
    };
    struct Square {
        int k, j, l, at;  // at: the entry of k and j
        double factor;
    };
    struct Entry {
        int k, j;
    };
    struct Table {
        Quadratic<n_y> e[n_e];
    };
    static constexpr Table table = [] {
        Table t;
        Quadratic<n_y> y[n_y];
        for (int k = 0; k < n_y; ++k) y[k] = Quadratic<n_y>::variable(k);
        Map::strains(y, t.e);
        return t;
    }();
    static constexpr bool depends(int k, int j) {
        if (table.e[k].linear[j] != 0) return true;
        for (double a : table.e[k].square[j])
            if (a != 0) return true;
        return false;
    }
    template <class F>
    static constexpr int count(F f) {
        int n = 0;
        for (int k = 0; k < n_e; ++k)
            for (int j = 0; j < n_y; ++j) n += f(k, j);
        return n;
    }
    static constexpr int squares_of(int k, int j) {
        int n = 0;
        for (double a : table.e[k].square[j]) n += a != 0;
        return n;
    }
    static constexpr int n_linear = count([](int k, int j) { return table.e[k].linear[j] != 0 ? 1 : 0; });
    static constexpr int n_entries = count([](int k, int j) { return depends(k, j) ? 1 : 0; });
    static constexpr int n_square = count(squares_of);

    struct Sparse {
        Linear linear[n_linear > 0 ? n_linear : 1];
        Square square[n_square > 0 ? n_square : 1];
        Entry entry[n_entries > 0 ? n_entries : 1];
        int first[n_e + 1], first_square[n_e + 1];  // of every strain among them
    };
    static constexpr Sparse sparse = [] {
        Sparse s{};
        int a = 0, b = 0, c = 0;
        for (int k = 0; k < n_e; ++k) {
            s.first[k] = c, s.first_square[k] = b;
            for (int j = 0; j < n_y; ++j) {
                if (const double f = table.e[k].linear[j]; f != 0) s.linear[a++] = {k, j, c, f};
                for (int l = 0; l < n_y; ++l)
                    if (const double f = table.e[k].square[j][l]; f != 0) s.square[b++] = {k, j, l, c, f};
                if (depends(k, j)) s.entry[c++] = {k, j};
            }
        }
        s.first[n_e] = c, s.first_square[n_e] = b;
        return s;
    }();

    /// Strains e [n_e] alone.
    static VISVIVA_INLINE void evaluate(const V* y, V* e) {
        for (int k = 0; k < n_e; ++k) e[k] = broadcast(table.e[k].constant);
        each<n_linear>(
            [&](auto i) { e[sparse.linear[i].k] += sparse.linear[i].factor * y[sparse.linear[i].j]; });
        each<n_square>([&](auto i) {
            const Square& q = sparse.square[i];
            e[q.k] += 0.5 * (q.factor * y[q.l]) * y[q.j];
        });
    }

    /// Rows B, de = B dy, of the entries that do not vanish [n_entries].
    static VISVIVA_INLINE void rows(const V* y, V* B) {
        for (int i = 0; i < n_entries; ++i) B[i] = V{};
        each<n_linear>([&](auto i) { B[sparse.linear[i].at] = broadcast(sparse.linear[i].factor); });
        each<n_square>([&](auto i) {
            const Square& q = sparse.square[i];
            B[q.at] += q.factor * y[q.l];
        });
    }
};

}  // namespace visviva::VISVIVA_ISA
