// Numbers that carry derivatives, for geometry too intricate to differentiate by hand: dual numbers (forward)
// and a tape (reverse). A tape of dual numbers gives second derivatives.
// Included only by translation units compiled once per instruction set, inside their namespace.
#pragma once
#include <cmath>
#include <vector>

#ifndef VISVIVA_ISA
#error "dual.hpp belongs to the kernels: compile with -DVISVIVA_ISA=..."
#endif

namespace visviva::VISVIVA_ISA {

/// A value with derivatives in N directions.
template <int N>
struct Dual {
    double d[N] = {};
    double v = 0;
};

template <int N>
inline Dual<N> combined(double v, double a, const Dual<N>& u, double b, const Dual<N>& w) {
    Dual<N> r;
    for (int k = 0; k < N; ++k) r.d[k] = a * u.d[k] + b * w.d[k];
    r.v = v;
    return r;
}
template <int N>
inline Dual<N> chained(double v, double a, const Dual<N>& u) {
    Dual<N> r;
    for (int k = 0; k < N; ++k) r.d[k] = a * u.d[k];
    r.v = v;
    return r;
}
template <int N>
inline Dual<N> operator+(const Dual<N>& u, const Dual<N>& w) {
    return combined(u.v + w.v, 1, u, 1, w);
}
template <int N>
inline Dual<N> operator-(const Dual<N>& u, const Dual<N>& w) {
    return combined(u.v - w.v, 1, u, -1, w);
}
template <int N>
inline Dual<N> operator*(const Dual<N>& u, const Dual<N>& w) {
    return combined(u.v * w.v, w.v, u, u.v, w);
}
template <int N>
inline Dual<N> operator*(double c, const Dual<N>& u) {
    return chained(c * u.v, c, u);
}
template <int N>
inline Dual<N> operator+(const Dual<N>& u, double c) {
    return chained(u.v + c, 1, u);
}
template <int N>
inline Dual<N> reciprocal(const Dual<N>& u) {
    const double i = 1 / u.v;
    return chained(i, -i * i, u);
}
template <int N>
inline Dual<N> root(const Dual<N>& u) {
    const double s = std::sqrt(u.v);
    return chained(s, 0.5 / s, u);
}
template <int N>
inline void add_to(Dual<N>& sum, const Dual<N>& u) {
    for (int k = 0; k < N; ++k) sum.d[k] += u.d[k];
    sum.v += u.v;
}
template <int N>
inline void add_value(Dual<N>& sum, double c) {
    sum.v += c;
}
template <int N>
inline double value(const Dual<N>& u) {
    return u.v;
}

inline double reciprocal(double u) { return 1 / u; }
inline double root(double u) { return std::sqrt(u); }
inline void add_to(double& sum, double u) { sum += u; }
inline void add_value(double& sum, double c) { sum += c; }
inline double value(double u) { return u; }

/// Tape of computations, in order, to be walked backwards with K sets of adjoints. Part of it can be walked
/// and dropped early.
template <class T, int K>
class Tape {
  public:
    enum class Op : unsigned char { leaf, add, subtract, multiply, scale, reciprocal, root };

    void clear() { nodes_.clear(), value_.clear(), adjoint_.clear(); }
    int size() const { return static_cast<int>(nodes_.size()); }
    const T& value(int k) const { return value_[k]; }
    T& adjoint(int k, int set) { return adjoint_[k].set[set]; }
    int push(Op op, const T& v, int a = -1, int b = -1, double c = 0) {
        nodes_.push_back({op, a, b, c});
        value_.push_back(v);
        adjoint_.push_back({});
        return size() - 1;
    }
    /// Carries adjoints from the last entry down to `mark` back to what they depend on, and drops them.
    void walk_back(int mark) {
        for (int k = size() - 1; k >= mark; --k)
            for (int s = 0; s < K; ++s) back(k, s);
        nodes_.resize(mark), value_.resize(mark), adjoint_.resize(mark);
    }

  private:
    struct Node {
        Op op;
        int a, b;
        double c;
    };
    struct Adjoints {
        T set[K];
    };

    void back(int k, int s) {
        const Node& n = nodes_[k];
        const T& z = adjoint_[k].set[s];
        switch (n.op) {
            case Op::leaf:
                break;
            case Op::add:
                add_to(adjoint_[n.a].set[s], z), add_to(adjoint_[n.b].set[s], z);
                break;
            case Op::subtract:
                add_to(adjoint_[n.a].set[s], z), add_to(adjoint_[n.b].set[s], -1.0 * z);
                break;
            case Op::multiply:
                add_to(adjoint_[n.a].set[s], z * value_[n.b]), add_to(adjoint_[n.b].set[s], z * value_[n.a]);
                break;
            case Op::scale:
                add_to(adjoint_[n.a].set[s], n.c * z);
                break;
            case Op::reciprocal:
                add_to(adjoint_[n.a].set[s], -1.0 * (z * (value_[k] * value_[k])));
                break;
            case Op::root:
                add_to(adjoint_[n.a].set[s], 0.5 * (z * VISVIVA_ISA::reciprocal(value_[k])));
                break;
        }
    }

    std::vector<Node> nodes_;
    std::vector<T> value_;
    std::vector<Adjoints> adjoint_;
};

/// A number on the tape of its thread.
template <class T, int K>
struct Taped {
    using On = Tape<T, K>;
    using Op = typename On::Op;
    int id;

    static On& tape() {
        thread_local On t;
        return t;
    }
    static Taped make(Op op, const T& v, int a = -1, int b = -1, double c = 0) {
        return {tape().push(op, v, a, b, c)};
    }
    const T& v() const { return tape().value(id); }

    friend Taped operator+(Taped a, Taped b) { return make(Op::add, a.v() + b.v(), a.id, b.id); }
    friend Taped operator-(Taped a, Taped b) { return make(Op::subtract, a.v() - b.v(), a.id, b.id); }
    friend Taped operator*(Taped a, Taped b) { return make(Op::multiply, a.v() * b.v(), a.id, b.id); }
    friend Taped operator*(double c, Taped a) { return make(Op::scale, c * a.v(), a.id, -1, c); }
    friend Taped operator+(Taped a, double c) { return make(Op::scale, a.v() + c, a.id, -1, 1.0); }
    friend Taped reciprocal(Taped a) { return make(Op::reciprocal, VISVIVA_ISA::reciprocal(a.v()), a.id); }
    friend Taped root(Taped a) { return make(Op::root, VISVIVA_ISA::root(a.v()), a.id); }
    friend double value(Taped a) { return VISVIVA_ISA::value(a.v()); }
};

}  // namespace visviva::VISVIVA_ISA
