// What the copies of a ball hold where facets lean together over it.
#include <doctest/doctest.h>

#include <cmath>

#include "visviva/contact/gaps.hpp"

using namespace visviva;

namespace {

// A ball of radius 0.75 over the ends of two rails in the plane, at x = -0.5 and 0.5; two copies of it.
constexpr double radius = 0.75;

std::unique_ptr<Gaps> over_rails() {
    Skin skin;
    skin.dim = 2;
    for (int v = 0; v <= 6; ++v) skin.first.push_back(v);
    for (int v = 0; v < 6; ++v) skin.unknown.push_back(2 * v);
    skin.weight.assign(6, 1.0), skin.constant.assign(18, 0.0), skin.mesh_node.assign(6, 0);
    skin.facets = {2, 3, -1, -1, 4, 5, -1, -1};
    PointOptions options;
    options.areas = {1, 1}, options.behind = {HUGE_VAL, HUGE_VAL};
    options.radius = radius, options.reach = 1, options.copies = 2;
    return make_node_to_segment(skin, options);
}

std::vector<double> at(double x, double y) {
    return {x, y, 0, x, y, 0, -0.5, 0, 0, -1.5, 0, 0, 1.5, 0, 0, 0.5, 0, 0};
}

}  // namespace

TEST_CASE("valley: a ball whose centre comes to an edge that it holds is pushed off the facet") {
    const auto gaps = over_rails();
    const std::vector<double> before = at(0, 0.5);
    gaps->set_static(false), gaps->keep_sides();
    gaps->search(before.data(), before.data());
    gaps->settle(before.data());
    gaps->search(before.data(), before.data());

    double gap[2], area[2];
    gaps->values(before.data(), gap, area);
    for (double g : gap) CHECK(g == doctest::Approx(std::sqrt(0.5) - radius));  // both rails are held

    const std::vector<double> on_edge = at(-0.5, 0);
    gaps->values(on_edge.data(), gap, area);
    CHECK(std::min(gap[0], gap[1]) == doctest::Approx(-radius));
    CHECK(std::max(gap[0], gap[1]) == doctest::Approx(1 - radius));
    std::vector<Gap> found(2);
    gaps->gradients(on_edge.data(), {1, 1}, found);
    const int left = gap[0] < gap[1] ? 0 : 1;
    CHECK(found[left].gradient[0] == doctest::Approx(0));
    CHECK(found[left].gradient[1] == doctest::Approx(1));
    CHECK(found[1 - left].gradient[0] == doctest::Approx(-1));  // as it was
}
