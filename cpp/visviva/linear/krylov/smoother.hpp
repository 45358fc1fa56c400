// Chebyshev's polynomial in a matrix with its diagonal blocks inverted: rows are independent, so results do
// not depend on who computes them. Threads take rows in pieces, and what a product is for is done while its
// rows are at hand. In single precision, which is all a preconditioner needs and half the memory traffic.
#pragma once
#include <vector>

#include "visviva/base/parallel.hpp"
#include "visviva/linear/block_rows.hpp"
#include "visviva/linear/sparse_dispatch.hpp"

namespace visviva {

// y = A x, and then work(i) for every number i of a piece of y.
template <class F>
void multiply(const BlockRows<float>& a, const std::vector<float>& x, std::vector<float>& y, F work) {
    constexpr int piece = 1024;  // block rows of a task
    in_pieces(a.n(), piece, [&](int begin, int end) {
        sparse_kernels().block_multiply_single(a.view(), x.data(), y.data(), begin, end);
        for (std::size_t i = static_cast<std::size_t>(begin) * a.rows,
                         n = static_cast<std::size_t>(end) * a.rows;
             i < n; ++i)
            work(i);
    });
}

void multiply(const BlockRows<float>& a, const std::vector<float>& x, std::vector<float>& y);

BlockRows<float> single(const BlockReader& a, double factor);

class Smoother {
  public:
    using Vector = std::vector<float>;

    // Of `factor` times the matrix.
    Smoother(const BlockReader& a, double factor);

    // Of errors those at the upper end of the spectrum.
    void damp_upper();
    // All errors, by `reduction` at least, of a symmetric positive definite matrix; returns the degree it
    // takes. No degree is high enough for one that is indefinite.
    int damp_all(float reduction);

    // x += p(D^-1 A) D^-1 (b - A x); with `zero` x counts as zero on entry.
    void smooth(const Vector& b, Vector& x, bool zero);
    // b - A x
    const Vector& defect(const Vector& b, const Vector& x);

    const BlockRows<float>& inverse() const { return inverse_; }  // of the blocks without the factor
    double upper() const { return upper_; }                       // end of the spectrum
    std::size_t size() const { return a_.size(); }
    double memory() const { return 4.0 * static_cast<double>(a_.value.size() + a_.col.size()); }

  private:
    void subtract(const Vector& step);

    BlockRows<float> a_, inverse_;
    int degree_ = 2;
    float lower_ = 0, upper_ = 1;
    Vector residual_, step_, scaled_;
};

}  // namespace visviva
