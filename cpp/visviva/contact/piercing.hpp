// How deep bodies are in each other beside what their gaps see: edges that pierce the other surface.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "visviva/contact/entrances.hpp"
#include "visviva/contact/turned_ways.hpp"

namespace visviva {

class Piercing {
  public:
    /// What is watched of two sides.
    struct Sides {
        Skin skin;
        bool encloses[2];         // whether they are closed; else lines that may be in the other one
        std::vector<char> faces;  // whether each facet is one by which they may touch
        bool thin = false;  // whether all that they enclose is sheets, which are left by their other side
    };

    /// Two sides, `limit` the depth from which on they may not be in each other unseen, the `least` of their
    /// widths, and what cures that.
    Piercing(Sides sides, double limit, double least, std::string cure);

    struct Finding {
        // Bodies pass by more of their least width in a step than is looked at, or sink on one way alone of
        // those that they may have gone.
        bool outruns = false;
        bool sinks = false;
        DeepPlace worst;  // where they do
    };

    /// Whether bodies come deeper into each other in a step than `seen`, a depth that gaps have, allows for,
    /// and than they were given: those that are in each other already, those that come in by a quarter of
    /// their width, at the end of the step or on the way there, and those that are deeper on the way than at
    /// both ends. What comes in by less may have met what its gaps hold from the next step on.
    Finding look(const double* q0, const double* q1, double seen);

    const std::string& cure() const { return cure_; }
    void write(std::vector<double>& memory) const;
    void read(const double*& memory);

  private:
    // A part of an edge of a side, in shares of its length, and how deep it is in the other body.
    struct Part {
        int side, edge;
        double from, to, depth;
    };
    // Depths up to which bodies may be in each other, and to which they may come in within a step.
    struct Allowed {
        double in, come;
    };
    double beside(double seen, double without) const;
    bool sinks(const TurnedWays& ways, Middle middle, int parts, Allowed allowed, DeepPlace& worst) const;
    DeepPlace deepest(const std::vector<double>& X) const;
    std::vector<double> positions(const double* q) const;
    void keep_touching(int side);
    Bodies bodies(const std::vector<double>& X) const;
    bool touches(int side, int triangle) const { return of_.faces[sides_[side].facets[triangle]] != 0; }
    double depth(const Enclosure& body, int side, const Eigen::Vector3d& x) const;
    bool spans(int side, const Enclosure& body, const Enclosure& own, const Eigen::Vector3d& x,
               const std::array<Eigen::Vector3d, 2>& edge, double depth) const;
    template <class F>
    void each_part(const std::vector<double>& X, const Bodies& bodies, F take) const;
    double given(const Part& part, double length) const;
    // How bodies go by each other: by how many least widths in a step, where the boxes of their ways meet.
    struct Pass {
        bool near = false, touches = false;
        double widths = 0;
    };
    void pass(const TurnedWays& ways, Middle middle, Pass& pass) const;
    double widths(const std::vector<double>& X0, const std::vector<double>& X1,
                  const Eigen::AlignedBox3d (&swept)[2], const Eigen::AlignedBox3d (&ways)[2]) const;
    double parts_of(const Pass& pass, double allowed);
    double across(const std::vector<double>& X0, const std::vector<double>& X1, int side,
                  const Eigen::AlignedBox3d& swept, const Eigen::AlignedBox3d& ways) const;

    Sides of_;
    double limit_, least_;
    std::string cure_;
    Triangulated sides_[2];
    std::array<std::vector<int>, 2> vertices_, touching_;  // of all faces, and of those that may touch
    bool named_ = false;                                   // some may not
    Entrances entrances_;
    bool begun_ = false;
    bool met_ = false;         // faces that may touch have, and bodies are not apart since
    std::vector<Part> given_;  // at the start
};

}  // namespace visviva
