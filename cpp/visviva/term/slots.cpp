#include "visviva/term/slots.hpp"

namespace visviva {

namespace {
constexpr int L8 = slot_lanes;
// Two tasks share rows of the matrix, which then come from memory twice: tasks are as large as leaves some of
// one colour to each of a few threads. Meshes numbered at random need small ones.
constexpr int fewest_blocks = 16, most_tasks = 16, fewest_of_a_colour = 4;
}  // namespace

Slots::Slots(const int* index, int n, int n_slots, int apart)
    : n_(n), n_slots_(n_slots), apart_(apart), n_blocks_((n + L8 - 1) / L8) {
    in_lanes(index_, index, n_slots, n);
    task_blocks_ = std::max(fewest_blocks, (n_blocks_ + most_tasks - 1) / most_tasks);
    colour_tasks();
    while (task_blocks_ > fewest_blocks &&
           n_tasks() < fewest_of_a_colour * static_cast<int>(colours_.size())) {
        task_blocks_ = std::max(fewest_blocks, task_blocks_ / 2);
        colour_tasks();
    }
}

void Slots::colour_tasks() {
    colours_.clear();
    const int last = index_.empty() ? 0 : *std::max_element(index_.begin(), index_.end());
    std::vector<std::vector<char>> used(last + 1);  // per unknown: colours that touch it
    for (int t = 0; t < n_tasks(); ++t) {
        const std::int64_t size = static_cast<std::int64_t>(n_slots_) * L8;
        const auto first = index_.begin() + t * task_blocks_ * size,
                   end = index_.begin() + std::min<std::int64_t>((t + 1) * task_blocks_, n_blocks_) * size;
        std::vector<char> taken(colours_.size() + 1, 0);
        for (auto u = first; u != end; ++u)
            for (std::size_t c = 0; c < used[*u].size(); ++c) taken[c] |= used[*u][c];
        const auto colour =
            static_cast<std::size_t>(std::find(taken.begin(), taken.end(), 0) - taken.begin());
        if (colour == colours_.size()) colours_.push_back({});
        colours_[colour].push_back(t * task_blocks_);
        for (auto u = first; u != end; ++u) {
            used[*u].resize(std::max(used[*u].size(), colour + 1), 0);
            used[*u][colour] = 1;
        }
    }
}

void Slots::couple(Pattern& pattern) const {
    for (int e = 0; e < n_; ++e)
        for (int a = 0; a < n_slots_; ++a)
            for (int b = 0; b < n_slots_; ++b)
                if (couples(a, b)) pattern.couple(unknown(e / L8, a, e % L8), unknown(e / L8, b, e % L8));
}

void Slots::connect(const Pattern& pattern) {
    const std::size_t lanes = static_cast<std::size_t>(n_blocks_) * n_slots_ * L8;
    row_.assign(lanes, -1), length_.assign(lanes, 0), offset_.assign(lanes * n_slots_, 0xffff);
    for (int e = 0; e < n_; ++e)
        for (int a = 0; a < n_slots_; ++a) {
            const int block = e / L8, l = e % L8, u = unknown(block, a, l);
            const std::size_t slot = static_cast<std::size_t>(block) * n_slots_ + a;
            const auto start = pattern.row_start(u);
            if (start < 0) continue;
            row_[slot * L8 + l] = start, length_[slot * L8 + l] = pattern.row_length(u);
            for (int b = 0; b < n_slots_; ++b) {
                const auto p = couples(a, b) ? pattern.position(u, unknown(block, b, l)) : -1;
                if (p >= 0) offset_[(slot * n_slots_ + b) * L8 + l] = static_cast<std::uint16_t>(p - start);
            }
        }
}

void Slots::clear_rows(const Pattern& pattern, std::vector<char>& cleared) {
    std::vector<std::vector<Pattern::Rows>> first(n_blocks_);
    for (const auto& colour : colours_)
        for (int begin : colour)
            for (int b = begin; b < std::min(begin + task_blocks_, n_blocks_); ++b)
                for (int k = 0; k < n_slots_ * L8; ++k) {
                    const auto rows = pattern.rows(unknown(b, k / L8, k % L8));
                    if (rows.node < 0 || cleared[rows.node]) continue;
                    cleared[rows.node] = 1;
                    first[b].push_back(rows);
                }
    zeros_.clear(), first_zero_.assign(1, 0);
    for (const auto& block : first) {
        for (const auto& rows : block) zeros_.emplace_back(rows.begin, rows.end);
        first_zero_.push_back(zeros_.size());
    }
}

}  // namespace visviva
