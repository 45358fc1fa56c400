// Elements of a mesh in blocks of eight: the unknowns of their slots (nodes and pressures), the places of
// these in the matrix, and tasks that touch different unknowns.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "visviva/base/aligned.hpp"
#include "visviva/base/parallel.hpp"
#include "visviva/term/pattern.hpp"

namespace visviva {

inline constexpr int slot_lanes = 8;

// From [element][row] to [block][row][8]; the last element fills the padding.
template <class To, class From>
void in_lanes(To& to, const From* from, std::int64_t rows, int n) {
    if (!from) return;
    constexpr int L8 = slot_lanes;
    const std::int64_t blocks = (n + L8 - 1) / L8;
    to.resize(blocks * rows * L8);
    for (std::int64_t b = 0; b < blocks; ++b)
        for (std::int64_t k = 0; k < rows; ++k)
            for (int l = 0; l < L8; ++l)
                to[(b * rows + k) * L8 + l] = from[std::min<std::int64_t>(b * L8 + l, n - 1) * rows + k];
}

class Slots {
  public:
    // index [element][slot]: first unknown of each slot. Slots from `apart` on do not couple with each other.
    Slots(const int* index, int n, int n_slots, int apart);

    void couple(Pattern& pattern) const;
    void connect(const Pattern& pattern);

    // Rows of nodes not yet `cleared` are from now on set to zero by assemble().
    void clear_rows(const Pattern& pattern, std::vector<char>& cleared);

    int n() const { return n_; }
    int n_slots() const { return n_slots_; }
    int n_blocks() const { return n_blocks_; }
    int unknown(int element, int slot) const {
        return unknown(element / slot_lanes, slot, element % slot_lanes);
    }
    const int* index() const { return index_.data(); }              // [block][slot][8]
    const std::int64_t* row() const { return row_.data(); }         // the same: start of the row or -1
    const std::int64_t* length() const { return length_.data(); }   // of a row of the slot
    const std::uint16_t* offset() const { return offset_.data(); }  // [block][slot][slot][8], or 0xffff

    // Calls f(first block, end) for tasks, those that share unknowns one after another.
    template <class F>
    void for_tasks(F f) const {
        for (const auto& colour : colours_)
            parallel_for(static_cast<int>(colour.size()),
                         [&](int i) { f(colour[i], std::min(colour[i] + task_blocks_, n_blocks_)); });
    }

    // The same block by block, after the rows that it is the first to add to were set to zero: they are still
    // in the cache when they are added to, and come from memory once.
    template <class F>
    void assemble(double* values, F f) const {
        for_tasks([&](int begin, int end) {
            for (int b = begin; b < end; ++b) {
                for (auto k = first_zero_[b]; k < first_zero_[b + 1]; ++k)
                    std::fill(values + zeros_[k].first, values + zeros_[k].second, 0.0);
                f(b, b + 1);
            }
        });
    }

  private:
    int unknown(int block, int slot, int lane) const {
        return index_[(static_cast<std::size_t>(block) * n_slots_ + slot) * slot_lanes + lane];
    }
    bool couples(int a, int b) const { return a < apart_ || b < apart_; }
    int n_tasks() const { return (n_blocks_ + task_blocks_ - 1) / task_blocks_; }
    void colour_tasks();

    int n_, n_slots_, apart_, n_blocks_, task_blocks_;
    std::vector<int> index_;
    std::vector<std::int64_t> row_, length_;
    std::vector<std::uint16_t> offset_;
    std::vector<std::size_t> first_zero_;  // of every block among the ranges of values that it sets to zero
    std::vector<std::pair<std::int64_t, std::int64_t>> zeros_;
    std::vector<std::vector<int>> colours_;  // first blocks of tasks that touch different unknowns
};

}  // namespace visviva
