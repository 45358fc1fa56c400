#include "visviva/contact/segment_points.hpp"

#include <algorithm>

// Not a kernel: integrated once, so that one instruction set does.
#define VISVIVA_ISA once
#include "visviva/contact/segment_geometry.hpp"

namespace visviva {

namespace {

using once::Planar, once::Vec;

void add(double weight, const double* N1, int n1, const double* N2, int n2, std::vector<SegmentPoint>& out) {
    SegmentPoint p{weight, {}, {}};
    std::copy_n(N1, n1, p.first), std::copy_n(N2, n2, p.second);
    out.push_back(p);
}

void add_triangle(const once::Outline<double>& o, int k, const FacetPair& pair,
                  const std::vector<RulePoint>& rule, std::vector<SegmentPoint>& out) {
    const once::Polygon<double>& polygon = o.polygon;
    const Planar<double>&a = polygon.p[polygon.n], ab = polygon.p[k] - a,
          ac = polygon.p[polygon.after(k)] - a;
    const double area = 0.5 * cross(ab, ac);
    for (const RulePoint& g : rule) {
        const Planar<double> p = {a.x + g.a * ab.x + g.b * ac.x, a.y + g.a * ab.y + g.b * ac.y};
        double N1[facet_corners], N2[facet_corners];
        once::corner_shapes(pair.n_first, once::inverted(o.f1, p), N1);
        once::corner_shapes(pair.n_second, once::inverted(o.f2, p), N2);
        add(g.w * area, N1, pair.n_first, N2, pair.n_second, out);
    }
}

}  // namespace

void add_points(const FacetPair& pair, const std::vector<RulePoint>& rule, std::vector<SegmentPoint>& out) {
    Vec<double> x[segment_corners];
    for (int k = 0; k < segment_corners; ++k) x[k] = {pair.x[k][0], pair.x[k][1], pair.x[k][2]};
    const Vec<double>* second = x + facet_corners;
    if (pair.n_first == 2) {
        once::integrate_2d(x, second, pair.range, false,
                           [&](double w, const double* N1, const double* N2, const Vec<double>&) {
                               add(w, N1, 2, N2, 2, out);
                           });
        return;
    }
    const auto o = once::outline(x, pair.n_first, second, pair.n_second, pair.range);
    for (int k = 0; o && k < o->polygon.n; ++k) add_triangle(*o, k, pair, rule, out);
}

}  // namespace visviva
