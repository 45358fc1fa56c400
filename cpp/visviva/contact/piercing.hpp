// How deep rigid bodies are in each other beside what their gaps see: edges that pierce the other surface.
#pragma once
#include <Eigen/Dense>
#include <string>
#include <utility>
#include <vector>

#include "visviva/contact/skin.hpp"

namespace visviva {

class Piercing {
  public:
    /// Two closed surfaces, `limit` the depth from which on they may not be in each other unseen, and what
    /// cures that.
    Piercing(Skin skin, double limit, std::string cure);

    /// Depth of the deepest piece of an edge that lies in the other body, and where.
    struct Piece {
        double depth = 0;
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
    };

    /// Whether bodies that are in each other when a step begins go deeper in it than `seen`, a depth that
    /// gaps have, allows for; never those that were from the start. Then `worst` says where. What comes in
    /// within a step may have met what its gaps hold from the next one on.
    bool sinks(const double* q0, const double* q1, double seen, Piece& worst);

    const std::string& cure() const { return cure_; }

  private:
    using Edges = std::vector<std::pair<int, int>>;  // of vertices
    struct Side {
        Edges edges;
        std::vector<int> triangles;  // three vertices each
    };
    Piece deepest(const double* q) const;
    Piece deepest(const std::vector<double>& X, const Edges& edges, const std::vector<int>& triangles) const;
    void add(int facet, Side& side) const;

    Skin skin_;
    double limit_;
    std::string cure_;
    Side sides_[2];
    bool begun_ = false, overlaps_ = false;
};

}  // namespace visviva
