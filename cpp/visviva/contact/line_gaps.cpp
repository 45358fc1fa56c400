// Gaps between round bars: of points along the middle of one to the middle of the other, less both radii.
// The closest point may be an end or a joint of segments, so that what crosses, lies along or slides off is
// one function of the positions, continuous with its gradient.
#include <algorithm>
#include <cmath>

#include "visviva/base/parallel.hpp"
#include "visviva/contact/closest.hpp"
#include "visviva/contact/point_gaps.hpp"
#include "visviva/contact/search.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

struct Candidate {
    int facet, local[2];  // a segment, and the places of its ends in the stencil
};

class LineGaps : public PointGaps {
  public:
    LineGaps(Skin skin, PointOptions options, OwnSegments beside)
        : PointGaps(std::move(skin), std::move(options)), beside_(std::move(beside)), candidates_(n_) {}
    bool search(const double* from, const double* to) override;
    void approaches(const double* from, const double* to, std::vector<Approach>& out) const override;

  protected:
    Reach distance(const double* X, int vertex, int derivatives, Distance& out) const override;
    double way(const double* from, const double* to, int vertex) const override;
    bool is_inside(const double*, int) const override { return false; }
    int nearest_side(const double*, int) const override { return Sides::nearest; }
    int entrance(const double*, const double*, int) const override { return Sides::nearest; }
    double depth(const double*, int, int) const override { return 0; }
    bool are_same(const double*, int side, int other) const override { return side == other; }
    void grip(const double*, int, bool, Grip&) const override {
        throw std::logic_error("friction is not known for bars");
    }

  private:
    bool is_beside(int A, int f) const {
        const int *begin = beside_.own.data() + beside_.start[A],
                  *end = beside_.own.data() + beside_.start[A + 1];
        return std::find(begin, end, f) != end;
    }
    FacetShape shape(const double* X, int f) const;
    void make_stencil(int A, const std::vector<int>& facets);

    OwnSegments beside_;
    PointSearch near_facets_;
    std::vector<std::vector<Candidate>> candidates_;
};

FacetShape LineGaps::shape(const double* X, int f) const {
    FacetShape s;
    s.n = 2;
    for (int i = 0; i < 2; ++i) s.corner[i] = At(X + 3 * skin_.corners(f)[i]);
    return s;
}

bool LineGaps::search(const double* from, const double* to) {
    const int begin = skin_.second_begin;
    const double margin = 2 * options_.reach + options_.radius;
    return near_facets_.find(skin_, begin, n_, from, to, margin, [&](int A, std::vector<int>& found) {
        std::erase_if(found, [&](int f) { return is_beside(A, f - begin); });
        const auto& old = candidates_[A];
        if (std::equal(old.begin(), old.end(), found.begin(), found.end(),
                       [](const Candidate& c, int f) { return c.facet == f; }))
            return false;
        make_stencil(A, found);
        return true;
    });
}

void LineGaps::make_stencil(int A, const std::vector<int>& facets) {
    auto& stencil = stencils_[A];
    stencil.assign(1, A), candidates_[A].clear();
    for (int f : facets) {
        Candidate c{f, {}};
        for (int i = 0; i < 2; ++i) {
            const int v = skin_.corners(f)[i];
            const auto at = std::find(stencil.begin(), stencil.end(), v);
            c.local[i] = static_cast<int>(at - stencil.begin());
            if (at == stencil.end()) stencil.push_back(v);
        }
        candidates_[A].push_back(c);
    }
    if (facets.empty()) stencil.clear();
}

double LineGaps::way(const double* from, const double* to, int A) const {
    const Vector3 own = At(to + 3 * A) - At(from + 3 * A);
    double farthest = 0;
    for (const Candidate& c : candidates_[A])
        for (int i = 0; i < 2; ++i) {
            const int v = skin_.corners(c.facet)[i];
            farthest = std::max(farthest, (At(to + 3 * v) - At(from + 3 * v) - own).norm());
        }
    return farthest;
}

// What has passed the middle of a bar is pushed out on its other side.
void LineGaps::approaches(const double* from, const double* to, std::vector<Approach>& out) const {
    out.assign(n_, {});
    for (int A = 0; A < n_; ++A) {
        Distance d;
        if (distance(from, A, 0, d) == Reach::near || distance(to, A, 0, d) == Reach::near)
            out[A] = {options_.radius, way(from, to, A)};
    }
}

PointGaps::Reach LineGaps::distance(const double* X, int A, int derivatives, Distance& out) const {
    const At x(X + 3 * A);
    const Candidate* nearest = nullptr;
    Foot foot;
    double least = options_.reach + options_.radius;
    for (const Candidate& c : candidates_[A]) {
        const Foot other = on_edge(shape(X, c.facet), 0, 0, 1, x);
        if (other.distance < least) least = other.distance, foot = other, nearest = &c;
    }
    const int size = 3 * static_cast<int>(stencils_[A].size());
    if (derivatives > 0) out.gradient.setZero(size);
    if (derivatives > 1) out.hessian.setZero(size, size);
    if (!nearest) return Reach::far;
    out.value = foot.distance;
    if (derivatives == 0) return Reach::near;
    const FacetShape bar = shape(X, nearest->facet);
    Vector3 normal = x;
    for (int i = 0; i < foot.n; ++i) normal -= foot.coordinate[i] * bar.corner[foot.vertex[i]];
    normal /= foot.distance;
    Eigen::VectorXd g;
    Eigen::MatrixXd H;
    differentiate(bar, foot, normal, foot.distance, g, derivatives > 1 ? &H : nullptr);
    auto place = [&](int c) { return c == 0 ? 0 : 3 * nearest->local[c - 1]; };
    for (int c = 0; c < 3; ++c) out.gradient.segment<3>(place(c)) += g.segment<3>(3 * c);
    for (int c = 0; c < 3 && derivatives > 1; ++c)
        for (int d = 0; d < 3; ++d)
            out.hessian.block<3, 3>(place(c), place(d)) += H.block<3, 3>(3 * c, 3 * d);
    return Reach::near;
}

}  // namespace

std::unique_ptr<Gaps> make_line_gaps(Skin skin, PointOptions options, OwnSegments beside) {
    return std::make_unique<LineGaps>(std::move(skin), std::move(options), std::move(beside));
}

}  // namespace visviva
