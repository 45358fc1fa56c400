#include "visviva/contact/contact_scatter.hpp"

namespace visviva {

ContactScatter::ContactScatter(std::shared_ptr<const Gaps> gaps, std::vector<int> normal,
                               std::vector<int> tangential)
    : gaps_(std::move(gaps)), normal_(std::move(normal)), tangential_(std::move(tangential)) {}

std::vector<int> ContactScatter::multipliers(int A) const {
    std::vector<int> m;
    if (!normal_.empty()) m.push_back(normal_[A]);
    for (int i = 0; i < n_tangential(); ++i) m.push_back(tangential_[A] + i);
    return m;
}

void ContactScatter::couple(Pattern& pattern) const {
    const Skin& skin = gaps_->skin();
    for (int A = 0; A < gaps_->n(); ++A) {
        const std::vector<int> own = multipliers(A);
        for (int a : own)
            for (int b : own) pattern.couple(a, b);
        skin.each_form(gaps_->neighbours(A), [&](int, int k) {
            for (int i = 0; i < (skin.mesh_node[k] ? 1 : skin.dim); ++i)
                for (int a : own)
                    pattern.couple(skin.unknown[k] + i, a), pattern.couple(a, skin.unknown[k] + i);
        });
    }
    couple_vertices(pattern);
}

// Vertices that belong to the same gap, each pair once.
void ContactScatter::couple_vertices(Pattern& pattern) const {
    const Skin& skin = gaps_->skin();
    std::vector<std::vector<int>> gaps(skin.n_vertices());
    for (int A = 0; A < gaps_->n(); ++A)
        for (int v : gaps_->neighbours(A)) gaps[v].push_back(A);
    auto rows = [&](int k) { return skin.mesh_node[k] ? 1 : skin.dim; };
    std::vector<int> seen(skin.n_vertices(), -1), others;
    for (int v = 0; v < skin.n_vertices(); ++v) {
        others.clear();
        for (int A : gaps[v])
            for (int w : gaps_->neighbours(A))
                if (seen[w] != v) seen[w] = v, others.push_back(w);
        for (int k = skin.first[v]; k < skin.first[v + 1]; ++k)
            for (int i = 0; i < rows(k); ++i)
                skin.each_form(others, [&](int, int l) {
                    for (int j = 0; j < rows(l); ++j)
                        pattern.couple(skin.unknown[k] + i, skin.unknown[l] + j);
                });
    }
}

void ContactScatter::connect(const Pattern& pattern) {
    pattern_ = pattern, border_places_.clear();
    places_.assign(gaps_->n(), {});
}

void ContactScatter::clear_borders(double* values) {
    for (const std::int64_t at : border_places_) values[at] = 0;
    border_places_.clear();
}

namespace {
constexpr std::int64_t absent = -1, scattered = -2;

// Where a block of rows and columns begins in the tangent, if it lies there as one of a mesh's nodes does:
// what is no node of a mesh has rows of its own.
std::int64_t block_at(const Pattern& pattern, int row, int col, int dim) {
    const std::int64_t first = pattern.position(row, col), length = pattern.row_length(row);
    for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
            if (pattern.position(row + i, col + j) != (first < 0 ? absent : first + i * length + j))
                return scattered;
    return first;
}
}  // namespace

// Where blocks begin in the tangent, for all pairs of a stencil's forms, and all entries of its multipliers;
// found once per stencil.
const ContactScatter::Places& ContactScatter::places(int A) {
    const Skin& skin = gaps_->skin();
    Places& p = places_[A];
    if (p.known && p.stencil == gaps_->stencil(A)) return p;
    p.known = true, p.stencil = gaps_->stencil(A), p.blocks.clear(), p.border.clear();
    const std::vector<int> own = multipliers(A);
    for (int i : own)
        for (int j : own) p.border.push_back(pattern_->position(i, j));
    skin.each_form(p.stencil, [&](int, int k) {
        for (int j : own)
            for (int i = 0; i < skin.dim; ++i) {
                p.border.push_back(pattern_->position(j, skin.unknown[k] + i));
                p.border.push_back(pattern_->position(skin.unknown[k] + i, j));
            }
        skin.each_form(p.stencil, [&](int, int l) {
            const bool of_nodes = skin.mesh_node[k] && skin.mesh_node[l];
            const int row = skin.unknown[k], col = skin.unknown[l];
            p.blocks.push_back(of_nodes ? pattern_->position(row, col)
                                        : block_at(*pattern_, row, col, skin.dim));
        });
    });
    return p;
}

namespace {
// Adds a block of rows that are `apart` to values in rows of some length.
template <int dim>
void add_block(const double* block, std::size_t apart, double factor, double* values, std::int64_t length) {
    for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) values[i * length + j] += factor * block[i * apart + j];
}
}  // namespace

void ContactScatter::subtract_stiffness(int A, const double* K, double* values) {
    const Skin& skin = gaps_->skin();
    const auto& stencil = gaps_->stencil(A);
    const std::size_t apart = 3 * stencil.size();
    const std::int64_t* place = places(A).blocks.data();
    skin.each_form(stencil, [&](int v, int k) {
        const int row = skin.unknown[k];
        const std::int64_t length = pattern_->row_length(row);
        skin.each_form(stencil, [&](int w, int l) {
            const double factor = -skin.weight[k] * skin.weight[l];
            const double* block = K + 3 * v * apart + 3 * w;
            const std::int64_t first = *place++;
            if (first >= 0 && skin.dim == 3)
                return add_block<3>(block, apart, factor, values + first, length);
            if (first >= 0) return add_block<2>(block, apart, factor, values + first, length);
            if (first == absent) return;
            for (int i = 0; i < skin.dim; ++i)
                for (int j = 0; j < skin.dim; ++j) {
                    const std::int64_t at = pattern_->position(row + i, skin.unknown[l] + j);
                    if (at >= 0) values[at] += factor * block[i * apart + j];
                }
        });
    });
}

void ContactScatter::add_border(int A, const Border& b, bool active, double* values) {
    const Skin& skin = gaps_->skin();
    const Eigen::Index m = b.square.rows();
    if (m == 0) return;
    const std::int64_t* place = places(A).border.data();
    auto add = [&](double value) {
        const std::int64_t at = *place++;
        if (at >= 0) values[at] += value, border_places_.push_back(at);
    };
    for (Eigen::Index i = 0; i < m; ++i)
        for (Eigen::Index j = 0; j < m; ++j) add(b.square(i, j));
    if (!active) return;
    skin.each_form(gaps_->stencil(A), [&](int v, int k) {
        for (Eigen::Index j = 0; j < m; ++j)
            for (int i = 0; i < skin.dim; ++i) {
                add(skin.weight[k] * b.row(j, 3 * v + i));
                add(skin.weight[k] * b.column(3 * v + i, j));
            }
    });
}

}  // namespace visviva
