// Processes that share the terms of one system among them: each knows all unknowns and some of the terms.
#pragma once
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace visviva {

// What one process could not evaluate, all give up.
struct FailedElsewhere : std::runtime_error {
    explicit FailedElsewhere(const std::string& why)
        : std::runtime_error("another process found no value at the state that was tried: " + why) {}
};

// All functions are called by all processes, in the same order.
class Processes {
  public:
    virtual ~Processes() = default;
    /// Tells which unknowns have equations here; returns [unknown] those that belong here. Every one belongs
    /// to one of the processes in which it has an equation.
    virtual std::vector<char> own(const std::vector<int>& unknowns, int n) = 0;
    /// Sums over the processes in place; all get the same bits.
    virtual void sum(double* values, std::size_t n) = 0;
    virtual double largest(double value) = 0;
    /// Numbers by unknown: all get those of the owners.
    virtual void share(double* d, std::size_t n) = 0;
    /// Words and a number: all get those of the first process whose words are not empty.
    virtual void tell(std::string& words, int& number) = 0;

    bool any(bool here) { return largest(here ? 1.0 : 0.0) > 0; }
};

}  // namespace visviva
