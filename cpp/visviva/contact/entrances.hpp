// By which facets vertices, and lines, have come into the other body, and how deep they are below these:
// beside an edge another one may be nearer, by which they did not come.
#pragma once
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "visviva/contact/enclosure.hpp"
#include "visviva/contact/sides.hpp"

namespace visviva {

/// What both sides enclose in one configuration, which is nothing where they are open.
using Bodies = std::array<Enclosure, 2>;

class Entrances {
  public:
    Entrances() = default;
    /// Of both sides edges, whose vertices are followed, or themselves where a side is lines without
    /// triangles. What is no deeper than `shallow` is carried by the facet next to it, whichever it came by.
    Entrances(const Triangulated& first, const Triangulated& second, double shallow);

    /// How deep gaps are: what is next to a facet by which bodies hold each other is carried by that, and may
    /// slide along it, such as out of the side that flush bodies have and back.
    void carry(double seen) { near_ = std::max(shallow_, 2 * seen); }
    /// Makes X the start of a step: what is inside since the last one has come by the facet that it passed.
    /// What was deeper inside where the first step begins has come by none, then and later.
    void settle(const std::vector<double>& X, const Bodies& bodies);
    /// A place on a vertex or line of a side, in the other body, and the triangle of that it came in by.
    struct Place {
        int side, triangle;
        std::array<Eigen::Vector3d, 2> ends;
        Eigen::Vector3d x;
        double depth;
    };
    /// The deepest below the facets by which they came in, from the start of the step on or before, of those
    /// that count(place).
    template <class F>
    DeepPlace deepest(const std::vector<double>& X, const Bodies& bodies, F count) const;

    void write(std::vector<double>& memory) const { sides_.write(memory); }
    void read(const double*& memory) { sides_.read(memory); }

  private:
    // A vertex, twice, or a line between two.
    struct Probe {
        int a, b, side;
        Eigen::Vector3d at(const std::vector<double>& X, double share) const;
    };
    struct Below {
        int triangle;
        double depth;
    };
    // From the start of a step on; ways are those of both sides' triangles.
    struct Motion {
        const std::vector<double>&from, &to;
        Eigen::AlignedBox3d ways[2];
        Motion(const std::vector<double>& from, const std::vector<double>& to,
               const std::array<std::vector<int>, 2>& triangles);
    };
    static std::optional<double> inside(const Probe& probe, const std::vector<double>& X,
                                        const Enclosure& body);
    int side_of(int i, const Motion& motion, const Bodies& bodies) const;
    Below entered(int i, double share, const Motion& motion, const Bodies& bodies) const;
    int passed(const Probe& probe, double share, const Motion& motion, const Enclosure& body) const;
    static Below below(const Enclosure& body, int triangle, const Eigen::Vector3d& x, double same);
    bool carries(int side, int triangle, const Bodies& bodies) const;
    bool holds(const Triangle& first, const Triangle& second) const;

    std::vector<Probe> probes_;
    std::array<std::vector<int>, 2> triangles_;
    double shallow_ = 0, near_ = 0;
    Sides sides_;
};

template <class F>
DeepPlace Entrances::deepest(const std::vector<double>& X, const Bodies& bodies, F count) const {
    DeepPlace found;
    const Motion motion(sides_.start(), X, triangles_);
    for (int i = 0; i < static_cast<int>(probes_.size()); ++i) {
        const Probe& probe = probes_[i];
        const Enclosure& body = bodies[1 - probe.side];
        const std::optional<double> share = inside(probe, X, body);
        if (!share || body.is_shallow(probe.at(X, *share), shallow_)) continue;
        const auto [triangle, depth] = entered(i, *share, motion, bodies);
        if (triangle < 0) continue;
        const Eigen::Vector3d x = probe.at(X, *share);
        const Place place{probe.side, triangle, {probe.at(X, 0), probe.at(X, 1)}, x, depth};
        if (place.depth > found.depth && count(place)) found = {place.depth, x};
    }
    return found;
}

}  // namespace visviva
