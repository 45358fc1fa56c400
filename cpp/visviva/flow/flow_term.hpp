// A batch of equal elements of an incompressible Newtonian fluid: inertia, convection, viscosity and pressure
// in one pass.
#pragma once
#include <functional>
#include <limits>

#include "visviva/flow/end_values.hpp"
#include "visviva/flow/flow.hpp"
#include "visviva/term/slots.hpp"
#include "visviva/term/term.hpp"

namespace visviva {

// Values [element][point][dim] at a time, given from outside.
using FlowLoad = std::function<void(double t, double* values)>;

/// Data of a batch; arrays as given by Python, [element][...] except N and M.
struct FlowData {
    int n, n_nodes, n_pressures, n_points, dim;
    double density, viscosity;
    bool convects;                                 // otherwise Stokes flow
    const int* index;                              // [element][node, then pressure] first unknown
    const double *N, *M;                           // [point][node], [point][pressure]
    const double *gradients, *volume, *positions;  // [point][node][dim], [point], [node][dim]
    const double* metric;                          // [point][dim (dim + 1) / 2 + 1], or null
    std::vector<int> pressures;  // unknown ones whose end values it finds: other processes may have elements
};

class FlowTerm : public Term, public MeshAssembly, public TermMemory {
  public:
    explicit FlowTerm(const FlowData& data);

    // Stabilised elements: factors [element] of the metric, from 1; the greater, the less an element is
    // stabilised.
    void scale_metric(const double* factor);

    // Stabilised elements: directions [element][dim] along which their residual is left out, unit vectors or
    // zero.
    void blind(const double* directions);

    // Body force per volume; evaluated once per time.
    void set_force(FlowLoad f) { load_ = std::move(f); }

    TermCapabilities capabilities() override { return {this, nullptr, this}; }
    void couple(Pattern& pattern) const override { slots_.couple(pattern); }
    void connect(const Pattern& pattern) override;
    void clear_rows(const Pattern& pattern, std::vector<char>& cleared) override {
        slots_.clear_rows(pattern, cleared);
    }
    void residual(const Context&, double* r) override;
    void tangent(const Context&, double* values) override;
    void linearise(const Context& c, double* r, double* values) override {
        residual(c, r), tangent(c, values);
    }
    void ledger(const Context&, const double* v1, LedgerSums&) override;
    void finish_step(const Step& step, double* x) override { pressures_.settle(step, x); }
    void write_memory(std::vector<double>& memory) const override { pressures_.write(memory); }
    bool read_memory(const double*& memory) override { return pressures_.read(memory), false; }

    int kinetic_account = -1, owner = 0;
    // Works of viscosity, stabilisation and body force; what steady solutions gain in kinetic energy.
    int work_account[4] = {-1, -1, -1, -1};

  private:
    void update_force(double t);
    void rows(const Context&, double* total);

    FlowView view_;
    Slots slots_;
    EndValues pressures_;
    FlowLoad load_;
    double force_time_ = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> N_, M_, given_;
    Aligned<double> G_, w_, X_, metric_, given_metric_, blind_, force_, out_;
};

}  // namespace visviva
