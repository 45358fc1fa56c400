#include "visviva/contact/cover.hpp"

#include <algorithm>

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

constexpr double flush = 1e-4;    // of the least size of a body: less is no step
constexpr double opposed = 0.5;   // least agreement of normals of faces that are flush, or opposite
constexpr double sunk = 0.03;     // part of that size by which bodies may lie in each other by a penalty
constexpr double as_deep = 0.99;  // part of a depth: bodies swing

}  // namespace

Cover::Cover(Skin whole) : skin_(std::move(whole)), parts_(skin_, 0, skin_.n_facets()) {
    for (const int unknown : skin_.unknown)
        for (int i = 0; i < skin_.dim; ++i) unknowns_.push_back(unknown + i);
    std::sort(unknowns_.begin(), unknowns_.end());
    unknowns_.erase(std::unique(unknowns_.begin(), unknowns_.end()), unknowns_.end());
}

// All contacts that the body may cover something of ask for it.
void Cover::begin(const double* q) {
    const bool stays = std::equal(unknowns_.begin(), unknowns_.end(), at_.begin(), at_.end(),
                                  [&](int unknown, double at) { return q[unknown] == at; });
    if (stays && !X_.empty()) return;
    at_.clear();
    for (const int unknown : unknowns_) at_.push_back(q[unknown]);
    skin_.positions(q, X_);
    if (skin_.dim == 2) Triangulated::stand_walls(X_);
    body_.reset(), bounds_.setEmpty();
    for (std::size_t i = 0; i < X_.size(); i += 3) bounds_.extend(Vector3(At(&X_[i])));
    aside_ = flush * bounds_.sizes().minCoeff();
}

const Enclosure& Cover::body() const {
    const std::lock_guard lock(building_);
    if (!body_) body_.emplace(X_, parts_.triangles);
    return *body_;
}

bool Cover::holds(const Vector3& x) const { return bounds_.contains(x) && body().holds(x); }

bool Cover::is_at(const Vector3& place, const Vector3& way) const { return holds(place + aside_ * way); }

// By a side of this one next to the edge beyond which it is there.
bool Cover::is_left(const Cover& by, const Vector3& edge, const Vector3& face, const Vector3& wall) const {
    const auto& all = body().triangles();
    const double d = aside_;
    return std::any_of(all.begin(), all.end(), [&](const Triangle& t) {
        const Vector3 n = t.normal();
        if (n.dot(wall) < -opposed || n.dot(face) > opposed) return false;
        const double near = t.distance(edge);
        return near < sunk / flush * d && by.holds(edge + (near + 2 * d) * n - d * (face + wall));
    });
}

// Asked for in front of the wall: what has passed that came from there.
bool Cover::carries(const Seam& seam) const {
    const double deep = -as_deep * seam.height - aside_;
    if (deep <= 0) return true;
    const Vector3 x = seam.comer + ((seam.edge - seam.comer).dot(seam.wall) + aside_) * seam.wall;
    if (!holds(x)) return false;
    const auto& all = body().triangles();
    return std::none_of(all.begin(), all.end(), [&](const Triangle& t) {
        return t.normal().dot(seam.wall) > -opposed && t.distance(x) < deep;
    });
}

void Covers::begin(const double* q) {
    for (const auto& side : all_)
        for (const auto& cover : side) cover->begin(q);
    for (const auto& own : own_)
        if (own) own->begin(q);
}

// What lies in a body by a penalty, or is sunk in it, has it on both sides, and so has the foot of a wall, or
// leaves it next to there.
const Cover* Covers::going_on(int side, const Vector3& edge, const Vector3& face, const Vector3& wall) const {
    const Vector3 on = (wall - wall.dot(face) * face).normalized();
    const auto& all = all_[side];
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& c) { return c->is_at(edge, on - face); });
    const bool ends = found != all.end() && std::none_of(all.begin(), all.end(), [&](const auto& c) {
                          return c->is_at(edge, on + face);
                      });
    return ends && !(*found)->is_left(*own_[side], edge, face, wall) ? found->get() : nullptr;
}

bool Covers::leads_over(int side, const Seam& seam) const {
    const Cover* cover = going_on(side, seam.edge, seam.face, seam.wall);
    return cover && cover->carries(seam);
}

}  // namespace visviva
