// Gaps of single points: the distance of each vertex of the first surface, times the area that belongs to it.
#pragma once
#include <Eigen/Dense>
#include <initializer_list>
#include <utility>

#include "visviva/contact/gaps.hpp"
#include "visviva/contact/sides.hpp"

namespace visviva {

constexpr double facing = -0.1;  // least opposition of a vertex' and a facet's normal, as for mortar

class PointGaps : public Gaps, public Offsets {
  public:
    PointGaps(Skin skin, PointOptions options);
    void values(const double* X, double* gap, double* area) override;
    void gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) override;
    void seconds(const double* X, const std::vector<double>& S, const double* direction,
                 std::vector<Gap>& out) override;
    void grips(const double* X, const std::vector<char>& wanted, bool gradients,
               std::vector<Grip>& out) override;
    bool settle(const double* X) override;
    void keep_sides() override { keeps_ = true; }
    bool set_static(bool on) override { return std::exchange(static_, on) != on; }
    Offsets* offsets() override { return this; }
    double offset(int gap) const override { return sides_.of(gap).offset; }
    void set_offset(int gap, double offset) override { sides_.amend(gap, {sides_.of(gap).face, offset}); }
    void mark_tangent() override { sides_.mark_tangent(); }
    void write_memory(std::vector<double>& m) const override { sides_.write(m); }
    void read_memory(const double*& m) override { sides_.read(m); }
    int strays(const double* from, const double* to, const double* before,
               const double* after) const override;

  protected:
    enum class Reach { near, far };
    struct Distance {
        double value = 0;
        Eigen::VectorXd gradient;  // by the positions of the stencil
        Eigen::MatrixXd hessian;
        bool beyond = false;  // to the rounding behind a border
    };
    /// Signed distance of a vertex, with as many derivatives as are wanted.
    virtual Reach distance(const double* X, int vertex, int derivatives, Distance& out) const = 0;
    /// Where what is near pushes to, of a distance with its gradient: along the force on the vertex.
    virtual Eigen::Vector3d push(const Distance& d, int /*vertex*/) const { return d.gradient.head<3>(); }
    /// Of a vertex' stencil, what belongs to the body that it may touch.
    virtual std::vector<int> others(int vertex) const = 0;
    /// Bound of a vertex' motion relative to its neighbourhood.
    virtual double way(const double* from, const double* to, int vertex) const = 0;
    /// Of a vertex, or the middle of a ball, inside of the other body, the side that is nearest, and that by
    /// which it came in between two configurations; Sides::nearest if that is not known, or it is outside.
    virtual int nearest_side(const double* X, int vertex) const = 0;
    bool is_inside(const double* X, int vertex) const { return nearest_side(X, vertex) >= 0; }
    virtual int entrance(const double* from, const double* to, int vertex) const = 0;
    virtual double depth(const double* X, int vertex, int side) const = 0;
    virtual bool are_same(const double* X, int side, int other) const = 0;
    /// This side, if a corner of a rigid body may have touched it before its edges did, and has not sagged
    /// below another one beside it, else the nearest that it may.
    virtual int touched(const double* /*X*/, int /*vertex*/, int side) const { return side; }
    /// Whether a vertex of a rigid body goes by this side, as another body is flush with one beside that, or,
    /// by `sags`, as it has sagged below, or swings through, one.
    virtual bool goes_by(const double* /*X*/, int /*vertex*/, int /*side*/, bool /*sags*/) const {
        return false;
    }
    bool sagged(const double* X, int vertex, int side) const { return goes_by(X, vertex, side, true); }
    /// Whether a vertex goes by the plane of a wall, into which another body leads on the face that ends at
    /// it there; both planes by their normals and the heights of the vertex above them.
    struct Plane {
        Eigen::Vector3d normal;
        double height;
    };
    bool is_flush(const double* X, int vertex, const Plane& wall, const Plane& face) const;
    bool lands(const double* X, int vertex, int wall, int face) const;
    /// Whether a vertex outside may land on faces as if they went on over what covers walls.
    bool may_land(int vertex) const {
        return covers_.has(1) && start() && !static_ && !keeps_ && !deforms(vertex) &&
               sides_.of(vertex).face < 0;
    }
    /// Whether it has there, or had where the step began: what swings may be many times as deep at its end.
    bool swings_by(const double* X, int vertex, int side) const {
        return sagged(X, vertex, side) || (start() && sagged(start(), vertex, side));
    }
    bool touches(const double* X, int vertex, int side) const { return touched(X, vertex, side) == side; }
    /// Whether a corner of a rigid body may touch a side with this normal: it faces that.
    bool looks(const double* X, int vertex, const Eigen::Vector3d& normal) const;
    /// The side that a vertex belongs to, if it is not the nearest: that by which it came in.
    int side(const double* X, int vertex) const;
    /// Whether it is a node of a mesh: what it goes in by an edge its body makes up for by deforming, and the
    /// nearest side that it faces counts, by which its energy is continuous.
    bool deforms(int vertex) const { return skin_.mesh_node[skin_.first[vertex]]; }
    /// A vertex of a rigid body by so little nearer to the middle of its surface that what touches an edge
    /// from above comes in by its upper side, and what slides along the edge does not come in.
    Eigen::Vector3d nudged(const double* X, int vertex) const;
    /// Sets what friction acts on, with weights that add up to zero where those of the vertex add up to -1;
    /// without touching it where nothing is near.
    virtual void grip(const double* X, int vertex, bool gradients, Grip& out) const = 0;
    /// Adds the weights, times a sign, that a place c with C = dc/dx has as a point of the frame with axes of
    /// length L whose vertices are at X, and at place `own` of the stencil.
    static void add_weights(const double* X, double L, const Eigen::Vector3d& c, const Eigen::MatrixXd& C,
                            int own, double sign, Grip& out);

    /// The middle of the first surface at these configurations, which all its vertices ask for.
    void find_middles(std::initializer_list<const double*> configurations) const;
    Eigen::Vector3d middle_at(const double* X) const;
    const double* start() const { return sides_.start().empty() ? nullptr : sides_.start().data(); }

    class Path;
    bool cuts_through(const Path&, double before, double after, double near) const;
    bool turns_about(const Path&, const double* from, int vertex) const;
    bool slides_out(const double* X, int vertex, int in, int out) const;
    int side_of_node(const double* X, int vertex) const;
    int side_inside(const double* X, int vertex, int kept) const;
    Entered find_side(const double* X, int vertex) const;

    PointOptions options_;
    Sides sides_;
    NormalField around_;  // of what is rigid, if vertices have no facets
    struct Middle {
        const double* X;
        Eigen::Vector3d place;
    };
    mutable std::vector<Middle> middles_;
    bool keeps_ = false, static_ = false;
};

}  // namespace visviva
