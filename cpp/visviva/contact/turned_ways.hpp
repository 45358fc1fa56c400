// The ways of two bodies within a step: on arcs where they turn, whose chords would lead through what they go
// round, or pass beside what they meet.
#pragma once
#include <array>
#include <vector>

#include "visviva/contact/way_about.hpp"

namespace visviva {

/// How the middle of a body that turns goes: straight as in free flight, or round an axis as at a hinge.
/// Places at the ends of a step do not tell which.
enum class Middle { straight, round };

class TurnedWays {
  public:
    /// Of these vertices of both sides between two configurations; those from `n_vertices` on are copies that
    /// walls of plane bodies have. Chords no farther than `straight` beside a way are as good.
    TurnedWays(const std::vector<double>& X0, const std::vector<double>& X1, int n_vertices,
               const std::array<std::vector<int>, 2>& vertices, double straight);

    /// So many equal parts of the step that ways within each are straight.
    int stages() const { return stages_; }
    /// Whether it matters how middles go.
    bool forks() const { return forks_; }
    /// Where vertices are after a share of the step.
    std::vector<double> at(double share, Middle middle) const;

  private:
    struct Side {
        RigidMotion motion;
        Eigen::AngleAxisd turn{0, Eigen::Vector3d::UnitZ()};
        EvenWay round;
        void place(double share, Middle middle, const std::vector<double>& X0, const std::vector<double>& X1,
                   const std::vector<int>& vertices, std::vector<double>& X) const;
        double sagitta(const std::vector<double>& X0, const std::vector<int>& vertices) const;
        double fork() const;
    };
    const std::vector<double>&X0_, &X1_;
    int n_vertices_;
    const std::array<std::vector<int>, 2>& vertices_;
    Side sides_[2];
    int stages_ = 1;
    bool forks_ = false;
};

}  // namespace visviva
