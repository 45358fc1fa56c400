#pragma once
#include <ctime>

namespace visviva {

// Adds the CPU time of its life.
class Stopwatch {
  public:
    explicit Stopwatch(double& sum) : sum_(sum), start_(std::clock()) {}
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;
    ~Stopwatch() { sum_ += static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC; }

  private:
    double& sum_;
    std::clock_t start_;
};

}  // namespace visviva
