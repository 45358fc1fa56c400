// The way of a vertex about another body within a step, as both turn.
#pragma once
#include <Eigen/Dense>
#include <vector>

namespace visviva {

/// What points do between two configurations as a rigid body, exactly so where they are one.
struct RigidMotion {
    Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();  // their middles
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();

    RigidMotion() = default;
    /// Of these vertices, each of a weight; of points on a line none about that.
    RigidMotion(const double* X0, const double* X1, const std::vector<int>& vertices,
                const std::vector<double>& weights);
    /// Where a place at the end lies for who has moved along.
    Eigen::Vector3d back(const Eigen::Vector3d& place) const {
        return from + turn.transpose() * (place - to);
    }
};

/// Places between a start and an end that a body reaches as it turns and moves evenly: on arcs, where
/// straight ways would be chords, which lead through what the body goes round.
class EvenWay {
  public:
    EvenWay() = default;
    explicit EvenWay(const Eigen::Matrix3d& turn);
    /// The rate that leads by d in the unit of time.
    Eigen::Vector3d rate(const Eigen::Vector3d& d) const { return first_ * d; }
    /// By how much a rate has led until t.
    Eigen::Vector3d gone(const Eigen::Vector3d& rate, double t) const { return t * mean(t) * rate; }

  private:
    Eigen::Matrix3d mean(double t) const;
    Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();
    double angle_ = 0;
    Eigen::Matrix3d first_ = Eigen::Matrix3d::Identity();
};

}  // namespace visviva
