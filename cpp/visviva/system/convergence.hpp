// Distance of Newton's method from its solution.
#pragma once
#include <algorithm>
#include <limits>

namespace visviva {

/// Tells from the sizes of the increments, one per iteration, what error remains.
class Convergence {
  public:
    /// `contraction`: the slowest seen per iteration since the tangent was made, kept from step to step.
    Convergence(double keep_factor, double& contraction)
        : keep_factor_(keep_factor), contraction_(contraction) {}

    /// Iteration k has a tangent of its own.
    void renew(int k) { first_ = std::min(first_, k), before_ = latest_, latest_ = k, contraction_ = 0; }

    /// The next increment says nothing by its ratio to the last.
    void forget() { last_ = 0; }

    /// Judges the increment of iteration k. What remains after it: with a tangent kept from earlier steps by
    /// the slowest contraction seen since it was made, and never better than 0.05, because a part that
    /// contracts slowly may show late. A second increment that is hardly less than the first tells of the
    /// multipliers before it, and nothing of contraction: that is then taken to be as slow as a kept tangent
    /// may be. A return from an excursion beyond the model tells of no contraction: a ratio is never taken to
    /// be better than an increment is small, as that of quadratic convergence near a solution.
    void judge(int k, double size) {
        k_ = k, size_ = size;
        ratio_ = k > 0 && last_ > 0 ? std::min(1.0, size / last_) : 0;
        const bool unknown = k == 1 && latest_ < 0 && ratio_ > keep_factor_;
        if (unknown) ratio_ = 0;
        contraction_ = std::max(contraction_, ratio_);
        const double least = unknown ? keep_factor_ : latest_ < 0 ? 0.05 : 1e-3;
        const double slowest =
            latest_ == k && k > 0 ? std::max(ratio_, std::min(size, 0.5)) : std::max(contraction_, least);
        error_ = slowest < 1 ? slowest / (1 - slowest) * size : size;
        last_ = size;
    }

    double last() const { return last_; }
    bool has_tangent() const { return latest_ >= 0; }  // one made in this step
    bool is_slow() const { return ratio_ > keep_factor_; }
    /// Too slow to be left as it is, not slow enough for a new tangent.
    bool is_sluggish() const { return ratio_ > 0.1; }
    /// Two increments in a row by tangents just made, and the second hardly less: nothing gets nearer.
    bool stalls() const {
        return ratio_ > 0.5 && (latest_ == k_ - 1 || (latest_ == k_ && before_ == k_ - 1));
    }

    /// The relative residual that solutions of iteration k may leave: with a kept tangent the error of the
    /// tangent is larger.
    double enough(int k) const { return latest_ == k ? 0 : std::min(0.05, 0.1 * ratio_); }

    /// Whether the error is small enough. Contraction that stops at the rounding of the constraints, or with
    /// the tangent just made, has met rounding, or a jump of the residual where it is finer than the
    /// `resolution` of terms.
    bool is_there(double tolerance, double noise, double resolution) const {
        const bool renewed = first_ < k_ && latest_ >= k_ - 1;
        const bool stops =
            ratio_ > 0.5 && (size_ < noise || (renewed && size_ < std::max(1e-10, resolution)));
        const bool settled = k_ > 0 || latest_ == 0 || size_ == 0;
        return settled && (stops || error_ <= tolerance);
    }

  private:
    double keep_factor_, &contraction_;
    double last_ = 0, size_ = 0, ratio_ = 0, error_ = 0;
    int k_ = 0, first_ = std::numeric_limits<int>::max(), latest_ = -1, before_ = -1;
};

}  // namespace visviva
