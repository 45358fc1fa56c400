#pragma once
#include <chrono>

namespace visviva {

// Adds the seconds of its life by the clock, if there is a sum.
class Lap {
  public:
    explicit Lap(double* sum) : sum_(sum) {
        if (sum_) start_ = Clock::now();
    }
    Lap(const Lap&) = delete;
    Lap& operator=(const Lap&) = delete;
    ~Lap() {
        if (sum_) *sum_ += std::chrono::duration<double>(Clock::now() - start_).count();
    }

  private:
    using Clock = std::chrono::steady_clock;
    double* sum_;
    Clock::time_point start_;
};

}  // namespace visviva
