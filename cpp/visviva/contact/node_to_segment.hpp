// Node-to-segment gaps: the signed distance of a vertex to the closest point of facets, be it inside a facet,
// on an edge or at a vertex, which is continuous wherever the vertex slides (paper section 4.2, ref. [14]).
#pragma once
#include <utility>
#include <vector>

#include "visviva/contact/closest.hpp"
#include "visviva/contact/point_gaps.hpp"
#include "visviva/contact/search.hpp"

namespace visviva::node_to_segment {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

constexpr double same_place = 1e-6;  // so close beside a facet, by its size, a point counts as above it
// In valleys between facets pressure has a part of both normals, and Newton's method goes to and fro between
// them. In a load step a vertex stays above the facet it was above where that began, so far beside it, by its
// size, if the gap there is another one by no more than so much.
constexpr double near_place = 1e-2, near_gap = 1e-3;
constexpr double closed = 1e-9;     // part of the reach: rounding opens nothing
constexpr double apart = 1e-6;      // by a facet's size: what touches nearer together is the same
constexpr double same_side = 0.5;   // least agreement of normals of one side of a body
constexpr double between = 1e-10;   // so far beside a facet what comes in between two of them still meets it
constexpr double smooth = 0.94;     // least mean of the unit normals about a vertex that is not sharp
constexpr double on_border = 1e-9;  // and so close to a border as not beyond it
// Radius, by a facet's size, with which bodies are rounded off beyond the borders of their surfaces: what
// slides off is let go without a jump. From a sharp corner it would snap off.
constexpr double roundness = 0.5;

struct Candidate {
    int facet;
    int local[facet_corners];  // places of its corners in the stencil
};

struct Found {
    const Candidate* candidate = nullptr;
    FacetShape facet;
    Foot foot;
    Foot rim;        // on the border of the surface, if there are any vertices
    Vector3 normal;  // of the simplex, later gradient of the signed distance
    double value = 0;
    bool faces = true;
    bool stays = false;    // what the vertex was above where the step began, though another one is as close
    bool goes_on = false;  // and though that leans to it: its plane goes on
};

class NodeToSegment : public PointGaps {
  public:
    NodeToSegment(Skin skin, PointOptions options, OwnSurface own);
    bool search(const double* from, const double* to) override;
    bool settle(const double* X) override;
    bool roams(const double* X, int vertex) const override;
    long place(int vertex) const override;
    bool turns_uphill(const double* from, const double* to, int vertex) const override;
    bool set_exact(bool on) override { return std::exchange(exact_, on) != on; }
    void approaches(const double* from, const double* to, std::vector<Approach>& out) const override;
    void masses(const double* X, const std::vector<char>& wanted, bool gradients,
                std::vector<Grip>& out) override;

  protected:
    Reach distance(const double* X, int vertex, int derivatives, Distance& out) const override;
    void grip(const double* X, int vertex, bool gradients, Grip& out) const override;
    std::vector<int> others(int vertex) const override;
    double way(const double* from, const double* to, int vertex) const override;
    int nearest_side(const double* X, int vertex) const override;
    int entrance(const double* from, const double* to, int vertex) const override;
    double depth(const double* X, int vertex, int side) const override;
    bool are_same(const double* X, int side, int other) const override;
    int touched(const double* X, int vertex, int side) const override;
    bool goes_by(const double* X, int vertex, int side, bool sags) const override;

  private:
    Reach locate(const double* X, int A, Found& found) const;
    bool locate_beside(const double* X, int A, Found& found) const;
    Reach locate_held(const double* X, int A, Found& found) const;
    bool has_facets() const { return skin_.n_first > 0 || touches_itself(); }
    bool turns() const { return !options_.turning.empty(); }  // balls that rub
    int edge_end(int A) const { return normals_.corners[normals_.start[A]].next; }
    bool touches_itself() const { return !own_.places.empty(); }
    bool excluded(int vertex, int facet) const;
    bool is_other_side(int vertex, int facet) const;
    bool faces_at_rest(int vertex, int facet) const;
    bool holds(int vertex, int facet) const;
    void make_stencil(int A, const std::vector<int>& facets);
    FacetShape shape(const double* X, int facet) const;
    double sight(int A, int facet) const;
    double seen_inside(int A, int facet) const;
    Found pick(const double* X, int A, const Vector3& x, bool only_facing, int side) const;
    struct Touched;
    std::vector<Touched> touched(const double* X, int A) const;
    std::vector<Touched> bottoms(const std::vector<Touched>&) const;
    std::vector<char> below(const std::vector<Touched>&) const;
    static bool goes_on(const Touched& other, const Touched& t);
    void spread(std::vector<Touched>&) const;
    void share_out(const double* X, int A);
    Reach locate_nearest(const double* X, int A, const Vector3& x, Found& found) const;
    Found plane_of(const double* X, int A, int side) const;
    bool goes_beside(const double* X, int A, const Found& found) const;
    bool reaches_over(const double* X, int A, const FacetShape& facet) const;
    void find_over(const double* X);
    bool lies_over(int A, const Vector3& normal) const;
    bool leaves(const double* X, int A, const Found& found, int side) const;
    bool passes_by(const double* X, int A, const Vector3& x, const Found& kept, const Found& found) const;
    bool meets_wall(const double* X, int A, const Found& kept, const Found& found) const;
    Reach sign(const double* X, const Vector3& x, Found& found) const;
    static void set_parts(const Found&, Eigen::VectorXd& masses);
    void make_topology();
    Vector3 outwards(const double* X, const Found& found, bool& border) const;
    void differentiated(const double* X, int A, const Found& found, Eigen::VectorXd& g,
                        Eigen::MatrixXd* H) const;

    // The simplex that a vertex was above where the step began, and whether it touched that.
    struct Kept {
        int facet = -1, simplex = 0;
        bool touches = false;
        bool is(int f, int s) const { return facet == f && simplex == s; }
        bool operator==(const Kept&) const = default;
    };
    std::vector<Kept> kept_;
    // What copies of a vertex hold for the step: a simplex, or of balls an edge or a corner of one.
    struct Held {
        int facet = -1, simplex = 0, n = 0;
        int vertex[3] = {};
        bool operator==(const Held&) const = default;
    };
    std::vector<Held> held_;
    int n_own() const { return n_ / options_.copies; }
    bool exact_ = false;
    OwnSurface own_;  // if it may touch itself
    NormalField normals_;
    PointSearch near_facets_;
    std::vector<std::vector<Candidate>> candidates_;
    std::vector<int> across_;   // [facet][corner]: the facet beyond the edge to the next corner, or -1
    std::vector<char> border_;  // of vertices
    std::vector<int> over_;     // vertices over a surface with borders where the step began
    std::vector<std::vector<int>> near_;  // facets that a vertex shares with itself and its neighbours
    std::vector<char> sharp_;             // vertices at sharp edges and borders, if it may touch itself
};

}  // namespace visviva::node_to_segment
