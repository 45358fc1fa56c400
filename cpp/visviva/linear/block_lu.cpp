#include "visviva/linear/block_lu.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <queue>
#include <stdexcept>

namespace visviva {
namespace {

using Graph = std::vector<std::vector<int>>;

// Vector loads and stores of the kernels may run over the end of a line by less than this.
constexpr std::ptrdiff_t slack = 8;

void require(bool condition, const char* message) {
    if (!condition) throw std::invalid_argument(message);
}

void check(const std::vector<int>& sizes, const std::vector<int>& stage,
           const std::vector<std::pair<int, int>>& pairs, const std::vector<char>& multiplier) {
    const int n_blocks = static_cast<int>(sizes.size());
    std::size_t n = 0;
    for (int size : sizes) {
        require(size >= 1 && size <= lu_max_block, "BlockLU: a block has between 1 and 64 unknowns");
        n += static_cast<std::size_t>(size);
    }
    require(stage.size() == sizes.size(), "BlockLU: one stage per block is needed");
    require(multiplier.size() == n, "BlockLU: one multiplier flag per unknown is needed");
    for (auto [i, j] : pairs)
        require(i >= 0 && j >= 0 && i < n_blocks && j < n_blocks, "BlockLU: a pair names no block");
}

Graph neighbours(std::size_t n_blocks, const std::vector<std::pair<int, int>>& pairs) {
    Graph graph(n_blocks);
    for (auto [i, j] : pairs) {
        if (i == j) continue;
        graph[i].push_back(j);
        graph[j].push_back(i);
    }
    for (auto& list : graph) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    return graph;
}

// Minimum degree by explicit elimination: mechanisms stay sparse, so a quotient graph would not pay.
class Elimination {
  public:
    Elimination(Graph graph, const std::vector<int>& sizes, const std::vector<int>& stage)
        : graph_(std::move(graph)), original_(graph_), sizes_(sizes), stage_(stage) {
        const int n_blocks = static_cast<int>(sizes.size());
        waits_.assign(sizes.size(), 0);
        weight_.assign(sizes.size(), 0);
        for (int b = 0; b < n_blocks; ++b) {
            for (int p : original_[b]) waits_[b] += stage_[p] < stage_[b];
            weigh(b);
        }
    }

    // Calls visit(block, blocks coupled to it that are eliminated later) in the order of elimination.
    template <class Visit>
    void run(Visit visit) {
        while (!queue_.empty()) {
            auto [weight, block] = queue_.top();
            queue_.pop();
            if (gone(block) || weight != weight_[block]) continue;
            eliminate(block);
            visit(block, std::move(graph_[block]));
        }
    }

  private:
    bool gone(int block) const { return weight_[block] < 0; }

    void weigh(int block) {
        long weight = 0;
        for (int p : graph_[block]) weight += sizes_[p];
        weight_[block] = weight;
        if (waits_[block] == 0) queue_.push({weight, block});
    }

    void eliminate(int block) {
        weight_[block] = -1;
        for (int p : original_[block]) waits_[p] -= stage_[block] < stage_[p];
        for (int p : graph_[block]) {
            merge(p, block);
            weigh(p);
        }
    }

    void merge(int p, int block) {
        const std::vector<int>& clique = graph_[block];
        merged_.clear();
        std::set_union(graph_[p].begin(), graph_[p].end(), clique.begin(), clique.end(),
                       std::back_inserter(merged_));
        std::erase_if(merged_, [&](int q) { return q == p || q == block; });
        graph_[p].assign(merged_.begin(), merged_.end());
    }

    using Entry = std::pair<long, int>;
    Graph graph_, original_;
    const std::vector<int>& sizes_;
    const std::vector<int>& stage_;
    std::vector<int> waits_, merged_;
    std::vector<long> weight_;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

void BlockLU::analyze(const std::vector<int>& sizes, const std::vector<int>& stage,
                      const std::vector<std::pair<int, int>>& pairs, const std::vector<char>& multiplier) {
    check(sizes, stage, pairs, multiplier);
    *this = BlockLU();
    offset_.assign(sizes.size() + 1, 0);
    for (std::size_t b = 0; b < sizes.size(); ++b) offset_[b + 1] = offset_[b] + sizes[b];
    for (char flag : multiplier) multiplier_.push_back(flag != 0 ? 1.0 : 0.0);
    position_.assign(sizes.size(), 0);

    Graph coupled;
    Elimination(neighbours(sizes.size(), pairs), sizes, stage).run([&](int block, std::vector<int> later) {
        position_[block] = static_cast<int>(order_.size());
        order_.push_back(block);
        coupled.push_back(std::move(later));
    });
    for (auto& list : coupled) {
        for (int& b : list) b = position_[b];
        std::sort(list.begin(), list.end());
    }
    lay_out(coupled, sizes);
}

// Numbers in `coupled` are positions in the order of elimination from here on.
void BlockLU::lay_out(const std::vector<std::vector<int>>& coupled, const std::vector<int>& sizes) {
    std::ptrdiff_t data = 0, widest = 0;
    coupled_start_.push_back(0);
    for (std::size_t k = 0; k < coupled.size(); ++k) {
        const int block = order_[k], n = sizes[block];
        const int rows = static_cast<int>(rows_.size());
        for (int p : coupled[k]) {
            coupled_.push_back(p);
            column_.push_back(static_cast<int>(rows_.size()) - rows);
            for (int i = 0; i < sizes[order_[p]]; ++i) rows_.push_back(offset_[order_[p]] + i);
        }
        coupled_start_.push_back(static_cast<int>(coupled_.size()));
        const int r = static_cast<int>(rows_.size()) - rows;
        pivots_.push_back({data, n, r, offset_[block], rows, 0, 0, block, 0});
        data += static_cast<std::ptrdiff_t>(n) * (n + r);
        widest = std::max<std::ptrdiff_t>(widest, r);
    }
    for (std::size_t k = 0; k < coupled.size(); ++k) connect(static_cast<int>(k), coupled, sizes);
    line_ = (widest + slack - 1) / slack * slack + slack;
    upper_.assign(static_cast<std::size_t>(data + slack), 0.0);
    lower_.assign(static_cast<std::size_t>(data + slack), 0.0);
    scale_.assign(static_cast<std::size_t>(offset_.back()), 0.0);
    scratch_.assign(static_cast<std::size_t>(2 * lu_max_block * line_), 0.0);
}

// Where each part of the Schur complement of a pivot goes.
void BlockLU::connect(int pivot, const std::vector<std::vector<int>>& coupled,
                      const std::vector<int>& sizes) {
    const std::vector<int>& list = coupled[pivot];
    const int* column = column_.data() + coupled_start_[pivot];
    pivots_[pivot].target = static_cast<int>(targets_.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
        const int p = list[i], first_run = static_cast<int>(runs_.size());
        const LuPivot& to = pivots_[p];
        runs_.push_back({column[i], 0, to.n});
        std::size_t at = 0;
        for (std::size_t j = i + 1; j < list.size(); ++j) {
            while (coupled[p][at] != list[j]) ++at;
            const LuRun next{column[j], to.n + column_[coupled_start_[p] + at], sizes[order_[list[j]]]};
            LuRun& last = runs_.back();
            if (last.to + last.count == next.to)
                last.count += next.count;
            else
                runs_.push_back(next);
        }
        targets_.push_back(
            {to.data, to.n, to.n + to.r, column[i], first_run, static_cast<int>(runs_.size())});
    }
    pivots_[pivot].target_end = static_cast<int>(targets_.size());
}

void BlockLU::set_zero() {
    std::fill(upper_.begin(), upper_.end(), 0.0);
    std::fill(lower_.begin(), lower_.end(), 0.0);
}

LuBlock BlockLU::block(int i, int j) {
    const int first = std::min(position_[i], position_[j]), second = std::max(position_[i], position_[j]);
    const LuPivot& pivot = pivots_[first];
    const int width = pivot.n + pivot.r;
    if (i == j) return {upper_.data() + pivot.data, width, 1};
    const auto begin = coupled_.begin() + coupled_start_[first];
    const auto end = coupled_.begin() + coupled_start_[first + 1];
    const auto found = std::lower_bound(begin, end, second);
    if (found == end || *found != second) return {};
    const std::ptrdiff_t at = pivot.data + pivot.n + column_[found - coupled_.begin()];
    if (position_[i] == first) return {upper_.data() + at, width, 1};
    return {lower_.data() + at, 1, width};
}

bool BlockLU::factor(double regularization) {
    gauges_.clear();
    singular_ = lu_kernels().factor(view(), regularization);
    return singular_ < 0;
}

void BlockLU::find_dependent(bool on) {
    for (LuPivot& p : pivots_) {
        const double* flag = multiplier_.data() + p.x;
        p.dependent = on && std::any_of(flag, flag + p.n, [](double f) { return f != 0; }) ? -1 : 0;
    }
}

int BlockLU::n_dependent() const {
    int n = 0;
    for (const LuPivot& p : pivots_) n += std::max(p.dependent, 0);
    return n;
}

// The Schur complement of a block has lost rank where its rows follow from what is eliminated before. Its
// smallest singular values are then replaced by the largest one, in units in which the elimination
// contributions are one.
void BlockLU::repair(LuPivot& pivot) {
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    using Strided = Eigen::Map<Matrix, 0, Eigen::OuterStride<>>;
    constexpr double lost = 1e-8;
    const int n = pivot.n;
    Strided block(upper_.data() + pivot.data, n, n, Eigen::OuterStride<>(n + pivot.r));
    Eigen::VectorXd unit(n);
    for (int i = 0; i < n; ++i) {
        const double size = std::max(scale_[pivot.x + i], block.row(i).cwiseAbs().maxCoeff());
        unit[i] = size > 0 ? std::sqrt(size) : 1.0;
    }
    const Matrix scaled = unit.cwiseInverse().asDiagonal() * block * unit.cwiseInverse().asDiagonal();
    const Eigen::JacobiSVD<Matrix> svd(scaled, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const auto& s = svd.singularValues();
    if (pivot.dependent < 0)
        pivot.dependent =
            static_cast<int>(std::count_if(s.begin(), s.end(), [&](double v) { return v < lost * s[0]; }));
    for (int k = n - pivot.dependent; k < n; ++k) {
        const Eigen::VectorXd row = (s[0] - s[k]) * unit.cwiseProduct(svd.matrixU().col(k));
        const Eigen::VectorXd column = unit.cwiseProduct(svd.matrixV().col(k));
        block += row * column.transpose();
        gauges_.push_back({pivot.x, n, {row.begin(), row.end()}, {column.begin(), column.end()}});
    }
}

void BlockLU::solve(double* x) const { lu_kernels().solve(view(), x); }

// One type of view serves both kernels; `solve` writes through none of its pointers.
LuView BlockLU::view() const {
    auto writable = [](const std::vector<double>& v) { return const_cast<double*>(v.data()); };
    return {n(),
            static_cast<int>(pivots_.size()),
            pivots_.data(),
            targets_.data(),
            runs_.data(),
            rows_.data(),
            multiplier_.data(),
            writable(upper_),
            writable(lower_),
            writable(scale_),
            writable(scratch_),
            line_,
            [](void* owner, int pivot) {
                auto* self = static_cast<BlockLU*>(owner);
                self->repair(self->pivots_[pivot]);
            },
            const_cast<BlockLU*>(this)};
}

int BlockLU::n() const { return offset_.empty() ? 0 : offset_.back(); }

int BlockLU::offset(int block) const { return offset_[block]; }

std::size_t BlockLU::n_nonzeros() const {
    std::size_t count = 0;
    for (const LuPivot& p : pivots_)
        count += static_cast<std::size_t>(p.n) * static_cast<std::size_t>(p.n + 2 * p.r);
    return count;
}

int BlockLU::singular_block() const { return singular_; }

const std::vector<int>& BlockLU::order() const { return order_; }

}  // namespace visviva
