// Which facets come near each other: a tree of bounding boxes, built once and refitted.
#pragma once
#include <vector>

#include "skin.hpp"

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

class BoxTree {
  public:
    /// Over boxes given by their centres, three numbers each.
    void build(const std::vector<double>& centres);
    void refit(const std::vector<Box>& boxes);
    /// Numbers of the boxes that meet one, in ascending order.
    void query(const Box& box, std::vector<int>& found) const;

  private:
    struct Node {
        Box box;
        int left = -1, right = -1, leaf = -1;
    };
    int make(int begin, int end, const std::vector<double>& centres);
    std::vector<int> order_;
    std::vector<Node> nodes_;  // children before their parents; the root is the last
};

/// What a facet sweeps from one configuration to another, with a margin all round.
Box swept(const Skin&, int facet, const double* from, const double* to, double margin);

}  // namespace visviva
