#include "visviva/term/entry_term.hpp"

#include "visviva/term/pattern.hpp"

namespace visviva {

void EntryTerm::couple(Pattern& pattern) const {
    std::vector<std::pair<int, int>> entries;
    list_entries(entries);
    for (const auto& [row, col] : entries) pattern.couple(row, col);
}

// What has no equation goes behind the last entry.
void EntryTerm::connect(const Pattern& pattern) {
    std::vector<std::pair<int, int>> entries;
    list_entries(entries);
    std::vector<std::int64_t> positions;
    positions.reserve(entries.size());
    for (const auto& [row, col] : entries) {
        const std::int64_t at = pattern.position(row, col);
        positions.push_back(at < 0 ? pattern.n_entries() : at);
    }
    set_positions(positions);
}

}  // namespace visviva
