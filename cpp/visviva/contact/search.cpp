#include "visviva/contact/search.hpp"

#include <algorithm>
#include <numeric>

namespace visviva {

void BoxTree::build(const std::vector<double>& centres) {
    order_.resize(centres.size() / 3);
    std::iota(order_.begin(), order_.end(), 0);
    nodes_.clear();
    if (!order_.empty()) make(0, static_cast<int>(order_.size()), centres);
}

int BoxTree::make(int begin, int end, const std::vector<double>& centres) {
    Node node;
    if (end - begin == 1) {
        node.leaf = order_[begin];
    } else {
        double low[3], high[3];
        for (int i = 0; i < 3; ++i) low[i] = high[i] = centres[3 * order_[begin] + i];
        for (int k = begin; k < end; ++k)
            for (int i = 0; i < 3; ++i) {
                low[i] = std::min(low[i], centres[3 * order_[k] + i]);
                high[i] = std::max(high[i], centres[3 * order_[k] + i]);
            }
        int axis = 0;
        for (int i = 1; i < 3; ++i)
            if (high[i] - low[i] > high[axis] - low[axis]) axis = i;
        const int middle = (begin + end) / 2;
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                         [&](int a, int b) {
                             const double x = centres[3 * a + axis], y = centres[3 * b + axis];
                             return x != y ? x < y : a < b;
                         });
        node.left = make(begin, middle, centres);
        node.right = make(middle, end, centres);
    }
    nodes_.push_back(node);
    return static_cast<int>(nodes_.size()) - 1;
}

void BoxTree::refit(const std::vector<Box>& boxes) {
    for (Node& n : nodes_) {
        if (n.leaf >= 0) {
            n.box = boxes[n.leaf];
        } else {
            n.box = nodes_[n.left].box;
            n.box.include(nodes_[n.right].box);
        }
    }
}

void BoxTree::query(const Box& box, std::vector<int>& found) const {
    found.clear();
    std::vector<int> open;
    if (!nodes_.empty()) open.push_back(static_cast<int>(nodes_.size()) - 1);
    while (!open.empty()) {
        const Node& n = nodes_[open.back()];
        open.pop_back();
        if (!n.box.meets(box)) continue;
        if (n.leaf >= 0)
            found.push_back(n.leaf);
        else
            open.push_back(n.left), open.push_back(n.right);
    }
    std::sort(found.begin(), found.end());
}

Box swept(const Skin& skin, int facet, const double* from, const double* to, double margin) {
    Box box;
    for (int i = 0; i < 3; ++i) box.low[i] = 1e300, box.high[i] = -1e300;
    for (int a = 0; a < skin.n_corners(facet); ++a)
        for (const double* X : {from, to})
            for (int i = 0; i < 3; ++i) {
                const double x = X[3 * skin.corners(facet)[a] + i];
                box.low[i] = std::min(box.low[i], x - margin),
                box.high[i] = std::max(box.high[i], x + margin);
            }
    return box;
}

void PointSearch::refit(const Skin& skin, int begin, const double* from, const double* to) {
    std::vector<Box> boxes;
    std::vector<double> centres;
    for (int f = begin; f < skin.n_facets(); ++f) {
        boxes.push_back(swept(skin, f, from, to, 0));
        for (int i = 0; i < 3; ++i) centres.push_back(0.5 * (boxes.back().low[i] + boxes.back().high[i]));
    }
    if (!built_) tree_.build(centres);
    tree_.refit(boxes);
}

}  // namespace visviva
