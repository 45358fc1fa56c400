// Estimate of the remaining error from Newton's increments.
#include <doctest/doctest.h>

#include <initializer_list>

#include "visviva/system/convergence.hpp"

namespace {
/// Whether the last of increments, each by a tangent of its own, is taken for the end.
bool ends(std::initializer_list<double> increments, double tolerance = 1e-13) {
    double contraction = 0;
    visviva::Convergence convergence(0, contraction);
    bool done = false;
    int k = 0;
    for (double size : increments) {
        convergence.renew(k);
        convergence.judge(k++, size);
        done = convergence.is_there(tolerance, 1e-16, 0);
    }
    return done;
}
}  // namespace

TEST_CASE("an increment ends the iteration by how fast those before it fell") {
    CHECK(ends({1e-2, 1e-4, 1e-8, 1e-16}));
    CHECK(ends({0.5, 1e-16}));  // a linear system
    CHECK_FALSE(ends({1e-2, 1e-4, 1e-8}, 1e-15));
}

TEST_CASE("a return from far outside the model is no contraction") {
    CHECK_FALSE(ends({7e-3, 5e-2, 0.7, 10, 3e9, 2e12, 2e12, 9e-3}));
    CHECK_FALSE(ends({1e3, 1e-6}, 1e-13));
    CHECK(ends({7e-3, 10, 2e12, 9e-3, 3e-4, 4e-7, 1e-13}));
}

TEST_CASE("two increments by tangents just made, the second hardly less, are a stall") {
    double contraction = 0;
    visviva::Convergence convergence(0.3, contraction);
    convergence.judge(0, 1e-3), convergence.judge(1, 9e-4);
    CHECK_FALSE(convergence.stalls());  // the tangent was kept
    convergence.renew(2), convergence.judge(2, 8e-4);
    CHECK_FALSE(convergence.stalls());  // the first one by the new tangent
    convergence.judge(3, 8e-4);
    CHECK(convergence.stalls());
    convergence.renew(4), convergence.judge(4, 8e-4);
    convergence.renew(5), convergence.judge(5, 8e-4);
    CHECK(convergence.stalls());
    convergence.renew(6), convergence.judge(6, 1e-4);
    CHECK_FALSE(convergence.stalls());
}
