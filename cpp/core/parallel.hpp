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

}  // namespace visviva
