// How deep bodies that touch by penalties lie in what carries them. A corner that is no deeper below an edge
// of another body that is flush there has sagged with its own: it does not run into the wall of that.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <vector>

namespace visviva {

class Sags {
  public:
    void add(const Eigen::Vector3d& normal, double depth) { all_.push_back({normal.normalized(), depth}); }
    void add(const Sags& other) { all_.insert(all_.end(), other.all_.begin(), other.all_.end()); }
    /// How far below a plane with this normal what is carried may be: twice the deepest, as half of a body
    /// may hang over, and that twice, as it may swing. Faces lie on at least three points: corners and edges
    /// that run into each other sink in by what they do in an impact.
    double below(const Eigen::Vector3d& normal) const {
        constexpr double flush = 0.9999, hanging = 4;
        double most = 0;
        int points = 0;
        for (const Sag& sag : all_)
            if (std::abs(sag.normal.dot(normal)) > flush) ++points, most = std::max(most, sag.depth);
        return points < 3 ? 0 : hanging * most;
    }
    /// Whether what is at this height above such a plane swings through it: it may come down in the step.
    bool reach(double height, const Eigen::Vector3d& normal) const {
        return std::abs(height) < below(normal);
    }
    bool operator==(const Sags&) const = default;

  private:
    struct Sag {
        Eigen::Vector3d normal;
        double depth;
        bool operator==(const Sag&) const = default;
    };
    std::vector<Sag> all_;
};

}  // namespace visviva
