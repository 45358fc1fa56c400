// Gap functions: what a contact keeps from becoming negative. Each belongs to a vertex of the first surface
// and depends on the positions of a few vertices, its stencil.
#pragma once
#include <Eigen/Dense>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "visviva/contact/cover.hpp"
#include "visviva/contact/sags.hpp"
#include "visviva/contact/sight.hpp"
#include "visviva/contact/skin.hpp"

namespace visviva {

/// A gap and its derivatives by the positions of its stencil's vertices, three numbers each.
struct Gap {
    std::vector<double> gradient;
    std::vector<double> along;  // the second derivatives times a direction
    std::vector<double>
        hessian;  // [i][j]; several gaps may share what belongs to them together, see seconds()
};

/// Slip at a gap, on which friction acts: the displacement there of the second surface relative to the first
/// is the sum of `weight` (areas that add up to zero) times those of the stencil's vertices, seen along two
/// directions of the tangent plane that turn with the first surface; in the plane the second is zero.
struct Grip {
    Eigen::VectorXd weight;
    Eigen::VectorXd turning;  // masses of the vertices whose rigid motion friction does not feel
    Eigen::Matrix<double, 3, 2> tangent;
    // By positions of the stencil's vertices, where wanted: [vertex][3 k], and [3][3 k] of each direction.
    Eigen::MatrixXd weight_gradient, tangent_gradient[2];
};

/// Sets the tangents at a unit normal n, which turns with N = dn/dx (null: no derivatives): in space the
/// first is that of an edge from the stencil's vertex `tail` to its vertex `head`.
void set_tangents(int dim, const Eigen::Vector3d& n, const Eigen::MatrixXd* N, const Eigen::Vector3d& edge,
                  int tail, int head, Grip& out);

/// Depth to which bodies may overlap at a gap and be seen there, and their approach in a step.
struct Approach {
    double sight = HUGE_VAL, way = 0;
};

/// How deep what is at gaps was found, which stores no energy.
class Offsets {
  public:
    virtual ~Offsets() = default;
    virtual double offset(int gap) const = 0;
    virtual void set_offset(int gap, double offset) = 0;
};

class Gaps {
  public:
    explicit Gaps(Skin skin) : skin_(std::move(skin)) {}
    virtual ~Gaps() = default;
    const Skin& skin() const { return skin_; }
    /// Gaps are numbered like the vertices of the first surface, but for those of sharp parts.
    int n() const { return n_; }
    /// How many places that meet where a step begins have no gap of their own.
    int unheld() const { return unheld_; }
    /// Vertices of the first surface, which come before all others.
    virtual int n_first() const { return n_; }
    /// How many of them in turn are of the same vertices.
    int copies() const { return copies_; }
    /// Finds what may come into contact between two configurations and near them; true if that is something
    /// else than before.
    virtual bool search(const double* from, const double* to) = 0;
    /// All vertices that a gap may depend on after this search.
    virtual const std::vector<int>& neighbours(int gap) const { return stencils_[gap]; }
    /// Takes into the stencils what may come into contact between two configurations alone; true if that has
    /// changed them.
    virtual bool narrow(const double* /*from*/, const double* /*to*/) { return false; }
    /// Fixes for a step that begins here what does not move with the unknowns; true if gaps are other
    /// functions from now on.
    virtual bool settle(const double* /*X*/) { return false; }
    /// Whether gaps are those of a load step, which no energy is to be kept in; true if they are others from
    /// now on.
    virtual bool set_static(bool) { return false; }
    /// Whether a potential of gaps keeps energy exactly, and has to be one function of the places from step
    /// to step; true if they are others from now on.
    virtual bool set_exact(bool) { return false; }
    /// Whether a vertex has left the facet that it was above where the step began.
    virtual bool roams(const double* /*X*/, int /*gap*/) const { return false; }
    /// Whether a vertex comes from one facet to another that leans to it, between two configurations.
    virtual bool turns_uphill(const double* /*from*/, const double* /*to*/, int /*gap*/) const {
        return false;
    }
    /// What a vertex touches from the start of a step on, a number that is the same in steps in which it is.
    virtual long place(int /*gap*/) const { return 0; }
    /// Whether gaps are those of vertices, which slide from place to place, or of pairs that stay what they
    /// are.
    virtual bool are_of_vertices() const { return true; }
    /// Vertices that overlap stay with the side they came in by until a step begins with them outside, and
    /// not only until it is the nearest: forces hold what overlaps where it is, and what would leave past an
    /// edge in the step after an impact has to feel that first.
    virtual void keep_sides() {}
    /// The limit of what is flush (flush.hpp) for a step; true if it is another one from now on.
    double flush() const { return flush_; }
    bool set_flush(double flush) { return std::exchange(flush_, flush) != flush; }
    /// How deep the bodies lie in what carries them where a step begins; true if that is something else than
    /// before.
    bool lie(Sags sags) { return std::exchange(sags_, sags) != sags; }
    /// Bodies that others touch beside these, as they lie where a step begins.
    Covers& covers() { return covers_; }
    /// Null where no gaps have offsets.
    virtual Offsets* offsets() { return nullptr; }
    double offset(int gap) { return offsets() ? offsets()->offset(gap) : 0; }
    /// Whether a step begins with what belonged to a side, and was below that, outside of the body.
    bool has_left(int gap) const { return !left_.empty() && left_[gap]; }
    /// Whether it begins with what was found below a side that it did not come in by.
    bool has_come(int gap) const { return !come_.empty() && come_[gap]; }
    /// Whether a gap, as values were last asked for, is that to the rounding behind a border.
    bool is_beyond_border(int gap) const { return !beyond_.empty() && beyond_[gap]; }
    /// The configuration where the last step begins is that of the kept tangent.
    virtual void mark_tangent() {}
    /// Memory of gaps: the way to where the last step began.
    virtual void write_memory(std::vector<double>&) const {}
    virtual void read_memory(const double*& /*memory*/) {}
    /// A gap that opens again between two configurations, or pushes at the end elsewhere than where it
    /// closed; -1: none. Their gaps are known.
    virtual int strays(const double* /*from*/, const double* /*to*/, const double* /*before*/,
                       const double* /*after*/) const {
        return -1;
    }
    /// Vertices that a gap depends on; its own comes first.
    const std::vector<int>& stencil(int gap) const { return stencils_[gap]; }
    /// Gaps weighted by area, and the area that belongs to each; both zero where nothing is near.
    virtual void values(const double* X, double* gap, double* area) = 0;
    /// Of every gap, between two configurations that stencils were made for; way and sight are those of the
    /// facets that come nearest to pass each other unseen.
    virtual void approaches(const double* from, const double* to, std::vector<Approach>& out) const = 0;
    /// Part of a facet by which positions may change where gaps jump by as much.
    virtual double resolution() const { return 0; }
    /// Gradients of the gaps that are wanted.
    virtual void gradients(const double* X, const std::vector<char>& wanted, std::vector<Gap>& out) = 0;
    /// The sum of S times the second derivatives, shared out over the gaps' `hessian`, and with a `direction`
    /// their own second derivatives `along` it; gradients as well.
    virtual void seconds(const double* X, const std::vector<double>& S, const double* direction,
                         std::vector<Gap>& out) = 0;
    /// Slips at the gaps that are wanted, with or without derivatives.
    virtual void grips(const double* /*X*/, const std::vector<char>& /*wanted*/, bool /*gradients*/,
                       std::vector<Grip>& /*out*/) {
        throw std::logic_error("friction is not known for these gaps");
    }

    /// Masses of a gap's vertices, with derivatives if wanted, that belong to the configuration alone and not
    /// to what else is in the stencil: forces that mend its work are those of the relative motion of these.
    virtual void masses(const double* /*X*/, const std::vector<char>& wanted, bool gradients,
                        std::vector<Grip>& out);

  protected:
    /// Masses, from there on, of the four vertices of a rigid frame whose motion friction does not feel: so
    /// heavy in its origin that it turns about that, and its axes may lie as they like.
    static void turn_with_frame(int origin, Eigen::VectorXd& masses) {
        constexpr double heavy = 1e4;
        masses.segment<4>(origin) << heavy, 1, 1, 1;
    }
    Skin skin_;
    Sags sags_;
    Covers covers_;
    int n_ = 0, copies_ = 1, unheld_ = 0;
    std::vector<std::vector<int>> stencils_;
    std::vector<char> left_, come_, beyond_;
    double flush_ = 0;
};

struct MortarOptions {
    double reach = 0;           // facets farther apart along the normal do not see each other
    bool axisymmetric = false;  // edges stand for surfaces of revolution
    bool dual = false;          // weighted by dual functions of the first surface, for what it was covered of
};

std::unique_ptr<Gaps> make_mortar(Skin skin, const MortarOptions& options);

/// Gaps of single points.
struct PointOptions {
    std::vector<double> areas;   // of the first surface's vertices, which come before all others
    std::vector<double> behind;  // thickness of the body behind each of them
    double radius = 0;           // of a ball about each of them
    double reach = 0;            // facets farther away are not seen
    bool rubs = false;           // there is friction
    // Where balls rub: of each vertex the first of the four that are the frame it turns with, its origin and
    // the ends of its axes, and how long these are.
    std::vector<int> turning;
    double axis = 0;
    // So many of each vertex of the first surface, one set behind the other: where facets lean together over
    // it, each of them holds a copy.
    int copies = 1;
    std::vector<int> facets;  // of a rigid body between vertices without facets, as in a skin
};

/// Distances to the closest points of the second surface's facets.
std::unique_ptr<Gaps> make_node_to_segment(Skin skin, PointOptions options);

/// A surface that touches itself: what a vertex lies behind at the `places` of all vertices at rest, within
/// reach, is the other side of its own body. Vertices touch those facets alone whose `ends` are farther along
/// the surface than their own `starts`, so that what meets is not held from both sides.
struct OwnSurface {
    std::vector<double> places, starts, ends;
};
std::unique_ptr<Gaps> make_self_contact(Skin skin, PointOptions options, OwnSurface own);

/// A shape in a frame; round about the third axis, or with edges along the axes.
struct ObstacleShape {
    enum Core { half_space, box, cylinder };
    Core core = half_space;
    double half[3] = {};  // half the size of the core along each axis; no size at all for a ball
    double radius = 0;    // of a round layer about the core
    double axis = 1;      // length of the axes in the skin
};

/// Distances to an exact shape; the last four vertices of the skin are its frame, the origin and the ends of
/// its axes.
std::unique_ptr<Gaps> make_obstacle(Skin skin, PointOptions options, const ObstacleShape& shape);

/// Distances to the segments of the second surface, which are the middles of round bars: the radius is that
/// of both together. Of each vertex, segments [start[A], start[A + 1]) of `own` are its own bar beside it.
struct OwnSegments {
    std::vector<int> start, own;
};
/// Where bars rub: the first of the four vertices of the frame of each vertex of the second surface, and the
/// radius about the vertices of the first one. Where that is a bar as well, pairs of neighbours along it.
struct BarFrames {
    std::vector<int> second;
    double radius = 0;
    std::vector<int> stretches;
};
std::unique_ptr<Gaps> make_line_gaps(Skin skin, PointOptions options, OwnSegments beside, BarFrames frames);

/// Sharp parts of two rigid bodies that may touch beside vertices of the first, as numbers of vertices.
/// Bodies are convex there.
struct SharpParts {
    // Of each edge, those of the first body first, four vertices: its ends, and corners of the facets to the
    // left and to the right of it, seen from outside.
    std::vector<int> edges;
    int n_first = 0;
    // Of each flat face of the first body three corners, anticlockwise from outside, and the edges of its
    // border, two vertices each and anticlockwise.
    std::vector<int> face_corners, borders, border_start;
    // Corners of the second body, and the other ends of their edges.
    std::vector<int> corners, next, next_start;
};
/// So many gaps hold those pairs that meet, or are nearest to that, when a step begins.
struct SharpOptions {
    SharpParts parts;
    int n_vertices = 0;  // of the first body
    int n_gaps = 0;
    double depth = 0;  // what is farther apart, or deeper in the other body, is not seen
    double reach = 0;  // of the search
};
std::unique_ptr<Gaps> make_sharp_gaps(Skin skin, SharpOptions options);

}  // namespace visviva
