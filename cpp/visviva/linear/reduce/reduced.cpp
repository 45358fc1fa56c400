#include "visviva/linear/reduce/reduced.hpp"

#include <algorithm>

namespace visviva {

std::vector<int> number_left(const Csr& full, const std::vector<char>& gone, Csr& left) {
    std::vector<int> kept(full.n, -1);
    left.equation.assign(full.equation.size(), -1);
    for (int i = 0; i < full.n; ++i) {
        if (gone[i]) continue;
        kept[i] = left.n++;
        left.equation[full.unknown[i]] = kept[i];
        left.unknown.push_back(full.unknown[i]);
    }
    return kept;
}

std::int64_t place_of(const Csr& csr, int row, int col) {
    const auto begin = csr.col.begin() + csr.row[row], end = csr.col.begin() + csr.row[row + 1];
    const auto found = std::lower_bound(begin, end, col);
    return found != end && *found == col ? found - csr.col.begin() : -1;
}

Blocks left_blocks(const Blocks& blocks, const std::vector<int>& kept, int n_left) {
    Blocks b = blocks;
    b.node.clear(), b.modes.clear(), b.algebraic.clear(), b.scale.clear();
    // first equations of nodes, and at last the number of equations
    for (std::size_t k = 0; k + 1 < blocks.node.size(); ++k) {
        const auto begin = kept.begin() + blocks.node[k], end = kept.begin() + blocks.node[k + 1];
        const auto first = std::find_if(begin, end, [](int equation) { return equation >= 0; });
        if (first != end) b.node.push_back(*first);
    }
    if (!blocks.node.empty()) b.node.push_back(n_left);
    for (std::size_t i = 0; i < kept.size(); ++i) {
        if (kept[i] < 0) continue;
        const auto modes = blocks.modes.begin() + static_cast<std::ptrdiff_t>(i) * b.n_modes;
        b.modes.insert(b.modes.end(), modes, modes + b.n_modes);
        if (!blocks.algebraic.empty()) b.algebraic.push_back(blocks.algebraic[i]);
        if (!blocks.scale.empty()) b.scale.push_back(blocks.scale[i]);
    }
    return b;
}

}  // namespace visviva
