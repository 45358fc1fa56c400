// What a closed surface of triangles encloses, in one configuration.
#pragma once
#include <Eigen/Dense>
#include <utility>
#include <vector>

#include "visviva/contact/search.hpp"

namespace visviva {

/// Edges of facets, each once, and what facets are cut into, by vertices.
struct Triangulated {
    std::vector<std::pair<int, int>> edges;
    std::vector<int> triangles;  // three vertices each, anticlockwise as seen from outside
    std::vector<int> facets;     // that triangles are cut from

    /// Of the facets from one number on to before another. Those of plane bodies are walls of space, between
    /// copies of all vertices behind and before these: see `stand_walls`.
    Triangulated(const Skin& skin, int begin, int end);
    /// Adds these copies to the positions of plane bodies, farther away than depths are.
    static void stand_walls(std::vector<double>& X);
};

struct Triangle {
    Eigen::Vector3d a, b, c;

    double distance(const Eigen::Vector3d& x) const;
    Eigen::Vector3d normal() const { return (b - a).cross(c - a).normalized(); }
    /// Where a line from p meets it, in lengths of its way; below 0 if nowhere.
    double crossing(const Eigen::Vector3d& p, const Eigen::Vector3d& way) const;
};

/// A place in a body, and how far from its surface.
struct DeepPlace {
    double depth = 0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
};

class Enclosure {
  public:
    /// Positions of vertices, three numbers each, and triangles of them.
    Enclosure(const std::vector<double>& X, const std::vector<int>& triangles);

    const std::vector<Triangle>& triangles() const { return triangles_; }
    /// Numbers of triangles whose bounds meet a box.
    void near(const Box& box, std::vector<int>& found) const { tree_.query(box, found); }
    /// Depth of a place; 0 outside, and where it is not more than `least`.
    double depth(const Eigen::Vector3d& x, double least = 0) const;
    /// Whether a place is as near to the surface as that.
    bool is_shallow(const Eigen::Vector3d& x, double least) const;
    /// The triangle that is nearest to a place; -1 where that is outside.
    int nearest(const Eigen::Vector3d& x) const;
    /// Whether a place is inside, or as near to the surface as that.
    bool touches(const Eigen::Vector3d& x, double near) const;
    /// The ends of an edge, and where it passes through the surface, as parts of its length in ascending
    /// order.
    void cut(const Eigen::Vector3d& p, const Eigen::Vector3d& way, std::vector<double>& cuts) const;
    /// Where a line from p on the surface leaves the body, in lengths of its way; infinite if nowhere.
    double exit(const Eigen::Vector3d& p, const Eigen::Vector3d& way) const;

    /// Whether a place is inside.
    bool holds(const Eigen::Vector3d& x) const;

  private:
    std::vector<Triangle> triangles_;
    BoxTree tree_;
};

Box around(std::initializer_list<Eigen::Vector3d> points);

}  // namespace visviva
