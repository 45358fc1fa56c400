// Plain data of a batch of elements whose strains are sums of products of interpolated vectors and are
// sampled at points of their own (assumed natural strains), with an energy quadratic in all of them. Vectors
// have three components. Arrays of elements are [block][...][8].
#pragma once
#include <cstdint>

#include "visviva/term/step.hpp"

namespace visviva {

/// Adds factor x (left . right) to a strain.
struct AssumedProduct {
    int strain, left, right;
    double factor;
};

/// Slots [begin, end) that an interpolated vector sees.
struct AssumedRange {
    int begin, end;
};

struct AssumedView {
    int n = 0, n_blocks = 0;
    int n_slots = 0, n_samples = 0, n_strains = 0, n_products = 0;
    const int* index = nullptr;             // [slot] first unknown
    const double* weights = nullptr;        // [sample][slot], of all elements
    const AssumedRange* seen = nullptr;     // [sample]
    const AssumedRange* touched = nullptr;  // [strain]
    const AssumedProduct* product = nullptr;
    const char* couples = nullptr;      // [strain][strain]: whether any element has stiffness there
    const double* stiffness = nullptr;  // [a <= b] packed
    const double* reference = nullptr;  // [strain] of the reference
    // Places in the matrix, see Slots
    const std::int64_t *row = nullptr, *length = nullptr;
    const std::uint16_t* offset = nullptr;
};

}  // namespace visviva
