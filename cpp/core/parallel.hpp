// Loops over independent tasks. What the tasks are never depends on how many threads there are, and tasks of
// one loop touch different data, so results are the same bits for any number of threads.
#pragma once
#include <algorithm>
#include <cstddef>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace visviva {

template <class F>
void parallel_for(int n, F f) {
#ifdef _OPENMP
    if (n > 1 && omp_get_max_threads() > 1) {
#pragma omp parallel for schedule(dynamic)
        for (int i = 0; i < n; ++i) f(i);
        return;
    }
#endif
    for (int i = 0; i < n; ++i) f(i);
}

// Zeros, by several threads where there are many.
template <class Array>
void set_zero(Array& a) {
    constexpr std::size_t chunk = 1 << 17;
    const std::size_t n = a.size();
    parallel_for(static_cast<int>((n + chunk - 1) / chunk), [&](int i) {
        std::fill(a.begin() + i * chunk, a.begin() + std::min(n, (i + 1) * chunk), 0.0);
    });
}

}  // namespace visviva
