// The kernels of fluids, compiled once per instruction set like core/kernels.cpp.
#include "visviva/flow/flow_tangent.hpp"

namespace visviva::VISVIVA_ISA {

namespace {

// Calls work(element) for W elements at a time, fillers of the last block included.
template <class F>
void each_element(const FlowView& f, const Step& step, const Vectors& x, int begin, int end, F&& work) {
#define VISVIVA_EACH(D, N, P)                                                                             \
    if (f.dim == D && f.n_nodes == N && f.n_pressures == P) {                                             \
        for (int block = begin; block < end; ++block)                                                     \
            for (int lane = 0; lane < L8; lane += W) work(FlowElement<D, N, P>(f, step, x, block, lane)); \
        return;                                                                                           \
    }
    VISVIVA_FLOW_PAIRS(VISVIVA_EACH)
#undef VISVIVA_EACH
}

template <int D, int N, int P>
void scatter_forces(const FlowElement<D, N, P>& e, const V* r, double* to) {
    const int n = e.active();
    for (int s = 0; s < N + P; ++s) {
        const int* index = e.index(s);
        const V* from = r + (s < N ? s * D : N * D + s - N);
        for (int c = 0; c < (s < N ? D : 1); ++c)
            for (int l = 0; l < n; ++l) to[index[l] + c] += from[c][l];
    }
}

// Adds `rows` x `columns` entries of the slots a and b of W elements.
template <int rows, int columns, int size, int slots>
VISVIVA_INLINE void scatter_block(const FlowView& f, int block, int lane, int a, int b, const V* K,
                                  double* values) {
    const std::int64_t slot = static_cast<std::int64_t>(block) * slots + a;
    const std::int64_t* start = f.row + slot * L8 + lane;
    const std::int64_t* length = f.length + slot * L8 + lane;
    const std::uint16_t* offset = f.offset + (slot * slots + b) * L8 + lane;
    for (int l = 0; l < W; ++l) {
        if (offset[l] == 0xffff) continue;
        double* to = values + start[l] + offset[l];
        for (int i = 0; i < rows; ++i)
            for (int j = 0; j < columns; ++j) to[i * length[l] + j] += K[i * size + j][l];
    }
}

template <int D, int N, int P>
void scatter(const FlowElement<D, N, P>& e, const V* K, double* values) {
    constexpr int n = N * D + P, slots = N + P;
    for (int a = 0; a < slots; ++a)
        for (int b = 0; b < slots; ++b) {
            const V* from = K + (a < N ? a * D : N * D + a - N) * n + (b < N ? b * D : N * D + b - N);
            if (a < N && b < N)
                scatter_block<D, D, n, slots>(e.f, e.block, e.lane, a, b, from, values);
            else if (a < N)
                scatter_block<D, 1, n, slots>(e.f, e.block, e.lane, a, b, from, values);
            else if (b < N)
                scatter_block<1, D, n, slots>(e.f, e.block, e.lane, a, b, from, values);
            else if (N == P)
                scatter_block<1, 1, n, slots>(e.f, e.block, e.lane, a, b, from, values);
        }
}

void flow_residual(const FlowView& f, const Step& step, const Vectors& x, int begin, int end, double* r) {
    each_element(f, step, x, begin, end, [r]<int D, int N, int P>(const FlowElement<D, N, P>& e) {
        V forces[N * D + P];
        e.forces(forces);
        scatter_forces(e, forces, r);
    });
}

void flow_tangent(const FlowView& f, const Step& step, const Vectors& x, int begin, int end, double* values) {
    each_element(f, step, x, begin, end, [values]<int D, int N, int P>(const FlowElement<D, N, P>& e) {
        const FlowTangent<D, N, P> tangent(e);
        scatter(e, tangent.K, values);
    });
}

// Work of viscosity, stabilisation and body force, per time; momenta and kinetic energy of the end.
template <int D, int N, int P>
void ledger_rows(const FlowElement<D, N, P>& e, V* row) {
    const FlowView& f = e.f;
    for (int k = 0; k < flow_ledger_rows; ++k) row[k] = V{};
    for (int q = 0; q < f.n_points; ++q) {
        V G[N][D], v1[3] = {}, x[3] = {};
        FlowPoint<D, N> at;
        e.load(q, G);
        e.evaluate(q, G, at);
        const V w = e.volume(q), mass = f.rho * w;
        for (int a = 0; a < N; ++a)
            for (int i = 0; i < D; ++i) {
                v1[i] += e.N_at(q, a) * e.v1[a * D + i];
                x[i] += e.N_at(q, a) * vload(f.X + ((e.block * N + a) * D + i) * L8 + e.lane);
            }
        for (int i = 0; i < D; ++i) {
            row[0] += 0.5 * mass * v1[i] * v1[i];
            row[3] += w * e.force(q, i) * at.v[i];
            row[4 + i] += mass * v1[i];
            for (int j = 0; j < D; ++j)
                row[1] -= w * f.mu * (at.L[i * D + j] + at.L[j * D + i]) * at.L[i * D + j];
        }
        if constexpr (FlowElement<D, N, P>::stabilised) {
            row[2] += w * at.div * (at.p - f.rho * at.lsic * at.div);
            for (int i = 0; i < D; ++i) row[2] -= w * at.tau * at.conv[i] * at.R[i];
        }
        row[7] += mass * (x[1] * v1[2] - x[2] * v1[1]);
        row[8] += mass * (x[2] * v1[0] - x[0] * v1[2]);
        row[9] += mass * (x[0] * v1[1] - x[1] * v1[0]);
    }
}

// Rows of `out` [flow_ledger_rows][stride].
void flow_ledger(const FlowView& f, const Step& step, const Vectors& x, int begin, int end, double* out) {
    const std::int64_t stride = static_cast<std::int64_t>(f.n_blocks) * L8;
    each_element(f, step, x, begin, end, [=]<int D, int N, int P>(const FlowElement<D, N, P>& e) {
        V row[flow_ledger_rows];
        ledger_rows(e, row);
        for (int k = 0; k < flow_ledger_rows; ++k) vstore(out + k * stride + e.block * L8 + e.lane, row[k]);
    });
}

}  // namespace

extern const FlowKernels flow_table;
const FlowKernels flow_table = {flow_residual, flow_tangent, flow_ledger};

}  // namespace visviva::VISVIVA_ISA
