// One V-cycle of algebraic multigrid on aggregates that somebody else made.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "visviva/linear/krylov/precondition.hpp"

namespace visviva {

// What a matrix hardly resists, [slot][n], made when it is asked for.
struct NearNull {
    int n = 0;
    std::function<std::vector<double>()> modes = [] { return std::vector<double>(); };
};

// Multigrid of any matrix of blocks.
class Grids {
  public:
    virtual ~Grids() = default;
    // Takes the matrix; of its pattern and modes, in a life of the grids, the first is asked alone.
    virtual bool build(const BlockReader& finest, const NearNull& near) = 0;
    virtual void apply(const double* r, double* z) = 0;
    // How many iterations the last solution took: grids serve later matrices until they take half as many
    // again.
    virtual void learn(int iterations) = 0;
    virtual bool serve() const = 0;
    virtual void forget() = 0;
    virtual double memory() const = 0;
    std::string message;
};

std::unique_ptr<Grids> make_grids(const Aggregator& aggregator);

}  // namespace visviva
