#include "visviva/linear/fill.hpp"

#include <vector>

namespace visviva {

// From the elimination tree (Liu 1990).
std::int64_t count_fill(const Eigen::SparseMatrix<double>& upper) {
    const int n = static_cast<int>(upper.cols());
    std::vector<int> parent(n, -1), seen(n, -1);
    std::int64_t total = n;
    for (int j = 0; j < n; ++j) {
        seen[j] = j;
        for (Eigen::SparseMatrix<double>::InnerIterator it(upper, j); it; ++it)
            for (int i = static_cast<int>(it.row()); i < j && seen[i] != j; i = parent[i]) {
                if (parent[i] < 0) parent[i] = j;
                ++total, seen[i] = j;
            }
    }
    return total;
}

}  // namespace visviva
