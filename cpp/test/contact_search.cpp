// The tree of bounding boxes against looking at every box.
#include <doctest/doctest.h>

#include "dense.hpp"
#include "visviva/contact/search.hpp"

using namespace visviva;

namespace {

struct Boxes {
    std::vector<Box> boxes;
    std::vector<double> centres;

    // Some of them flat, some at the same place.
    Boxes(Numbers& numbers, int n) {
        for (int k = 0; k < n; ++k) {
            Box b;
            for (int i = 0; i < 3; ++i) {
                const double middle = k % 5 == 4 ? centres[centres.size() - 3] : 4 * numbers.one();
                const double half = k % 7 == 3 ? 0 : 0.3 * (1 + numbers.one());
                b.low[i] = middle - half, b.high[i] = middle + half;
                centres.push_back(middle);
            }
            boxes.push_back(b);
        }
    }
    std::vector<int> meeting(const Box& box) const {
        std::vector<int> all;
        for (std::size_t k = 0; k < boxes.size(); ++k)
            if (boxes[k].meets(box)) all.push_back(static_cast<int>(k));
        return all;
    }
};

// Where a ray enters a box, by its crossings of the planes of all faces.
double entrance(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Box& box) {
    std::vector<double> at = {0};
    for (int i = 0; i < 3; ++i)
        for (double plane : {box.low[i], box.high[i]})
            if (direction[i] != 0) at.push_back((plane - origin[i]) / direction[i]);
    double nearest = HUGE_VAL;
    for (double t : at) {
        const Eigen::Vector3d x = origin + t * direction;
        bool in = t >= 0;
        for (int i = 0; i < 3; ++i) in = in && x[i] > box.low[i] - 1e-12 && x[i] < box.high[i] + 1e-12;
        if (in) nearest = std::min(nearest, t);
    }
    return nearest;
}

}  // namespace

TEST_CASE("search: boxes that meet one, after boxes have moved as well") {
    Numbers numbers(81);
    for (int n : {0, 1, 2, 3, 100, 1000}) {
        Boxes all(numbers, n);
        BoxTree tree;
        tree.build(all.centres);
        std::vector<int> found = {-7};
        std::size_t met = 0;
        for (int time = 0; time < 2; ++time) {
            tree.refit(all.boxes);
            for (const Box& box : Boxes(numbers, 40).boxes) {
                tree.query(box, found);
                CHECK(found == all.meeting(box));
                met += found.size();
            }
            all.boxes = Boxes(numbers, n).boxes;  // the tree is no longer a good one, but right
        }
        if (n >= 100) CHECK(met > 0);
    }
}

TEST_CASE("search: boxes that touch do meet") {
    const Box a{{0, 0, 0}, {1, 1, 1}}, b{{1, 1, 1}, {2, 2, 2}}, c{{1.0000001, 0, 0}, {2, 1, 1}};
    CHECK(a.meets(b));
    CHECK(b.meets(a));
    CHECK_FALSE(a.meets(c));
}

TEST_CASE("search: the first box along a ray, and where it is entered") {
    Numbers numbers(82);
    const Boxes all(numbers, 300);
    BoxTree tree;
    tree.build(all.centres), tree.refit(all.boxes);
    int hits = 0;
    for (int k = 0; k < 200; ++k) {
        const Eigen::Vector3d origin = 5 * numbers.vector(3);
        Eigen::Vector3d direction = numbers.vector(3);
        if (k % 4 == 0) direction[k % 3] = 0;
        const Ray ray{origin.data(), direction.data()};
        double nearest = HUGE_VAL;
        for (const Box& box : all.boxes) {
            const double here = entrance(origin, direction, box);
            if (here < HUGE_VAL)
                CHECK(ray.entrance(box) == doctest::Approx(here).epsilon(1e-9));
            else
                CHECK(ray.entrance(box) == HUGE_VAL);
            nearest = std::min(nearest, here);
        }
        double found = HUGE_VAL;
        tree.query(ray, [&](int box) {
            const double here = entrance(origin, direction, all.boxes[box]);
            if (here < HUGE_VAL) found = std::min(found, here);
            return found;
        });
        CHECK(found == nearest);
        hits += nearest < HUGE_VAL;
    }
    CHECK(hits > 20);
}

TEST_CASE("search: what a facet sweeps holds both of its ends and the margin") {
    Skin skin;
    skin.first = {0, 0, 0, 0, 0};
    skin.facets = {0, 2, 3, -1};
    const double from[12] = {0, 0, 0, 9, 9, 9, 1, 0, 0.5, 0, 1, 0},
                 to[12] = {2, 0, 0, 9, 9, 9, 1, -3, 0, 0, 1, 1};
    const Box box = swept(skin, 0, from, to, 0.25);
    const double low[3] = {-0.25, -3.25, -0.25}, high[3] = {2.25, 1.25, 1.25};
    for (int i = 0; i < 3; ++i) {
        CHECK(box.low[i] == low[i]);
        CHECK(box.high[i] == high[i]);
    }
}
