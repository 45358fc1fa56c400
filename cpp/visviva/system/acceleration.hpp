// Anderson's acceleration of Newton's method with a kept tangent.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <vector>

namespace visviva {

/// An iteration with a kept tangent, x <- x + d(x), contracts its error by the same few slow parts again and
/// again. The last increments tell how d answers to a change of x; that combination of them is taken which
/// leaves the least of d (Anderson 1965; Walker & Ni 2011, eq. (2.2)).
class Acceleration {
  public:
    bool runs() const { return known_; }
    void forget() { n_ = 0, last_ = -1, known_ = false; }

    /// Turns the increment d of the kept tangent into the accelerated one; weight: of each unknown's error,
    /// zero for those that are not judged. d may have more numbers than there are unknowns.
    void apply(std::vector<double>& d, const std::vector<double>& weight) {
        const std::size_t n = weight.size();
        if (known_) {
            const int k = last_ = (last_ + 1) % depth;
            change_[k].resize(n), moved_[k].resize(n);
            for (std::size_t i = 0; i < n; ++i) change_[k][i] = d[i] - raw_[i], moved_[k][i] = taken_[i];
            n_ = std::min(n_ + 1, depth);
        }
        raw_ = d, known_ = true;
        if (n_ > 0) combine(d, weight);
        taken_ = d;
    }

  private:
    static constexpr int depth = 4;

    void combine(std::vector<double>& d, const std::vector<double>& weight) {
        Eigen::MatrixXd a(n_, n_);
        Eigen::VectorXd b(n_);
        for (int i = 0; i < n_; ++i) {
            b[i] = product(change_[i], raw_, weight);
            for (int j = 0; j <= i; ++j) a(i, j) = a(j, i) = product(change_[i], change_[j], weight);
        }
        const Eigen::VectorXd share = a.completeOrthogonalDecomposition().solve(b);
        if (!share.allFinite()) return;
        for (int i = 0; i < n_; ++i)
            for (std::size_t k = 0; k < weight.size(); ++k) d[k] -= share[i] * (change_[i][k] + moved_[i][k]);
    }

    static double product(const std::vector<double>& a, const std::vector<double>& b,
                          const std::vector<double>& weight) {
        double sum = 0;
        for (std::size_t i = 0; i < weight.size(); ++i) sum += weight[i] * weight[i] * a[i] * b[i];
        return sum;
    }

    std::vector<double> change_[depth], moved_[depth], raw_, taken_;
    int n_ = 0, last_ = -1;
    bool known_ = false;
};

}  // namespace visviva
