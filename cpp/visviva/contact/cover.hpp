// Bodies that others lie flush with: what they cover of these cannot be touched from outside.
#pragma once
#include <Eigen/Dense>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "visviva/contact/enclosure.hpp"

namespace visviva {

/// The end of a face at a wall of a body, by both normals, and what comes there.
struct Seam {
    Eigen::Vector3d edge, face, wall;  // a place on it
    Eigen::Vector3d comer;             // a place of what comes to it
    double height;                     // of that, above the face
};

/// A body of a closed surface, where a step begins.
class Cover {
  public:
    explicit Cover(Skin whole);
    void begin(const double* q);
    /// Whether the body is there, a ten-thousandth of its least size aside from a place along a way whose
    /// length is about 1. Bodies may be asked by several threads.
    bool is_at(const Eigen::Vector3d& place, const Eigen::Vector3d& way) const;
    /// Whether what has an edge, between a face and a wall, lies in this body by little there, and leads out.
    bool is_left(const Cover& by, const Eigen::Vector3d& edge, const Eigen::Vector3d& face,
                 const Eigen::Vector3d& wall) const;
    /// Whether what comes to a seam is above the face, or lies in this body as deep as it is below that: by
    /// no other side of the body than one that is flush with the face.
    bool carries(const Seam&) const;

  private:
    bool holds(const Eigen::Vector3d& x) const;
    const Enclosure& body() const;
    Skin skin_;
    Triangulated parts_;
    std::vector<int> unknowns_;  // that it goes by, each once, and what they are
    std::vector<double> at_, X_;
    Eigen::AlignedBox3d bounds_;
    double aside_ = 0;
    mutable std::mutex building_;
    mutable std::optional<Enclosure> body_;
};

/// Those that cover the first body of a contact, and those that cover the second.
class Covers {
  public:
    /// One that covers a side, which is `own` itself.
    void add(int side, std::shared_ptr<Cover> own, std::shared_ptr<Cover> cover) {
        own_[side] = std::move(own), all_[side].push_back(std::move(cover));
    }
    void begin(const double* q);
    bool has(int side) const { return !all_[side].empty(); }
    bool has_any() const { return has(0) || has(1); }
    /// Whether an edge of a side, between a face and a wall, is none: another body goes on where the face
    /// ends, in front of the wall.
    bool goes_on(int side, const Eigen::Vector3d& edge, const Eigen::Vector3d& face,
                 const Eigen::Vector3d& wall) const {
        return going_on(side, edge, face, wall) != nullptr;
    }
    /// Whether what comes to a wall of a side comes over such a body, as over one face.
    bool leads_over(int side, const Seam&) const;

  private:
    const Cover* going_on(int side, const Eigen::Vector3d& edge, const Eigen::Vector3d& face,
                          const Eigen::Vector3d& wall) const;
    std::shared_ptr<Cover> own_[2];
    std::vector<std::shared_ptr<Cover>> all_[2];
};

}  // namespace visviva
