// Loops over independent tasks. What the tasks are never depends on how many threads there are, and tasks of
// one loop touch different data, so results are the same bits for any number of threads.
#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace visviva {

// Asked for by any thread of the program; 0: none has. OpenMP's own number is that of the thread that sets
// it.
inline std::atomic<int> threads_asked{0};

// Threads of loops and of factorisations that are not ours.
inline int n_threads() {
#ifdef _OPENMP
    const int asked = threads_asked;
    return asked > 0 ? asked : omp_get_max_threads();
#else
    return 1;
#endif
}

inline void use_threads(int n) { threads_asked = n; }

template <class F>
void parallel_for(int n, F f) {
#ifdef _OPENMP
    if (n > 1 && n_threads() > 1) {
#pragma omp parallel for schedule(dynamic) num_threads(n_threads())
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
