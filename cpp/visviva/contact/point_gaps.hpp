// Gaps of single points: the distance of each vertex of the first surface, times the area that belongs to it.
#pragma once
#include <Eigen/Dense>

#include "visviva/contact/gaps.hpp"

namespace visviva {

class PointGaps : public Gaps {
  public:
    PointGaps(Skin skin, PointOptions options);
    void values(const double* X, double* gap, double* area) override;
    void gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) override;
    void seconds(const double* X, const std::vector<double>& S, const double* direction,
                 std::vector<Gap>& out) override;
    void grips(const double* X, const std::vector<char>& wanted, bool gradients,
               std::vector<Grip>& out) override;

  protected:
    enum class Reach { near, far };
    struct Distance {
        double value = 0;
        Eigen::VectorXd gradient;  // by the positions of the stencil
        Eigen::MatrixXd hessian;
    };
    /// Signed distance of a vertex, with as many derivatives as are wanted.
    virtual Reach distance(const double* X, int vertex, int derivatives, Distance& out) const = 0;
    /// Sets what friction acts on, with weights that add up to zero where those of the vertex add up to -1;
    /// without touching it where nothing is near.
    virtual void grip(const double* X, int vertex, bool gradients, Grip& out) const = 0;
    /// Adds the weights, times a sign, that a place c with C = dc/dx has as a point of the frame with axes of
    /// length L whose vertices are at X, and at place `own` of the stencil.
    static void add_weights(const double* X, double L, const Eigen::Vector3d& c, const Eigen::MatrixXd& C,
                            int own, double sign, Grip& out);

    PointOptions options_;
};

}  // namespace visviva
