#include "visviva/contact/cover.hpp"

#include <algorithm>

namespace visviva {

namespace {

using At = Eigen::Map<const Eigen::Vector3d>;

constexpr double aside = 1e-4;  // of the least size of a body: less is no step

}  // namespace

Cover::Cover(Skin whole) : skin_(std::move(whole)), parts_(skin_, 0, skin_.n_facets()) {}

void Cover::begin(const double* q) {
    std::vector<double> X;
    skin_.positions(q, X);
    if (X == X_) return;
    X_ = std::move(X), body_.reset(), bounds_.setEmpty();
    for (std::size_t i = 0; i < X_.size(); i += 3) bounds_.extend(Eigen::Vector3d(At(&X_[i])));
}

bool Cover::is_beside(const Eigen::Vector3d& place, const Eigen::Vector3d& way) const {
    const Eigen::Vector3d x = place + aside * bounds_.sizes().minCoeff() * way;
    if (!bounds_.contains(x)) return false;
    {
        const std::lock_guard lock(building_);
        if (!body_) body_.emplace(X_, parts_.triangles);
    }
    return body_->holds(x);
}

void Covers::begin(const double* q) {
    for (const auto& side : all_)
        for (const auto& cover : side) cover->begin(q);
}

bool Covers::is_beside(int side, const Eigen::Vector3d& place, const Eigen::Vector3d& way) const {
    return std::any_of(all_[side].begin(), all_[side].end(),
                       [&](const auto& cover) { return cover->is_beside(place, way); });
}

}  // namespace visviva
