#include "visviva/contact/turned_ways.hpp"

#include <algorithm>
#include <cmath>

#include "visviva/contact/enclosure.hpp"

namespace visviva {

namespace {

using Vector3 = Eigen::Vector3d;
using At = Eigen::Map<const Vector3>;

}  // namespace

TurnedWays::TurnedWays(const std::vector<double>& X0, const std::vector<double>& X1, int n_vertices,
                       const std::array<std::vector<int>, 2>& vertices, double straight)
    : X0_(X0), X1_(X1), n_vertices_(n_vertices), vertices_(vertices) {
    double sagitta = 0, fork = 0;
    for (const int i : {0, 1}) {
        Side& side = sides_[i];
        side.motion = {X0.data(), X1.data(), vertices[i], std::vector<double>(vertices[i].size(), 1)};
        side.turn = Eigen::AngleAxisd(side.motion.turn), side.round = EvenWay(side.motion.turn);
        sagitta += side.sagitta(X0, vertices[i]) + side.fork(), fork += side.fork();
    }
    if (sagitta > straight) stages_ = static_cast<int>(std::ceil(std::sqrt(sagitta / straight)));
    forks_ = fork > straight;
}

// How far the farthest vertex is beside the chord of its arc about the middle.
double TurnedWays::Side::sagitta(const std::vector<double>& X0, const std::vector<int>& vertices) const {
    double farthest = 0;
    for (const int v : vertices)
        farthest = std::max(farthest, turn.axis().cross(At(&X0[3 * v]) - motion.from).norm());
    return farthest * (1 - std::cos(0.5 * turn.angle()));
}

// The same of the middle, which goes round an axis or straight.
double TurnedWays::Side::fork() const {
    return 0.5 * turn.axis().cross(motion.to - motion.from).norm() * std::tan(0.25 * turn.angle());
}

std::vector<double> TurnedWays::at(double share, Middle middle) const {
    if (stages_ > 1 && share > 0 && share < 1) {
        std::vector<double> X(X0_.begin(), X0_.begin() + 3 * n_vertices_);
        for (const int i : {0, 1}) sides_[i].place(share, middle, X0_, X1_, vertices_[i], X);
        if (X.size() < X0_.size()) Triangulated::stand_walls(X);
        return X;
    }
    std::vector<double> X(X0_.size());
    for (std::size_t i = 0; i < X.size(); ++i) X[i] = (1 - share) * X0_[i] + share * X1_[i];
    return X;
}

// What bends beside does so evenly, as seen by who turns along.
void TurnedWays::Side::place(double share, Middle middle, const std::vector<double>& X0,
                             const std::vector<double>& X1, const std::vector<int>& vertices,
                             std::vector<double>& X) const {
    const Vector3 gone = motion.to - motion.from;
    const Vector3 way = middle == Middle::round ? round.gone(round.rate(gone), share) : Vector3(share * gone);
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
    for (const int v : vertices) {
        const Vector3 from = At(&X0[3 * v]) - motion.from, to = motion.back(At(&X1[3 * v])) - motion.from;
        Eigen::Map<Vector3> x(&X[3 * v]);
        x = motion.from + way + turned * ((1 - share) * from + share * to);
    }
}

}  // namespace visviva
