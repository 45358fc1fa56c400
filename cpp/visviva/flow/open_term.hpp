// Open faces of a fluid: tractions, and outflow that takes its kinetic energy along.
#pragma once
#include "visviva/flow/flow_term.hpp"
#include "visviva/term/term.hpp"

namespace visviva {

/// Points of faces with what the cells behind them have there; arrays [face][point][...], `index`
/// [face][node].
struct OpenData {
    int n, n_nodes, n_points, dim;
    double density, viscosity;  // viscosity 0: the traction is that of Cauchy's stress
    bool directional;           // whether what enters brings no kinetic energy
    const int* index;           // first unknown of the cell's nodes
    const double *N, *G;        // [node], [node][dim]
    const double* normal;       // [dim] outward, times the area of the point
};

// sigma n = t; directional, sigma n = t - rho/2 max(-v.n, 0) v: no kinetic energy enters with a backflow.
// With the skew-symmetric convection that takes rho/2 (v.n) v, or its outgoing part. With a viscosity, sigma
// n - mu (grad v)^T n instead: what leaves in parallel streams goes on undisturbed.
class OpenTerm : public Term {
  public:
    explicit OpenTerm(const OpenData& data);

    // Tractions, force per area [face][point][dim].
    void set_load(FlowLoad f) { load_ = std::move(f); }

    void couple(Pattern& pattern) const override;
    void connect(const Pattern& pattern) override;
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void ledger(const Context&, const double* v1, LedgerSums&) override;

    int load_account = -1, flow_account = -1;  // work of the tractions, and of what flows through

  private:
    struct Point;
    void update_load(double t);
    Point at(const Context&, int face, int point) const;
    template <class F>
    void each_point(F f) const;

    int n_, nodes_, points_, dim_;
    double rho_, mu_;
    bool directional_;
    std::vector<int> index_;
    std::vector<double> N_, G_, normal_, traction_;
    FlowLoad load_;
    double load_time_ = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::int64_t> start_, length_;  // [face][a][b]: place of the first entry of the block, or -1
};

}  // namespace visviva
