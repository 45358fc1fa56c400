// Where two rigid bodies may touch beside the vertices of the first: an edge of each that cross, or a corner
// of the second in a face of the first.
#pragma once
#include <array>
#include <vector>

#include "visviva/contact/flush.hpp"
#include "visviva/contact/gaps.hpp"
#include "visviva/contact/meeting.hpp"
#include "visviva/contact/search.hpp"

namespace visviva {

class SharpPairs {
  public:
    SharpPairs(SharpParts parts, double depth, const Sags& sags, const Covers& covers)
        : parts_(std::move(parts)), depth_(depth), flush_(2e-6 * depth), sags_(sags), covers_(covers) {}

    /// A pair, by its number among all of them, with the sign of its normal.
    struct Pair {
        long number = -1;
        double sign = 0;
        bool operator==(const Pair&) const = default;
    };
    /// Numbers of pairs that come within a margin between two configurations, in ascending order.
    std::vector<long> near(const double* from, const double* to, double margin) const;
    bool is_apart(const double* X, long number) const;
    std::array<int, 4> stencil(long number) const;
    Meeting meeting(const double* X, const Pair& pair) const;
    bool has_signs(long number) const { return number < n_crossing(); }
    /// So far corners may be beside a face, and edges that end there are none.
    double flush() const { return flush_.limit(); }
    bool settle_flush(std::vector<double> offsets) { return flush_.settle(std::move(offsets)); }
    /// How far a corner is from the border of its face, or edges cross from the nearest end of each.
    void add_offsets(const double* X, const Pair& pair, std::vector<double>& offsets) const;

    /// Whether a pair meets: both parts look at each other, where they are nearest to each other. That may be
    /// `beyond` their ends, by this part of their lengths, and normals beside what they see, by this sine.
    /// What `stays` met before: it came in there, and may be deeper than what is found in there.
    bool meets(const double* X, const Pair& pair, double beyond, double sine, bool stays = false) const;

    /// Whether edges that come into each other from where a step began, at X0, cross where they first touch.
    bool touch(const double* X0, const double* X, const Pair& pair) const;
    /// Whether edges have slid past an end of one that lies below a facet of the other one which looks as
    /// they do: its vertex takes over.
    bool slides_in(const double* X, const Pair& pair) const;
    /// Whether edges that have slid past an end into the open still come out of each other, or hardly hang
    /// over.
    bool leaves(const double* X0, const double* X, const Pair& pair) const;

    /// Whether one body goes by there: it has sagged below the edge of the other one that meets it.
    bool has_sagged(const double* X, const Pair& pair) const;

    /// Whether it meets at the end of a face where another body goes on, of what lay at `X0` where the step
    /// began: no edge is there, and no corner.
    bool is_flush(const double* X0, const double* X, const Pair& pair) const;
    /// Whether a corner that was above a face where the step began comes below that past its border, where no
    /// other body goes on.
    bool comes_past(const double* X0, const double* X, const Pair& pair) const;
    /// Whether it is beside the face, over a body that goes on there.
    bool is_over_flush(const double* X0, const double* X, const Pair& pair) const;

  private:
    long n_edges(int side) const {
        const long first = parts_.n_first;
        return side == 0 ? first : static_cast<long>(parts_.edges.size()) / 4 - first;
    }
    long n_crossing() const { return n_edges(0) * n_edges(1); }
    long n_faces() const { return static_cast<long>(parts_.face_corners.size()) / 3; }
    long n_corners() const { return static_cast<long>(parts_.corners.size()); }
    /// Of a side: edges, then faces or corners.
    long part(long number, int side) const {
        const bool crosses = number < n_crossing();
        const long other = crosses ? n_edges(1) : n_corners(), k = crosses ? number : number - n_crossing();
        return (side == 0 ? k / other : k % other) + (crosses ? 0 : n_edges(side));
    }
    const int* edge(long number, int side) const {
        return &parts_.edges[4 * (part(number, side) + (side == 0 ? 0 : n_edges(0)))];
    }
    long face(long number) const { return part(number, 0) - n_edges(0); }
    long corner(long number) const { return part(number, 1) - n_edges(1); }
    std::vector<int> vertices(int side, long part) const;
    std::vector<Box> boxes(const double* from, const double* to, int side, double margin) const;
    struct Ridge;
    bool corner_looks(const double* X, long corner, const Eigen::Vector3d& n, double sine) const;
    double inside(const double* X, long face, const Eigen::Vector3d& x, const Eigen::Vector3d& n) const;
    double size(const double* X, const Pair&) const;
    Eigen::Vector3d nudged(const double* X, long corner, double way) const;
    bool passes_by(const double* X, const Pair&, const Meeting&, double in, double way) const;
    bool edges_meet(const double* X, const Pair&, const Meeting&, double beyond, double sine,
                    bool stays) const;

    struct Border {
        Eigen::Vector3d place, out;
    };
    Eigen::Vector3d foot_at(const double* X, const Pair&, const Eigen::Vector4d& shares) const;
    bool goes_on(const double* X, const Pair&, const Eigen::Vector3d& foot) const;
    std::vector<Border> borders(const double* X, const Pair&, const Eigen::Vector3d& foot) const;
    Eigen::Vector3d nudged_aside(const double* X, long corner) const;
    bool is_flush_edge(const double* X0, const Pair&, const Meeting&, int side) const;
    bool is_flush_wall(const double* X0, const double* X, const Pair&, const Meeting&) const;

    SharpParts parts_;
    double depth_;
    Flush flush_;
    const Sags& sags_;
    const Covers& covers_;
};

}  // namespace visviva
