// Closest points of facets, and the distance from a point to points, lines and planes with its derivatives.
#pragma once
#include <Eigen/Dense>

#include "visviva/contact/segment.hpp"

namespace visviva {

struct Foot;

/// A facet as simplices: itself, or for four corners triangles about their mean, so that closest points are
/// known in closed form.
struct FacetShape {
    static constexpr int centre = facet_corners;
    int n = 0, dim = 3;
    Eigen::Vector3d corner[facet_corners + 1];  // and their mean

    int n_simplices() const { return n == 4 ? 4 : 1; }
    /// Of the corners of a simplex, the i-th.
    int vertex(int simplex, int i) const {
        if (n < 4) return i;
        return i == 2 ? centre : (simplex + i) % 4;
    }
    /// Outward unit normal; zero if degenerate.
    Eigen::Vector3d normal(int simplex) const;
    /// Length by which distances are small or not.
    double size() const { return (corner[1] - corner[0]).norm(); }
    Eigen::Vector3d middle(int simplex) const;
    Eigen::Vector3d place(const Foot& foot) const;
    /// Of a place above the plane of a simplex.
    double height(int simplex, const Eigen::Vector3d& x) const {
        return normal(simplex).dot(x - corner[vertex(simplex, 0)]);
    }
    /// Share of a corner of the facet in a vertex of a simplex.
    double share(int vertex, int corner) const {
        return vertex == centre ? 1.0 / n : vertex == corner ? 1.0 : 0.0;
    }
};

/// The part of a simplex that holds the closest point: so many of its vertices, with barycentric coordinates.
struct Foot {
    int simplex = 0, n = 0;
    int vertex[3] = {};
    double coordinate[3] = {};
    double distance = 0;
};

/// Whether each of two simplices is in front of the other one by more than this part of its size.
bool lean_together(const FacetShape& facet, int simplex, const FacetShape& other, int its, double part);

Foot closest(const FacetShape& facet, int simplex, const Eigen::Vector3d& x);

/// The closest point of the edge between two of the facet's corners, its ends included.
Foot on_edge(const FacetShape& facet, int simplex, int a, int b, const Eigen::Vector3d& x);

/// The whole simplex, for the distance to its plane.
Foot whole(const FacetShape& facet, int simplex, const Eigen::Vector3d& x);

/// First and second derivatives of a signed distance by x and the facet's corners, where its gradient by x is
/// the unit vector `normal`.
void differentiate(const FacetShape& facet, const Foot& foot, const Eigen::Vector3d& normal, double distance,
                   Eigen::VectorXd& gradient, Eigen::MatrixXd* hessian);

/// A function to second order: its value and derivatives by x and the facet's corners.
struct Expansion {
    double value = 0;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;
};

/// Squared distance of x from the plane, line or point of a foot.
Expansion squared_distance(const FacetShape& facet, const Foot& foot, const Eigen::Vector3d& x);

/// Distance from a body that is rounded off, with a radius that is `part` of a facet, beyond the border where
/// the closest foot `rim` is, and whose side is across the facet.
Expansion beyond_border(const FacetShape& facet, const Foot& rim, double part, const Eigen::Vector3d& x);

/// Derivatives of the foot's coordinates (one row each) by x and the facet's corners.
Eigen::MatrixXd coordinate_gradients(const FacetShape& facet, const Foot& foot, const Eigen::Vector3d& normal,
                                     double distance);

}  // namespace visviva
