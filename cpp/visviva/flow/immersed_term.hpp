// Points of a body that move with the velocities of a fluid around them, paper (34): h dq/dt = h I (v_theta +
// damping (v1 - v0)) with the scheme's rate dq/dt, (q1 - q0) / h of the midpoint rule. A node of a solid is
// an unknown itself, a point of a rigid body a sum of its origin and directors. The multipliers are the
// forces that the fluid passes on to the solid.
#pragma once
#include <functional>

#include "visviva/term/entry_term.hpp"

namespace visviva {

/// Where places [n][dim] are in the fluid: for each the first unknowns of so many velocities, and their
/// weights, all of them zero for points that the fluid has let go of. `starts` are those of the step.
using Interpolation =
    std::function<void(const double* starts, const double* places, int* unknown, double* weight)>;

/// A point that may not end a step where it would, and why; -1: none.
struct Lost {
    int point = -1;
    std::string why;
};
using Admission = std::function<Lost(const double* starts, const double* ends)>;

/// First unknowns of all velocities that places [n][dim] may come to follow while they go on by `moves` per
/// step: for each, without order.
using Coupling = std::function<std::vector<std::vector<int>>(const double* places, const double* moves)>;

/// Told where points [n][dim] follow the fluid in a step.
using Reach = std::function<void(const double* places)>;

/// Points: each is a sum of `terms` vectors, with their first unknowns and weights [point][terms], has a
/// multiplier and follows `width` velocities.
struct ImmersedPoints {
    int dim, terms, width;
    double damping;
    bool leaves;  // whether the fluid may let go of them
    std::vector<int> vector;
    std::vector<double> weight;
    std::vector<int> multiplier;
    std::vector<char> held;  // [point][dim]: what is fixed or moves as prescribed
    int n() const { return static_cast<int>(multiplier.size()); }
    double value(const double* x, int point, int i) const {
        double sum = 0;
        for (int t = point * terms; t < (point + 1) * terms; ++t) sum += weight[t] * x[vector[t] + i];
        return sum;
    }
};

class ImmersedTerm : public EntryTerm, public NeighbourSearch, public TermMemory {
  public:
    ImmersedTerm(ImmersedPoints points, Interpolation interpolate, Admission admit, Coupling couple,
                 Reach reach);

    TermCapabilities capabilities() override { return {nullptr, this, this}; }
    bool find_neighbours(const Way&) override;
    bool is_outdated() const override;
    Refusal refuse(const Context&) override;
    void write_memory(std::vector<double>& memory) const override;
    bool read_memory(const double*& memory) override;
    std::any evaluation() const override { return now_; }
    void restore_evaluation(const std::any&) override;
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;
    // Mask of the points that the fluid holds in the step evaluated last; none before it was asked.
    std::vector<char> within() const;
    int n() const { return points_.n(); }
    // First unknowns of velocities that a point may come to follow; whether the fluid holds it now, and
    // f(first unknown, weight) of those that it follows.
    const std::vector<int>& coupled(int point) const {
        static const std::vector<int> none;
        return coupled_.empty() ? none : coupled_[point];
    }
    bool holds(int point) const { return !coupled_.empty() && !is_free(point * points_.width); }
    template <class F>
    void each_weight(int point, F f) const {
        for (int e = point * points_.width; e < (point + 1) * points_.width; ++e)
            if (now_.weight[e] != 0) f(now_.unknown[e], now_.weight[e]);
    }
    double location() const { return location_; }  // CPU seconds that it has taken

  private:
    // [point][width] first unknowns of velocities, and their weights, at places [point][dim], of a step that
    // starts at others
    struct Weights {
        std::vector<int> unknown;
        std::vector<double> weight, places, start;
    };
    void list_entries(std::vector<std::pair<int, int>>& entries) const override;
    void set_positions(const std::vector<std::int64_t>& positions) override;
    /// f(point, component, multiplier, first velocity)
    template <class F>
    void each(F f) const;
    template <class F>
    void each_coupled(F f) const;
    bool is_coupled(int point, int unknown) const;
    bool is_coupled() const;
    void follow(const Weights&);
    void find_coupled(const Way&);
    Refusal refused(const Lost&) const;
    bool is_free(const std::vector<double>& weight, int first) const;
    bool is_free(int first) const { return is_free(now_.weight, first); }
    double velocity(const double* v, int first, int i) const;
    double carrying(const Context&, int first, int i) const;
    double moved(const Context&, int point, int i) const;
    double share(const Step& step) const { return step.theta + points_.damping; }

    ImmersedPoints points_;
    Interpolation interpolate_;
    Admission admit_;
    Coupling couple_;
    Reach reach_;  // or none
    Weights now_, at_tangent_;
    std::vector<std::vector<int>> coupled_;  // per point: all velocities in the pattern, sorted
    double location_ = 0;
    std::vector<std::int64_t> position_;
};

}  // namespace visviva
