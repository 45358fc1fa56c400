#include "visviva/base/vectors.hpp"

#include <cmath>

#include "visviva/base/parallel.hpp"

namespace visviva {

namespace {

constexpr int piece = 1024;  // numbers that are summed up together
constexpr int task = 8 * piece;

template <class F>
void in_tasks(const Vector& y, F f) {
    in_pieces(static_cast<int>(y.size()), task, f);
}

double sum_of(const double* a, const double* b, int n) {
    double part[8] = {};
    int i = 0;
    for (; i + 8 <= n; i += 8)
        for (int l = 0; l < 8; ++l) part[l] += a[i + l] * b[i + l];
    for (; i < n; ++i) part[0] += a[i] * b[i];
    return ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
}

// Sums up what f makes of every piece.
template <class F>
double sum(const Vector& y, F f) {
    std::vector<double> part((y.size() + piece - 1) / piece);
    in_tasks(y, [&](int begin, int end) {
        for (int i = begin; i < end; i += piece) part[i / piece] = f(i, std::min(i + piece, end));
    });
    double all = 0;
    for (double p : part) all += p;
    return all;
}

}  // namespace

double dot(const Vector& a, const Vector& b) {
    return sum(a, [&](int begin, int end) { return sum_of(&a[begin], &b[begin], end - begin); });
}

double norm(const Vector& a) { return std::sqrt(dot(a, a)); }

void scale(double factor, Vector& y) {
    in_tasks(y, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) y[i] *= factor;
    });
}

void add(double factor, const Vector& x, Vector& y) {
    in_tasks(y, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) y[i] += factor * x[i];
    });
}

void scale_add(double factor, Vector& y, const Vector& x) {
    in_tasks(y, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) y[i] = factor * y[i] + x[i];
    });
}

double add_dot(double factor, const Vector& x, Vector& y, const Vector& z) {
    return sum(y, [&](int begin, int end) {
        for (int i = begin; i < end; ++i) y[i] += factor * x[i];
        return sum_of(&y[begin], &z[begin], end - begin);
    });
}

}  // namespace visviva
