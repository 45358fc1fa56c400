// The coarser levels of a matrix, before their values.
#pragma once
#include <vector>

namespace visviva {

// Block rows joined on a coarser level, and the tentative way back from there.
struct Aggregates {
    int n = 0;                 // aggregates
    int cols = 1;              // freedoms of each
    std::vector<int> of;       // the aggregate of a block row, or -1
    std::vector<float> block;  // [block row][row][col]
};

}  // namespace visviva
