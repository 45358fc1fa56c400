// Loops over independent tasks. What the tasks are never depends on how many threads there are, and tasks of
// one loop touch different data, so results are the same bits for any number of threads.
#pragma once
#include <algorithm>
#include <cstddef>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace visviva {

// Threads of loops and of factorisations that are not ours.
inline int n_threads() {
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

inline void use_threads([[maybe_unused]] int n) {
#ifdef _OPENMP
    omp_set_num_threads(n);
#endif
}

template <class F>
void parallel_for(int n, F f) {
#ifdef _OPENMP
    if (n > 1 && n_threads() > 1) {
#pragma omp parallel for schedule(dynamic)
        for (int i = 0; i < n; ++i) f(i);
        return;
    }
#endif
    for (int i = 0; i < n; ++i) f(i);
}

// Calls f(begin, end) for pieces of 0 .. n, which are always the same ones.
template <class F>
void in_pieces(int n, int piece, F f) {
    parallel_for((n + piece - 1) / piece, [&](int k) { f(k * piece, std::min(n, (k + 1) * piece)); });
}

}  // namespace visviva
