// The kernels of the physics of heated_list.hpp. Compiled once per instruction set.
#include "visviva/point/heat_stores.hpp"
#include "visviva/point/heated_branch.hpp"
#include "visviva/point/heated_fracture.hpp"
#include "visviva/point/point_kernel.hpp"
#include "visviva/point/thermoelastic_sheet.hpp"
#include "visviva/point/thermoelastic_volumes.hpp"

namespace visviva::VISVIVA_ISA {

template <class Map, class Energy, class Pairing>
constexpr PointKernels table = PointKernel<Physics<Map, Energy, Pairing>>::table;

extern const PointKernels heated_tables[n_heated_physics];
const PointKernels heated_tables[n_heated_physics] = {
#define VISVIVA_PHYSICS(physics, python, ...) table<__VA_ARGS__>,
#include "visviva/point/heated_list.hpp"
#undef VISVIVA_PHYSICS
};

}  // namespace visviva::VISVIVA_ISA
