// Search for facets that come near each other: a tree of bounding boxes, built once and refitted.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "visviva/contact/skin.hpp"

namespace visviva {

struct Box {
    double low[3], high[3];
    bool meets(const Box& b) const {
        for (int i = 0; i < 3; ++i)
            if (low[i] > b.high[i] || b.low[i] > high[i]) return false;
        return true;
    }
    void include(const Box& b) {
        for (int i = 0; i < 3; ++i) low[i] = low[i] < b.low[i] ? low[i] : b.low[i];
        for (int i = 0; i < 3; ++i) high[i] = high[i] > b.high[i] ? high[i] : b.high[i];
    }
};

struct Ray {
    const double *origin, *direction;  // three numbers each
    /// Along it, in lengths of the direction, to where it enters a box; infinite if it does not.
    double entrance(const Box& box) const {
        double begin = 0, end = HUGE_VAL;
        for (int i = 0; i < 3; ++i) {
            if (direction[i] == 0 && (origin[i] < box.low[i] || origin[i] > box.high[i])) return HUGE_VAL;
            if (direction[i] == 0) continue;
            const double a = (box.low[i] - origin[i]) / direction[i],
                         b = (box.high[i] - origin[i]) / direction[i];
            begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
        }
        return begin <= end ? begin : HUGE_VAL;
    }
};

class BoxTree {
  public:
    /// Over boxes given by their centres, three numbers each.
    void build(const std::vector<double>& centres);
    void refit(const std::vector<Box>& boxes);
    /// Numbers of the boxes that meet one, in ascending order.
    void query(const Box& box, std::vector<int>& found) const;
    /// Calls reach(number) for boxes that a ray enters, about the nearest first, and not beyond what it
    /// returned last.
    template <class F>
    void query(const Ray& ray, F reach) const;

  private:
    struct Node {
        Box box;
        int left = -1, right = -1, leaf = -1;
    };
    int make(int begin, int end, const std::vector<double>& centres);
    std::vector<int> order_;
    std::vector<Node> nodes_;  // children before their parents; the root is the last
};

template <class F>
void BoxTree::query(const Ray& ray, F reach) const {
    double farthest = HUGE_VAL;
    std::vector<std::pair<double, int>> open;
    auto enter = [&](int node) {
        const double begin = ray.entrance(nodes_[node].box);
        if (begin < HUGE_VAL) open.emplace_back(begin, node);
    };
    if (!nodes_.empty()) enter(static_cast<int>(nodes_.size()) - 1);
    while (!open.empty()) {
        const auto [begin, node] = open.back();
        open.pop_back();
        if (begin > farthest) continue;
        const Node& n = nodes_[node];
        if (n.leaf >= 0) {
            farthest = reach(n.leaf);
            continue;
        }
        enter(n.left), enter(n.right);
        const std::size_t k = open.size();
        if (k > 1 && open[k - 1].first > open[k - 2].first) std::swap(open[k - 1], open[k - 2]);
    }
}

/// Box swept by a facet from one configuration to another, with a margin all round.
Box swept(const Skin&, int facet, const double* from, const double* to, double margin);

/// Facets that come near single vertices between two configurations.
class PointSearch {
  public:
    /// Calls take(vertex, facets) for the vertices before n with those facets, from `begin` on, that come
    /// within `margin`; returns whether a call did, or nothing was searched before.
    template <class Take>
    bool find(const Skin& skin, int begin, int n, const double* from, const double* to, double margin,
              Take take) {
        refit(skin, begin, from, to);
        bool changed = !built_;
        built_ = true;
        std::vector<int> found;
        for (int A = 0; A < n; ++A) {
            Box box;
            for (int i = 0; i < 3; ++i) {
                box.low[i] = std::min(from[3 * A + i], to[3 * A + i]) - margin;
                box.high[i] = std::max(from[3 * A + i], to[3 * A + i]) + margin;
            }
            tree_.query(box, found);
            for (int& f : found) f += begin;
            changed |= take(A, found);
        }
        return changed;
    }

  private:
    void refit(const Skin& skin, int begin, const double* from, const double* to);
    BoxTree tree_;
    bool built_ = false;
};

}  // namespace visviva
