// The kernels of all physics of physics_list.hpp. Compiled once per instruction set.
#include "visviva/point/branch.hpp"
#include "visviva/point/director_maps.hpp"
#include "visviva/point/energies.hpp"
#include "visviva/point/fracture.hpp"
#include "visviva/point/layer.hpp"
#include "visviva/point/point_kernel.hpp"
#include "visviva/point/thermoelastic.hpp"

namespace visviva::VISVIVA_ISA {

template <class Map, class Energy, class Pairing = GradientPairing>
constexpr PointKernels table = PointKernel<Physics<Map, Energy, Pairing>>::table;

extern const PointKernels point_tables[n_physics];
const PointKernels point_tables[n_physics] = {
#define VISVIVA_PHYSICS(physics, python, ...) table<__VA_ARGS__>,
#include "visviva/point/physics_list.hpp"
#undef VISVIVA_PHYSICS
};

}  // namespace visviva::VISVIVA_ISA
