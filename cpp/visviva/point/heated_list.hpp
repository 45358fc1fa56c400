// Physics with entropy and temperature, as in physics_list.hpp; compiled in heated_kernels.cpp.
// clang-format off
VISVIVA_PHYSICS(thermoelastic, THERMOELASTIC, EntropyMap<SolidMap>, ThermoelasticEnergy, HeatPairing)  // C, entropy, temperature
VISVIVA_PHYSICS(thermoelastic_in_plane, THERMOELASTIC_IN_PLANE, EntropyMap<PlaneMap>, ThermoelasticEnergy, HeatPairing)
VISVIVA_PHYSICS(thermoelastic_of_revolution, THERMOELASTIC_OF_REVOLUTION, EntropyMap<RevolutionMap>, ThermoelasticEnergy, HeatPairing)
VISVIVA_PHYSICS(thermoelastic_in_sheet, THERMOELASTIC_IN_SHEET, EntropyMap<PlaneMap>, SheetEnergy, SheetHeatPairing)  // in plane stress
VISVIVA_PHYSICS(heated_branch, HEATED_BRANCH, HeatedBranchMap<SolidMap>, HeatedBranchEnergy, HeatingPairing)  // C, theta, s, with a branch
VISVIVA_PHYSICS(heated_branch_in_plane, HEATED_BRANCH_IN_PLANE, HeatedBranchMap<PlaneMap>, HeatedBranchEnergy, HeatingPairing)
VISVIVA_PHYSICS(heated_branch_of_revolution, HEATED_BRANCH_OF_REVOLUTION, HeatedBranchMap<RevolutionMap>, HeatedBranchEnergy, HeatingPairing)
VISVIVA_PHYSICS(thermoelastic_fbar, THERMOELASTIC_FBAR, EntropyMap<CentreMap<SolidMap>>, ThermoelasticEnergyOf<CentreVolume<3>>, CentreHeatPairing)  // C, C0, s, theta
VISVIVA_PHYSICS(thermoelastic_fbar_in_plane, THERMOELASTIC_FBAR_IN_PLANE, EntropyMap<CentreMap<PlaneMap>>, ThermoelasticEnergyOf<CentreVolume<2>>, CentreHeatPairing)
VISVIVA_PHYSICS(thermoelastic_fbar_of_revolution, THERMOELASTIC_FBAR_OF_REVOLUTION, EntropyMap<CentreMap<RevolutionMap>>, ThermoelasticEnergyOf<CentreVolume<3>>, CentreHeatPairing)
VISVIVA_PHYSICS(thermoelastic_mixed, THERMOELASTIC_MIXED, VolumePressureMap<SolidMap>, VolumePressureEnergy, VolumePressurePairing)  // C, ln J, s, theta, p
VISVIVA_PHYSICS(thermoelastic_mixed_in_plane, THERMOELASTIC_MIXED_IN_PLANE, VolumePressureMap<PlaneMap>, VolumePressureEnergy, VolumePressurePairing)
VISVIVA_PHYSICS(thermoelastic_mixed_of_revolution, THERMOELASTIC_MIXED_OF_REVOLUTION, VolumePressureMap<RevolutionMap>, VolumePressureEnergy, VolumePressurePairing)
VISVIVA_PHYSICS(heat_store, HEAT_STORE, StoreMap, StoreEnergy, StorePairing)  // entropy, temperature
VISVIVA_PHYSICS(heated_spring, HEATED_SPRING, SpringMap, SpringEnergy, SpringPairing)  // squared distance, s, theta
VISVIVA_PHYSICS(heated_beam, HEATED_BEAM, HeatedBeamMap, HeatedSectionEnergy, HeatedSectionPairing)  // Gamma, K, three s and theta
VISVIVA_PHYSICS(heated_layer, HEATED_LAYER, HeatedLayerMap, HeatedLayerEnergy, HeatedLayerPairing)  // of a shell: C, s, theta
VISVIVA_PHYSICS(conducting_fracture, CONDUCTING_FRACTURE, EntropyMap<SolidScalarMap>, HeatedFractureEnergy, HeatedFracturePairing)  // C, d, s, theta
VISVIVA_PHYSICS(conducting_fracture_in_plane, CONDUCTING_FRACTURE_IN_PLANE, EntropyMap<PlaneScalarMap>, HeatedFractureEnergy, HeatedFracturePairing)
VISVIVA_PHYSICS(conducting_fracture_of_revolution, CONDUCTING_FRACTURE_OF_REVOLUTION, EntropyMap<RevolutionScalarMap>, HeatedFractureEnergy, HeatedFracturePairing)
// clang-format on
