// Bodies that others lie flush with: what they cover of these cannot be touched from outside.
#pragma once
#include <Eigen/Dense>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "visviva/contact/enclosure.hpp"

namespace visviva {

/// A body of a closed surface, where a step begins.
class Cover {
  public:
    explicit Cover(Skin whole);
    void begin(const double* q);
    /// Whether the body is there, so little aside from a place along a way whose length is about 1 that what
    /// is flush to rounding is hit. Bodies may be asked by several threads.
    bool is_beside(const Eigen::Vector3d& place, const Eigen::Vector3d& way) const;

  private:
    Skin skin_;
    Triangulated parts_;
    std::vector<double> X_;
    Eigen::AlignedBox3d bounds_;
    mutable std::mutex building_;
    mutable std::optional<Enclosure> body_;
};

/// Those that cover the first body of a contact, and those that cover the second.
class Covers {
  public:
    void add(int side, std::shared_ptr<Cover> cover) { all_[side].push_back(std::move(cover)); }
    void begin(const double* q);
    bool has(int side) const { return !all_[side].empty(); }
    bool is_beside(int side, const Eigen::Vector3d& place, const Eigen::Vector3d& way) const;
    /// Whether an edge of a side, between faces with these normals, is none: another body goes on where one
    /// of them ends, in front of the other one.
    bool goes_on(int side, const Eigen::Vector3d& edge, const Eigen::Vector3d& face,
                 const Eigen::Vector3d& wall) const {
        return is_beside(side, edge, wall - face);
    }

  private:
    std::vector<std::shared_ptr<Cover>> all_[2];
};

}  // namespace visviva
