// Physics with entropy and temperature, as in physics_list.hpp; compiled in heated_kernels.cpp.
// clang-format off
VISVIVA_PHYSICS(heated_branch, HEATED_BRANCH, HeatedBranchMap, HeatedBranchEnergy, HeatingPairing)  // C, theta, s, with a branch
VISVIVA_PHYSICS(thermoelastic_fbar, THERMOELASTIC_FBAR, CentreEntropyMap, ThermoelasticEnergyOf<CentreVolume>, CentreHeatPairing)  // C, C0, s, theta
VISVIVA_PHYSICS(thermoelastic_mixed, THERMOELASTIC_MIXED, VolumePressureMap, VolumePressureEnergy, VolumePressurePairing)  // C, ln J, s, theta, p
VISVIVA_PHYSICS(heat_store, HEAT_STORE, StoreMap, StoreEnergy, StorePairing)  // entropy, temperature
VISVIVA_PHYSICS(heated_spring, HEATED_SPRING, SpringMap, SpringEnergy, SpringPairing)  // squared distance, s, theta
VISVIVA_PHYSICS(heated_beam, HEATED_BEAM, HeatedBeamMap, HeatedSectionEnergy, HeatedSectionPairing)  // Gamma, K, three s and theta
VISVIVA_PHYSICS(heated_layer, HEATED_LAYER, HeatedLayerMap, HeatedLayerEnergy, HeatedLayerPairing)  // of a shell: C, s, theta
VISVIVA_PHYSICS(conducting_fracture, CONDUCTING_FRACTURE, ConductingMap<SolidScalarMap>, HeatedFractureEnergy, HeatedFracturePairing)  // C, d, s, theta
VISVIVA_PHYSICS(conducting_fracture_in_plane, CONDUCTING_FRACTURE_IN_PLANE, ConductingMap<PlaneScalarMap>, HeatedFractureEnergy, HeatedFracturePairing)
VISVIVA_PHYSICS(conducting_fracture_of_revolution, CONDUCTING_FRACTURE_OF_REVOLUTION, ConductingMap<RevolutionScalarMap>, HeatedFractureEnergy, HeatedFracturePairing)
// clang-format on
