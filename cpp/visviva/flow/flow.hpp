// Plain data of a batch of equal fluid elements for the kernels. Elements come in blocks of eight, one per
// lane; arrays are [block][...][8].
#pragma once
#include <cstdint>

#include "visviva/term/step.hpp"

namespace visviva {

struct FlowView {
    int n = 0, n_blocks = 0;
    int dim = 2, n_nodes = 0, n_pressures = 0, n_points = 0;
    double rho = 1, mu = 1;
    double convection = 1;          // 0: Stokes flow, which carries nothing along
    const int* index = nullptr;     // [node, then pressure] first unknown
    const double* N = nullptr;      // [point][node] the same for all elements, as M
    const double* M = nullptr;      // [point][pressure]
    const double* G = nullptr;      // [point][node][dim] gradients of the velocities' shape functions
    const double* w = nullptr;      // [point] volume
    const double* X = nullptr;      // [node][dim] positions
    const double* force = nullptr;  // [point][dim] per volume, or null
    // Of elements of equal order, that are stabilised: the metric of the reference element, packed upper
    // triangle, and its square, [point][dim (dim + 1) / 2 + 1]
    const double* metric = nullptr;
    // Of these, directions [dim] along which their residual is left out, or null
    const double* blind = nullptr;
    // See Slots
    const std::int64_t *row = nullptr, *length = nullptr;
    const std::uint16_t* offset = nullptr;
};

/// Per element: kinetic energy, work of viscosity, stabilisation and body force, momenta (6).
inline constexpr int flow_ledger_rows = 10;

struct FlowKernels {
    void (*residual)(const FlowView&, const Step&, const Vectors&, int begin, int end, double* r);
    void (*tangent)(const FlowView&, const Step&, const Vectors&, int begin, int end, double* values);
    void (*ledger)(const FlowView&, const Step&, const Vectors&, int begin, int end, double* out);
};

/// Pairs of velocity and pressure nodes that have kernels.
#define VISVIVA_FLOW_PAIRS(X) \
    X(2, 4, 4) X(2, 3, 3) X(2, 9, 4) X(2, 6, 3) X(3, 8, 8) X(3, 4, 4) X(3, 27, 8) X(3, 10, 4)

/// The kernels for the machine that runs.
const FlowKernels& flow_kernels();

}  // namespace visviva
