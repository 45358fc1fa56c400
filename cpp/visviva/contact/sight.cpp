#include "visviva/contact/sight.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "visviva/base/parallel.hpp"
#include "visviva/contact/closest.hpp"
#include "visviva/contact/search.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;

constexpr double alike = 0.5;   // cosine of the angle up to which facets of two bodies do not face each other
constexpr double slack = 1e-9;  // rays through edges meet one of the simplices beside it

// Where a ray meets a simplex, as a distance along it; infinite if it does not.
double crossing(const FacetShape& facet, int simplex, const Vector3& origin, const Vector3& direction) {
    const Vector3 normal = facet.normal(simplex), &a = facet.corner[facet.vertex(simplex, 0)];
    const double across = normal.dot(direction);
    if (across == 0) return HUGE_VAL;
    const double t = normal.dot(a - origin) / across;
    const Foot foot = whole(facet, simplex, origin + t * direction);
    const bool inside =
        std::all_of(foot.coordinate, foot.coordinate + facet.dim, [](double c) { return c > -slack; });
    return inside && t > 0 ? t : HUGE_VAL;
}

class Rays {
  public:
    Rays(int dim, const std::vector<double>& X, const std::vector<int>& facets) {
        skin_.dim = dim, skin_.facets = facets;
        std::vector<Box> boxes;
        std::vector<double> centres;
        for (int f = 0; f < skin_.n_facets(); ++f) {
            shapes_.push_back(shape(X, f));
            boxes.push_back(swept(skin_, f, X.data(), X.data(), slack * size(f)));
            for (int i = 0; i < 3; ++i) centres.push_back(0.5 * (boxes[f].low[i] + boxes[f].high[i]));
        }
        tree_.build(centres), tree_.refit(boxes);
    }

    struct Hit {
        double distance = HUGE_VAL;
        int facet = -1;
    };

    // The first facet that looks along the ray, or against it.
    Hit first(int own, const Vector3& origin, const Vector3& direction, bool along) const {
        Hit hit;
        tree_.query({origin.data(), direction.data()}, [&](int f) {
            for (int s = 0; f != own && s < shapes_[f].n_simplices(); ++s) {
                if ((shapes_[f].normal(s).dot(direction) > 0) != along) continue;
                const double t = crossing(shapes_[f], s, origin, direction);
                if (t < hit.distance || (t == hit.distance && f < hit.facet)) hit = {t, f};
            }
            return hit.distance;
        });
        return hit;
    }

    // Whether a facet is within a distance of x that is chosen and does not look along a normal.
    template <class Chosen>
    bool near(const Vector3& x, const Vector3& normal, double distance, Chosen chosen) const {
        Box box;
        for (int i = 0; i < 3; ++i) box.low[i] = x[i] - distance, box.high[i] = x[i] + distance;
        std::vector<int> found;
        tree_.query(box, found);
        return std::any_of(found.begin(), found.end(), [&](int f) {
            for (int s = 0; chosen(f) && s < shapes_[f].n_simplices(); ++s)
                if (shapes_[f].normal(s).dot(normal) < alike &&
                    closest(shapes_[f], s, x).distance <= distance)
                    return true;
            return false;
        });
    }

    const FacetShape& shape(int f) const { return shapes_[f]; }
    int n() const { return static_cast<int>(shapes_.size()); }

  private:
    FacetShape shape(const std::vector<double>& X, int f) const {
        FacetShape s;
        s.n = skin_.n_corners(f), s.dim = skin_.dim;
        s.corner[FacetShape::centre].setZero();
        for (int i = 0; i < s.n; ++i) {
            s.corner[i] = Eigen::Map<const Vector3>(&X[3 * skin_.corners(f)[i]]);
            s.corner[FacetShape::centre] += s.corner[i] / s.n;
        }
        return s;
    }
    double size(int f) const {
        const FacetShape& s = shapes_[f];
        return std::max((s.corner[1] - s.corner[0]).norm(), (s.corner[s.n - 1] - s.corner[0]).norm());
    }

    Skin skin_;
    std::vector<FacetShape> shapes_;
    BoxTree tree_;
};

// Calls f(point, normal) in the middle of a facet and half way to its corners.
template <class F>
void each_sample(const FacetShape& facet, F f) {
    const Vector3& middle = facet.corner[FacetShape::centre];
    Vector3 normal = Vector3::Zero();
    for (int s = 0; s < facet.n_simplices(); ++s) normal += facet.normal(s);
    if (!(normal.norm() > 0)) return;
    normal.normalize();
    f(middle, normal);
    for (int i = 0; i < facet.n; ++i) f(Vector3(0.5 * (middle + facet.corner[i])), normal);
}

}  // namespace

std::vector<Sight> find_sights(int dim, const std::vector<double>& X, const std::vector<int>& facets) {
    const Rays rays(dim, X, facets);
    std::vector<Sight> sights(rays.n(), {HUGE_VAL, HUGE_VAL});
    parallel_for(rays.n(), [&](int f) {
        each_sample(rays.shape(f), [&](const Vector3& x, const Vector3& n) {
            sights[f].behind = std::min(sights[f].behind, rays.first(f, x, -n, true).distance);
        });
    });
    parallel_for(rays.n(), [&](int f) {
        double farthest = 0;
        each_sample(rays.shape(f), [&](const Vector3& x, const Vector3& n) {
            const Rays::Hit hit = rays.first(f, x, n, false);
            farthest =
                std::max(farthest, hit.facet < 0 ? HUGE_VAL : hit.distance + sights[hit.facet].behind / 2);
        });
        if (farthest > 0) sights[f].ahead = farthest;
    });
    return sights;
}

std::vector<double> find_unseen(int dim, const Side& own, const Side& other, const std::vector<int>& touched,
                                double reach) {
    const Rays mine(dim, own.X, own.facets), rays(dim, other.X, other.facets);
    std::vector<double> depths(mine.n(), 0.0);
    Eigen::AlignedBox3d bounds;
    for (std::size_t i = 0; i < other.X.size(); i += 3) bounds.extend(Vector3(Vector3::Map(&other.X[i])));
    parallel_for(mine.n(), [&](int f) {
        each_sample(mine.shape(f), [&](const Vector3& x, const Vector3& n) {
            if (!bounds.contains(x)) return;
            const Rays::Hit out = rays.first(-1, x, -n, true);
            if (out.facet < 0 || !touched[out.facet]) return;
            const double seen = std::min(reach, deepest(own.behind[f], other.behind[out.facet]));
            // a ray that grazes an edge goes in where it goes out
            const double in = rays.first(-1, x, -n, false).distance;
            if (out.distance <= seen || in <= (1 + slack) * out.distance) return;
            if (!rays.near(x, n, seen, [&](int g) { return touched[g]; }))
                depths[f] = std::max(depths[f], out.distance);
        });
    });
    return depths;
}

double deepest(double one, double two) {
    const bool both = std::isfinite(one) && std::isfinite(two);
    return both ? 0.5 * (one + two) : std::min(one, two);
}

}  // namespace visviva
