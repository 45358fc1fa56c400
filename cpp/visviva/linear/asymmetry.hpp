// How far a matrix is from a symmetric one, whatever the units of its unknowns.
#pragma once
#include <cstdint>
#include <span>

namespace visviva {

// The largest difference of an entry from that across the diagonal, and in which row it stands.
struct Asymmetry {
    double size = 0;
    int row = -1;
};

// Of a matrix in compressed rows, the columns of each in order. Rows and columns are scaled by their
// diagonal, so that units do not count and constraints do not either; those without one by their largest
// entry. Where something is larger than one then, both its row and its column share in taking it down.
Asymmetry asymmetry(std::span<const std::int64_t> row, std::span<const int> col,
                    std::span<const double> value);

}  // namespace visviva
