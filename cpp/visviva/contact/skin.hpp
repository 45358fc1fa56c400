// The surfaces of a contact: vertices that are linear forms of unknowns, so that no contact knows what it
// touches, and facets of them.
#pragma once
#include <Eigen/Dense>
#include <vector>

#include "visviva/contact/segment.hpp"

namespace visviva {

struct Skin {
    int dim = 3;
    // Vertex v is constant[v] + sum of weight[k] * (the vector of unknowns from unknown[k] on), k from
    // first[v].
    std::vector<int> first, unknown;
    std::vector<double> weight, constant;
    std::vector<char> mesh_node;  // per form: its unknowns are those of one node of a mesh
    std::vector<int> facets;      // [facet][facet_corners], -1 behind the last corner; looking outwards
    // Of each facet, see Sight; empty: nothing is known of the bodies.
    std::vector<double> behind, ahead;
    int n_first = 0;       // facets of the first surface
    int second_begin = 0;  // the second one's go from here to the end; 0: the first touches itself

    int n_vertices() const { return static_cast<int>(first.size()) - 1; }
    int n_facets() const { return static_cast<int>(facets.size()) / facet_corners; }
    int n_corners(int facet) const {
        int n = facet_corners;
        while (facets[facet * facet_corners + n - 1] < 0) --n;
        return n;
    }
    const int* corners(int facet) const { return &facets[facet * facet_corners]; }

    /// Calls f(place, form) for the forms of vertices, with the place of each vertex in the list.
    template <class F>
    void each_form(const std::vector<int>& vertices, F f) const {
        for (int v = 0; v < static_cast<int>(vertices.size()); ++v)
            for (int k = first[vertices[v]]; k < first[vertices[v] + 1]; ++k) f(v, k);
    }

    /// Positions or increments of all vertices, three numbers each.
    void positions(const double* q, std::vector<double>& X) const;
    void increments(const double* dq, std::vector<double>& D) const;
    /// Adds a force on a vertex to the entries of the unknowns, times `factor`.
    void add_force(int vertex, const double* f, double factor, double* r) const;

  private:
    void evaluate(const double* q, std::vector<double>& X) const;
};

/// A corner of a facet with its neighbours along the edge of the facet; in the plane one of them is missing.
struct Corner {
    int next, previous;
};

/// Averaged normals of vertices: m = sum over corners of (next - a) x (previous - a), n = m / |m|.
struct NormalField {
    std::vector<int> start;  // per vertex, into corners
    std::vector<Corner> corners;
    int dim = 3;

    void build(const Skin&);
    void sum(const double* X, int vertex, double* m) const;
    bool normal(const double* X, int vertex, double* n) const;
    /// Sum of unit normals weighted by angles: it tells inside from outside (Baerentzen & Aanaes 2005).
    Eigen::Vector3d by_angles(const double* X, int vertex) const;
};

}  // namespace visviva
