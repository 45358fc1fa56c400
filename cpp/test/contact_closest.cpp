// Distances from facets against those of planes and straight borders.
#include <doctest/doctest.h>

#include "dense.hpp"
#include "visviva/contact/closest.hpp"

using namespace visviva;

TEST_CASE("closest: beside a border, deep below its facet, what is beyond it counts by how far it is aside") {
    constexpr double part = 0.5, edge = 1.7;
    const Eigen::Vector3d axis = Eigen::Vector3d(0.3, -0.5, 0.8).normalized(), origin(0.2, -0.7, 0.4);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.9, axis).toRotationMatrix();
    const auto at = [&](double x, double y, double z) {
        return Eigen::Vector3d(origin + turn * Eigen::Vector3d(x, y, z));
    };
    FacetShape facet;
    facet.n = 3;
    facet.corner[0] = at(0, 0, 0), facet.corner[1] = at(edge, 0, 0), facet.corner[2] = at(0.6, 1.1, 0);
    const double up = facet.normal(0).dot(turn.col(2));
    for (double aside : {3e-9, 1e-8, 1e-6, 1e-3, 0.2})
        for (double along : {0.13, 0.77, 1.4}) {
            const Eigen::Vector3d x = at(along, -aside, -up * 1.3);
            const Foot rim = closest(facet, 0, x);
            REQUIRE(rim.n == 2);
            const Expansion gap = beyond_border(facet, rim, part, x);
            CHECK(std::abs(gap.value - (aside - part * edge)) < 1e-14);
            CHECK((gap.gradient.head<3>() + turn.col(1)).norm() < 1e-6);
        }
}
