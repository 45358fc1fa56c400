// What physics there are: which strain map goes with which energy and pairing. Compiled once per instruction
// set.
#include "visviva/point/branch.hpp"
#include "visviva/point/director_maps.hpp"
#include "visviva/point/energies.hpp"
#include "visviva/point/layer.hpp"
#include "visviva/point/point_kernel.hpp"
#include "visviva/point/thermoelastic.hpp"

namespace visviva::VISVIVA_ISA {

template <class Map, class Energy, class Pairing = GradientPairing>
constexpr PointKernels table = PointKernel<Physics<Map, Energy, Pairing>>::table;

extern const PointKernels point_tables[n_physics];
const PointKernels point_tables[n_physics] = {
    table<SolidMap, ViscoelasticEnergy>,
    table<SolidEntropyMap, ThermoelasticEnergy, HeatPairing>,
    table<SolidScalarMap, DamageEnergy, IrreversiblePairing>,
    table<ConcentrationMap, SeparationEnergy, DiffusionPairing>,
    table<BeamMap, SectionEnergy<6>>,
    table<ShellMap, SectionEnergy<8>>,
    table<LayerMap, LayerEnergy>,
    table<PressedLayerMap, PressedLayerEnergy>,
    table<BeamMap, SectionEnergy<6, 21>, ViscousPairing<6>>,
    table<ScalarMap, CapacityEnergy, ConductionPairing>,
    table<SolidMap, BranchEnergy>,
    table<PlaneMap, BranchEnergy>,
    table<RevolutionMap, BranchEnergy>,
};

}  // namespace visviva::VISVIVA_ISA
