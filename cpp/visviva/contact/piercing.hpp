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
    /// Two closed surfaces, `limit` the depth from which on they may not be in each other unseen, the `least`
    /// of their widths, and what cures that.
    Piercing(Skin skin, double limit, double least, std::string cure);

    /// Depth of the deepest piece of an edge that lies in the other body, beside what it was given, and
    /// where.
    struct Piece {
        double depth = 0;
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
    };

    /// The deepest piece in one configuration, whatever bodies were given, if it is deeper than `limit`.
    Piece overlap(const double* q) const;

    /// Whether bodies pass by more of their least width in a step than is looked at.
    bool outruns(const double* q0, const double* q1) const;

    /// Whether bodies come deeper into each other in a step than `seen`, a depth that gaps have, allows for,
    /// and than they were given: those that are in each other already, those that come in by a quarter of
    /// their width, and those that pass through. Then `worst` says where. What comes in by less may have met
    /// what its gaps hold from the next step on.
    bool sinks(const double* q0, const double* q1, double seen, Piece& worst);

    const std::string& cure() const { return cure_; }
    void write(std::vector<double>& memory) const;
    void read(const double*& memory);

  private:
    using Edges = std::vector<std::pair<int, int>>;  // of vertices
    struct Side {
        Edges edges;
        std::vector<int> triangles;  // three vertices each
    };
    // A part of an edge of a side, in shares of its length, and how deep it is in the other body.
    struct Part {
        int side, edge;
        double from, to, depth;
    };
    Piece deepest(const std::vector<double>& X) const;
    template <class F>
    void each_part(const std::vector<double>& X, F take) const;
    double given(const Part& part, double length) const;
    double sagitta(const std::vector<double>& X0, const std::vector<double>& X1, int side) const;
    double parts_of(const std::vector<double>& X0, const std::vector<double>& X1) const;
    void add(int facet, Side& side) const;

    Skin skin_;
    double limit_, least_;
    std::string cure_;
    Side sides_[2];
    bool begun_ = false;
    std::vector<Part> given_;  // at the start
};

}  // namespace visviva
