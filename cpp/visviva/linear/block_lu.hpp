// Sparse LU factorisation of matrices made of small dense blocks, as mechanisms have them.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace visviva {

/// The largest block the kernels take.
inline constexpr int lu_max_block = 64;

/// A run of consecutive columns of a pivot's panel that lie consecutively in a target's panel too.
struct LuRun {
    int from, to, count;
};

/// A later pivot block that receives a share of the Schur complement of an earlier one.
struct LuTarget {
    std::ptrdiff_t data;  // slab of the target
    int n, width;         // its size and the length of its lines
    int row;              // its first row in the panel of the pivot
    int run, run_end;     // columns from its own block onwards, as runs
};

/// One pivot block of size n with r coupled unknowns that are eliminated later.
///
/// It owns a slab of n lines of n + r numbers at `data` in each of two arenas. Before the factorisation
/// line i of `upper` is the matrix row i (diagonal block, then the coupled columns), and line j of `lower` is
/// the matrix column j (n unused numbers, then the coupled rows). The factorisation P D = L U of the diagonal
/// block replaces both by what the two sweeps of a solution read, in reading order:
/// `upper`: columns of inv(L) P, then the columns of lower * inv(U);
/// `lower`: the columns (n numbers each) of inv(L) P upper, then the columns of inv(U).
struct LuPivot {
    std::ptrdiff_t data;
    int n, r;
    int x;                   // first unknown
    int rows;                // first of its r entries in LuView::rows
    int target, target_end;  // in LuView::targets
    int block;               // the caller's number
    int dependent;           // rows that follow from others; -1: to be found out
};

/// Everything the kernels touch, as plain data.
struct LuView {
    int n, n_pivots;
    const LuPivot* pivots;
    const LuTarget* targets;
    const LuRun* runs;
    const int* rows;           // unknowns coupled to each pivot
    const double* multiplier;  // 1 where the regularising shift applies, else 0
    double* upper;
    double* lower;
    double* scale;    // per unknown: sum of the absolute elimination contributions to its diagonal entry
    double* scratch;  // 2 * lu_max_block lines of `line` numbers
    std::ptrdiff_t line;
    void (*repair)(void* owner, int pivot);  // called before a pivot with dependent rows is factorised
    void* owner;
};

/// Repair by `BlockLU` of a block with dependent rows: the outer product of `row` and `column` was added.
struct LuGauge {
    int x, n;  // first unknown and size of the block
    std::vector<double> row, column;
};

/// Kernels compiled for one instruction set; `factor` returns -1 or the caller's number of a singular block.
struct LuKernels {
    int (*factor)(const LuView&, double regularization);
    void (*solve)(const LuView&, double* x);
};

/// The kernels for the machine that runs.
const LuKernels& lu_kernels();

/// Element (r, c) of a stored block is `data[r * row_stride + c * column_stride]`; no data: structurally
/// zero.
struct LuBlock {
    double* data = nullptr;
    int row_stride = 0, column_stride = 0;
    explicit operator bool() const { return data != nullptr; }
    double& operator()(int r, int c) const { return data[r * row_stride + c * column_stride]; }
};

/// Direct solver for a matrix of small dense blocks with symmetric structure and unsymmetric values.
///
/// Rows are exchanged inside a pivot block only, so the order of blocks has to keep every leading part of the
/// matrix regular. Blocks therefore carry a stage: 0 for what is regular by itself (bodies), 1 for what
/// becomes regular when its neighbours of stage 0 are eliminated (joints), 2 for what needs neighbours of
/// stage 1 (constraints between joint coordinates), and so on. Among the blocks whose neighbours of lower
/// stage are all gone, the one with the fewest coupled unknowns comes next.
class BlockLU {
  public:
    /// Chooses the order and lays out the storage, which `set_zero` has cleared on return.
    ///
    /// sizes, stage: one number per block. pairs: coupled blocks, in either or both orders, repeats allowed.
    /// multiplier: one number per unknown, blocks after one another; nonzero where `factor` may regularise.
    /// Throws std::invalid_argument for sizes outside 1...lu_max_block and inconsistent lengths or indices.
    void analyze(const std::vector<int>& sizes, const std::vector<int>& stage,
                 const std::vector<std::pair<int, int>>& pairs, const std::vector<char>& multiplier);

    /// Clears the matrix. Necessary before filling it anew: a factorisation overwrites it.
    void set_zero();

    /// Storage of block (i, j), valid until the next `analyze`. Blocks that fill in are stored as well.
    LuBlock block(int i, int j);

    /// Factorises in place; false if a pivot block is singular to working precision or not finite.
    ///
    /// `regularization` (0, or well above 1e-14) times the sum of the absolute elimination contributions is
    /// subtracted from the diagonal entry of each multiplier, which makes redundant constraints solvable.
    bool factor(double regularization);

    /// Finds out in the next factorisation how many rows of each block with multipliers follow from the rest
    /// of the matrix; later factorisations make that many rows independent. Without `on` none are.
    void find_dependent(bool on);
    int n_dependent() const;  ///< Dependent rows of all blocks.

    /// Additions of the last factorisation to the matrix. The solution is then one of the singular system, if
    /// the right-hand side lets the added part vanish.
    const std::vector<LuGauge>& gauges() const { return gauges_; }

    /// Replaces the right-hand side by the solution; allowed after a successful `factor`.
    void solve(double* x) const;

    int n() const;                          ///< Number of unknowns.
    int offset(int block) const;            ///< First unknown of a block.
    std::size_t n_nonzeros() const;         ///< Stored matrix entries, fill included.
    int singular_block() const;             ///< The block at which `factor` failed, or -1.
    const std::vector<int>& order() const;  ///< Blocks in the order of elimination.

  private:
    LuView view() const;
    void repair(LuPivot& pivot);
    void lay_out(const std::vector<std::vector<int>>& coupled, const std::vector<int>& sizes);
    void connect(int pivot, const std::vector<std::vector<int>>& coupled, const std::vector<int>& sizes);

    std::vector<int> offset_, order_, position_;
    std::vector<int> coupled_start_, coupled_, column_;  // per pivot: later pivots and their first columns
    std::vector<LuPivot> pivots_;
    std::vector<LuTarget> targets_;
    std::vector<LuRun> runs_;
    std::vector<int> rows_;
    std::vector<double> multiplier_;
    std::vector<double> upper_, lower_, scale_, scratch_;
    std::vector<LuGauge> gauges_;
    std::ptrdiff_t line_ = 0;
    int singular_ = -1;
};

}  // namespace visviva
