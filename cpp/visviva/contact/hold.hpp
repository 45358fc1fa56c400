// What a gap of two rigid bodies holds by a penalty, in numbers that another gap can go on with.
#pragma once
#include <Eigen/Dense>
#include <cmath>

namespace visviva {

struct Hold {
    int gap = -1;
    Eigen::Vector3d place, push;  // on the first body, and the unit vector along the force on it
    double way = 0;               // how far the bodies have moved past each other there in the step
    double energy = 0;

    /// How far off another gap is that pushes the same way; infinite if it pushes elsewhere.
    double distance(const Hold& other) const {
        constexpr double same = 0.9;  // cosine of the angle between both pushes
        return push.dot(other.push) > same ? (place - other.place).norm() : HUGE_VAL;
    }
};

}  // namespace visviva
