// Long vectors of iterative solvers. Sums are made of pieces of fixed length, and are the same bits for any
// number of threads.
#pragma once
#include <vector>

namespace visviva {

using Vector = std::vector<double>;

double dot(const Vector& a, const Vector& b);
double norm(const Vector& a);
void scale(double factor, Vector& y);
/// y += factor x
void add(double factor, const Vector& x, Vector& y);
/// y = factor y + x
void scale_add(double factor, Vector& y, const Vector& x);
/// y += factor x; returns y . z
double add_dot(double factor, const Vector& x, Vector& y, const Vector& z);

}  // namespace visviva
