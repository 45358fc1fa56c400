// Mortar segments: common polygons against those found by another algorithm, integrals against closed forms,
// derivatives against differences.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "dense.hpp"
#include "visviva/contact/segment_points.hpp"

using namespace visviva;
using Eigen::MatrixXd, Eigen::Vector2d, Eigen::Vector3d, Eigen::VectorXd;

namespace {

using Corners = std::vector<Vector3d>;

FacetPair facets(const Corners& first, const Corners& second) {
    FacetPair p{};
    p.n_first = static_cast<int>(first.size()), p.n_second = static_cast<int>(second.size());
    for (int k = 0; k < p.n_first; ++k) Vector3d::Map(p.x[k]) = first[k];
    for (int k = 0; k < p.n_second; ++k) Vector3d::Map(p.x[facet_corners + k]) = second[k];
    return p;
}

Segment value(const FacetPair& p) {
    Segment s;
    segment_kernels().value(p, s);
    return s;
}
SegmentWeights weights(const FacetPair& p) {
    SegmentWeights w;
    segment_kernels().weights(p, w);
    return w;
}
double area(const Segment& s) { return std::accumulate(s.area, s.area + facet_corners, 0.0); }
Vector3d moment(const Segment& s) {
    Vector3d sum = Vector3d::Zero();
    for (const auto& v : s.V) sum += Vector3d(v[0], v[1], v[2]);
    return sum;
}

// A polygon about the origin: convex, counter-clockwise.
Corners polygon(Numbers& numbers, int n, double height) {
    Corners all;
    const double turn = numbers.one();
    for (int k = 0; k < n; ++k) {
        const double angle = 2 * M_PI * (k + 0.3 * numbers.one()) / n + turn;
        all.push_back({std::cos(angle), std::sin(angle), height});
    }
    return all;
}
Corners reversed(Corners c) { return std::reverse(c.begin(), c.end()), c; }

double cross(const Vector2d& a, const Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

// Area of the common part of two convex polygons, which are counter-clockwise: its corners are what lies in
// both among the corners and the crossings of lines, sorted by angle.
double common_area(const Corners& first, const Corners& second) {
    std::vector<std::pair<Vector2d, Vector2d>> lines;
    for (const Corners* c : {&first, &second})
        for (std::size_t k = 0; k < c->size(); ++k)
            lines.push_back({(*c)[k].head<2>(), (*c)[(k + 1) % c->size()].head<2>()});
    std::vector<Vector2d> inside;
    for (std::size_t i = 0; i < lines.size(); ++i)
        for (std::size_t j = i + 1; j < lines.size(); ++j) {
            const Vector2d a = lines[i].second - lines[i].first, b = lines[j].second - lines[j].first;
            if (std::abs(cross(a, b)) < 1e-12) continue;
            const Vector2d x = lines[i].first + cross(lines[j].first - lines[i].first, b) / cross(a, b) * a;
            if (std::all_of(lines.begin(), lines.end(),
                            [&](const auto& l) { return cross(l.second - l.first, x - l.first) > -1e-12; }))
                inside.push_back(x);
        }
    if (inside.size() < 3) return 0;
    Vector2d centre = Vector2d::Zero();
    for (const Vector2d& x : inside) centre += x / static_cast<double>(inside.size());
    std::sort(inside.begin(), inside.end(), [&](const Vector2d& a, const Vector2d& b) {
        return std::atan2(a[1] - centre[1], a[0] - centre[0]) <
               std::atan2(b[1] - centre[1], b[0] - centre[0]);
    });
    double sum = 0;
    for (std::size_t k = 0; k < inside.size(); ++k)
        sum += 0.5 * cross(inside[k] - centre, inside[(k + 1) % inside.size()] - centre);
    return sum;
}

Corners moved(const Corners& c, const Eigen::Matrix3d& turn, const Vector3d& shift) {
    Corners all;
    for (const Vector3d& x : c) all.push_back(turn * x + shift);
    return all;
}

// Pairs of facets in general position, with all that makes integrals different.
struct Case {
    const char* name;
    FacetPair pair;
};
const double dual[facet_corners][facet_corners] = {
    {4, -2, 1, -2}, {-2, 4.5, -2, 1}, {1, -2, 3.5, -2}, {-2, 1, -2, 4}};

std::vector<Case> cases() {
    Numbers numbers(71);
    std::vector<Case> all;
    const auto shaken = [&](Corners c, double by) {
        for (Vector3d& x : c) x += by * Vector3d(numbers.vector(3));
        return c;
    };
    for (int n1 : {3, 4})
        for (int n2 : {3, 4}) {
            const Corners first = shaken(polygon(numbers, n1, 0), 0.08),
                          second = shaken(moved(reversed(polygon(numbers, n2, 0.3)),
                                                Eigen::Matrix3d::Identity(), {0.5, 0.3, 0}),
                                          0.08);
            all.push_back({"plain", facets(first, second)});
            all.push_back({"dual", facets(first, second)});
            all.back().pair.dual = dual;
            all.push_back({"fading with the distance", facets(first, second)});
            all.back().pair.range.reach = 0.45;
            const Eigen::Matrix3d tilt = Eigen::AngleAxisd(1.38, Vector3d::UnitX()).toRotationMatrix();
            all.push_back({"fading with the angle", facets(first, moved(second, tilt, {0, 0.6, 0.2}))});
        }
    const Corners edge = {{2, 0, 0}, {3, 0.1, 0}}, other = {{2.7, 0.2 - 0.5, 0}, {1.6, -0.2, 0}};
    all.push_back({"edges", facets(edge, other)});
    all.push_back({"edges, dual", facets(edge, other)});
    all.back().pair.dual = dual;
    all.push_back({"edges, axisymmetric", facets(edge, other)});
    all.back().pair.axisymmetric = true;
    all.push_back({"edges, fading", facets(edge, other)});
    all.back().pair.range.reach = 0.5;
    return all;
}

VectorXd places(const FacetPair& p) { return VectorXd::Map(p.x[0], segment_size); }
FacetPair at(FacetPair p, const VectorXd& x) {
    VectorXd::Map(p.x[0], segment_size) = x;
    return p;
}
// Corners that the facets have; in the plane the third coordinates stay.
std::vector<int> varied(const FacetPair& p) {
    std::vector<int> all;
    for (int k = 0; k < segment_corners; ++k)
        for (int i = 0; i < (p.n_first == 2 ? 2 : 3); ++i)
            if (k < p.n_first || (k >= facet_corners && k - facet_corners < p.n_second))
                all.push_back(3 * k + i);
    return all;
}
template <class F>
MatrixXd slopes(const FacetPair& p, F f) {
    return by_differences([&](const VectorXd& x) { return VectorXd(f(at(p, x))); }, places(p), 1e-4)(
        Eigen::all, varied(p));
}

}  // namespace

TEST_CASE("segments: the common polygon of flat facets, wherever they are") {
    Numbers numbers(72);
    int apart = 0;
    for (int k = 0; k < 200; ++k) {
        const int n1 = 3 + numbers.below(2), n2 = 3 + numbers.below(2);
        const Corners first = polygon(numbers, n1, 0);
        const Vector3d shift(1.2 * numbers.one(), 1.2 * numbers.one(), 0);
        const Corners second = moved(polygon(numbers, n2, -0.2), Eigen::Matrix3d::Identity(), shift);
        const double common = common_area(first, second);
        const Eigen::Matrix3d turn = numbers.rotation();
        const Vector3d by = numbers.vector(3);
        const FacetPair pair = facets(moved(first, turn, by), moved(reversed(second), turn, by));
        const Segment s = value(pair);
        if (common < 1e-12) {
            CHECK_FALSE(s.any);
            ++apart;
            continue;
        }
        REQUIRE(s.any);
        CHECK(std::abs(area(s) - common) < 1e-12);
        CHECK((moment(s) - turn * Vector3d(0, 0, -0.2 * common)).norm() < 1e-12);
        const SegmentWeights w = weights(pair);
        for (int a = 0; a < n1; ++a) {  // shapes sum up to one, on both sides
            CHECK(w.area[a] == doctest::Approx(s.area[a]).epsilon(1e-12));
            CHECK(std::abs(std::accumulate(w.first[a], w.first[a] + n1, 0.0) - w.area[a]) < 1e-12);
            CHECK(std::abs(std::accumulate(w.second[a], w.second[a] + n2, 0.0) - w.area[a]) < 1e-12);
        }
        std::vector<SegmentPoint> points;
        add_points(pair, {{1.0 / 3, 1.0 / 3, 1}}, points);
        double sum = 0;
        for (const SegmentPoint& p : points) {
            sum += p.weight;
            CHECK(std::accumulate(p.first, p.first + n1, 0.0) == doctest::Approx(1).epsilon(1e-12));
            CHECK(std::accumulate(p.second, p.second + n2, 0.0) == doctest::Approx(1).epsilon(1e-12));
        }
        CHECK(std::abs(sum - common) < 1e-12);
    }
    CHECK(apart > 5);
}

TEST_CASE("segments: rectangles, of which all integrals are known") {
    // shapes x y on the unit square, of which [s, 1] x [t, 1] is covered; a slope in the gap
    const double s = 0.3, t = 0.45;
    const Corners first = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const auto height = [](double x) { return 0.1 + 0.2 * x; };
    const Corners second = {{s, t, height(s)}, {s, 2, height(s)}, {2, 2, height(2)}, {2, t, height(2)}};
    const Segment segment = value(facets(first, second));
    REQUIRE(segment.any);
    const double X[2] = {(1 - s) - (1 - s * s) / 2, (1 - s * s) / 2};  // of 1 - x and x
    const double xX[2] = {(1 - s * s) / 2 - (1 - s * s * s) / 3, (1 - s * s * s) / 3};
    const double Y[2] = {(1 - t) - (1 - t * t) / 2, (1 - t * t) / 2};
    const int i[4] = {0, 1, 1, 0}, j[4] = {0, 0, 1, 1};
    for (int a = 0; a < 4; ++a) {
        CHECK(segment.area[a] == doctest::Approx(X[i[a]] * Y[j[a]]).epsilon(1e-12));
        CHECK(segment.V[a][2] == doctest::Approx((0.1 * X[i[a]] + 0.2 * xX[i[a]]) * Y[j[a]]).epsilon(1e-12));
        CHECK(std::abs(segment.V[a][0]) + std::abs(segment.V[a][1]) < 1e-15);
    }
}

TEST_CASE("segments: edges in the plane and about an axis, of which all integrals are known") {
    // outward of the first is down; over [2.25, 3] both are there, the second below by 0.5
    FacetPair p = facets({{2, 1, 0}, {3, 1, 0}}, {{4, 0.5, 0}, {2.25, 0.5, 0}});
    Segment s = value(p);
    REQUIRE(s.any);
    CHECK(s.area[1] == doctest::Approx((1 - 0.25 * 0.25) / 2).epsilon(1e-12));
    CHECK(area(s) == doctest::Approx(0.75).epsilon(1e-12));
    CHECK((moment(s) - Vector3d(0, -0.5 * 0.75, 0)).norm() < 1e-14);
    p.axisymmetric = true;
    s = value(p);
    CHECK(area(s) == doctest::Approx(M_PI * (9 - 2.25 * 2.25)).epsilon(1e-12));
}

TEST_CASE("segments: what looks away or is beyond reach does not count, and what is between fades") {
    const Corners first = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    CHECK_FALSE(value(facets(first, first)).any);
    const auto over = [&](double height, double reach) {
        FacetPair p = facets(first, moved(reversed(first), Eigen::Matrix3d::Identity(), {0, 0, height}));
        p.range.reach = reach;
        return value(p);
    };
    for (double side : {1.0, -1.0}) {
        CHECK(area(over(0.49 * side, 1)) == doctest::Approx(1).epsilon(1e-13));
        CHECK(area(over(0.75 * side, 1)) == doctest::Approx(0.5).epsilon(1e-13));
        CHECK_FALSE(over(1.01 * side, 1).any);
        CHECK(over(3 * side, 0).any);
    }
    FacetPair p = facets(first, moved(reversed(first), Eigen::Matrix3d::Identity(), {0, 0, -0.4}));
    p.range.inside = 0.3;
    CHECK_FALSE(value(p).any);
    p.range.inside = 0.5;
    CHECK(value(p).any);
}

TEST_CASE("segments: first and second derivatives against differences") {
    Numbers numbers(73);
    for (const Case& c : cases()) {
        const FacetPair& p = c.pair;
        const std::string name = c.name;
        CAPTURE(name);
        CAPTURE(p.n_first);
        CAPTURE(p.n_second);
        double n[facet_corners][3], u[facet_corners][3];
        for (auto* covectors : {n, u})
            for (int a = 0; a < facet_corners; ++a)
                for (int i = 0; i < 3; ++i) covectors[a][i] = p.n_first == 2 && i == 2 ? 0 : numbers.one();
        VectorXd direction = VectorXd::Zero(segment_size);
        for (int i : varied(p)) direction[i] = numbers.one();
        const std::vector<int> all = varied(p);

        const auto along = [&](const FacetPair& pair) {  // n_a . V_a
            const Segment s = value(pair);
            REQUIRE(s.any);
            VectorXd r(p.n_first);
            for (int a = 0; a < p.n_first; ++a) r[a] = Vector3d::Map(s.V[a]).dot(Vector3d::Map(n[a]));
            return r;
        };
        Segment g;
        segment_kernels().gradient(p, n, g);
        REQUIRE(g.any);
        MatrixXd got(p.n_first, all.size());
        for (int a = 0; a < p.n_first; ++a) got.row(a) = VectorXd::Map(g.g[a], segment_size)(all).transpose();
        CHECK(difference(got, slopes(p, along)) < 1e-8);

        Segment s;
        segment_kernels().second(p, u, n, direction.data(), s);
        REQUIRE(s.any);
        const auto vectors = [&](const FacetPair& pair) {
            return VectorXd(VectorXd::Map(value(pair).V[0], 3 * p.n_first));
        };
        CHECK(difference(VectorXd::Map(s.V[0], 3 * p.n_first), vectors(p)) < 1e-13);
        MatrixXd J(3 * p.n_first, all.size());
        for (int a = 0; a < p.n_first; ++a)
            for (int i = 0; i < 3; ++i)
                J.row(3 * a + i) = VectorXd::Map(s.J[a][i], segment_size)(all).transpose();
        CHECK(difference(J, slopes(p, vectors)) < 1e-8);

        const auto gradient_of_sum = [&](const FacetPair& pair) {
            Segment t;
            segment_kernels().gradient(pair, u, t);
            VectorXd sum = VectorXd::Zero(segment_size);
            for (int a = 0; a < p.n_first; ++a) sum += VectorXd::Map(t.g[a], segment_size);
            return VectorXd(sum(all));
        };
        MatrixXd H(segment_size, segment_size);
        for (int i = 0; i < segment_size; ++i) H.row(i) = VectorXd::Map(s.H[i], segment_size).transpose();
        CHECK(difference(H(all, all), slopes(p, gradient_of_sum)) < 1e-7);
        CHECK(difference(H, H.transpose()) < 1e-12);

        const auto gradients = [&](const FacetPair& pair) {
            Segment t;
            segment_kernels().gradient(pair, n, t);
            VectorXd r(p.n_first * static_cast<Eigen::Index>(all.size()));
            for (int a = 0; a < p.n_first; ++a)
                r.segment(a * static_cast<Eigen::Index>(all.size()), all.size()) =
                    VectorXd::Map(t.g[a], segment_size)(all);
            return r;
        };
        const VectorXd turned = slopes(p, gradients) * direction(all);
        VectorXd HD(turned.size());
        for (int a = 0; a < p.n_first; ++a)
            HD.segment(a * static_cast<Eigen::Index>(all.size()), all.size()) =
                VectorXd::Map(s.HD[a], segment_size)(all);
        CHECK(difference(HD, turned) < 1e-7);
    }
}

TEST_CASE("segments: derivatives of the weights against differences") {
    for (const Case& c : cases()) {
        const FacetPair& p = c.pair;
        const std::string name = c.name;
        CAPTURE(name);
        const auto flat = [](const SegmentWeights& w) {
            VectorXd r(2 * facet_corners * facet_corners);
            r << VectorXd::Map(w.first[0], r.size() / 2), VectorXd::Map(w.second[0], r.size() / 2);
            return r;
        };
        SegmentWeights w;
        SegmentWeightGradients g;
        segment_kernels().weight_gradients(p, w, g);
        CHECK(difference(flat(w), flat(weights(p))) < 1e-14);
        const MatrixXd wanted = slopes(p, [&](const FacetPair& pair) { return flat(weights(pair)); });
        MatrixXd got(wanted.rows(), wanted.cols());
        for (int k = 0; k < wanted.rows(); ++k) {
            const int i = k % (facet_corners * facet_corners), a = i / facet_corners, b = i % facet_corners;
            const double* row = k < wanted.rows() / 2 ? g.first[a][b] : g.second[a][b];
            got.row(k) = VectorXd::Map(row, segment_size)(varied(p)).transpose();
        }
        CHECK(difference(got, wanted) < 1e-8);
    }
}
