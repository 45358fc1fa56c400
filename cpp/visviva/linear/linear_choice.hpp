// Choice of the linear solver and its options: plain data, filled by whoever knows the problem.
#pragma once
#include <functional>

#include "visviva/linear/aggregates.hpp"
#include "visviva/linear/block_rows.hpp"
#include "visviva/linear/linear.hpp"

namespace visviva {

enum class Backend { sparse_lu, cholesky, pardiso, krylov, staggered, outside };
// Known properties of the matrix. Definite: symmetric and positive definite.
enum class MatrixKind { definite, symmetric, general };
enum class KrylovMethod { cg, gmres, bicgstab };
enum class Preconditioner {
    none,
    diagonal,
    block,
    incomplete,
    multigrid,
    saddle,
    augmented,
    commutator,
    mixture
};

// Aggregates from level to level for the pattern of a matrix and its near-null vectors ([block row * rows +
// r][mode]).
using Aggregator =
    std::function<std::vector<Aggregates>(const BlockRows<double>& matrix, const double* modes, int n_modes)>;

// Makes a solver that does not belong to the core.
using OutsideSolver = std::function<std::unique_ptr<LinearSolver>()>;

struct LinearChoice {
    Backend backend = Backend::sparse_lu;
    MatrixKind kind = MatrixKind::general;
    double regularization = 0;
    bool last_resort = false;  // serves only when that is allowed
    // Whether the diagonal may vanish, so that PARDISO has to match rows and columns by the values; otherwise
    // its ordering knows the pattern alone, and lasts.
    bool matching = true;
    bool minimum_degree = false;  // instead of nested dissection: less fill in the plane, and sooner found
    double memory_limit = 0;      // bytes; 0: what the machine has available

    std::string library;  // path of oneMKL's single dynamic library; empty: where the system looks

    KrylovMethod method = KrylovMethod::cg;
    Preconditioner preconditioner = Preconditioner::block;
    double tolerance = 1e-6;  // of the residual, relative to the right-hand side
    int max_iterations = 500;
    int restart = 50;  // of GMRES
    Aggregator aggregator;
    // Equations from which multigrid has no matrix of its own: memory counts for more than a tenth of the
    // time.
    int borrow_from = 300'000;
    OutsideSolver outside;

    // Staggered: solvers of mechanics and of heat in the order of preference; by unknown whether it is
    // heat's.
    std::vector<LinearChoice> parts[2];
    std::vector<char> is_second;
};

// The first choice; where it fails, the next ones in their order.
std::unique_ptr<LinearSolver> make_linear(const std::vector<LinearChoice>& in_order);

std::unique_ptr<LinearSolver> make_cholesky(const LinearChoice&);
std::unique_ptr<LinearSolver> make_pardiso(const LinearChoice&);
std::unique_ptr<LinearSolver> make_krylov(const LinearChoice&);

// Why oneMKL cannot be used, or nothing if it can.
std::string missing_pardiso(const std::string& library);

// Memory in bytes that the system can give without swapping, 0 if it does not say.
double available_memory();
// The same of the groups of processes (cgroups) that the file names, with their limits below `root`; infinite
// without limits.
double left_in_groups(const std::string& groups, const std::string& root);
// Throws MemoryShortage if `bytes` exceed the limit (0: what is available).
void require_memory(double bytes, double limit, int n);

}  // namespace visviva
