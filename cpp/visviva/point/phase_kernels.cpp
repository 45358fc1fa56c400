// The kernels of all physics of phase_list.hpp. Compiled once per instruction set.
#include "visviva/point/maps.hpp"
#include "visviva/point/mixture.hpp"
#include "visviva/point/point_kernel.hpp"

namespace visviva::VISVIVA_ISA {

template <class Map, class Energy, class Pairing = GradientPairing>
constexpr PointKernels table = PointKernel<Physics<Map, Energy, Pairing>>::table;

extern const PointKernels phase_tables[n_phase_physics];
const PointKernels phase_tables[n_phase_physics] = {
#define VISVIVA_PHYSICS(physics, python, ...) table<__VA_ARGS__>,
#include "visviva/point/phase_list.hpp"
#undef VISVIVA_PHYSICS
};

}  // namespace visviva::VISVIVA_ISA
