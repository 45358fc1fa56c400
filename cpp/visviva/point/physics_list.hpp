// All physics at points, one line each: VISVIVA_PHYSICS(its name, its name in Python, strain map, energy, and
// pairing if that is not the energy's gradient). Included where something is made of every line, hence no
// guard.
// clang-format off
VISVIVA_PHYSICS(viscoelastic, VISCOELASTIC, SolidMap, ViscoelasticEnergy)  // C, with internal variables
VISVIVA_PHYSICS(damage, DAMAGE, SolidScalarMap, DamageEnergy, IrreversiblePairing)  // C, damage and its gradient
VISVIVA_PHYSICS(cahn_hilliard, CAHN_HILLIARD, ConcentrationMap, SeparationEnergy, DiffusionPairing)  // c, mu, their gradients
VISVIVA_PHYSICS(beam, BEAM, BeamMap, SectionEnergy<6>)  // of directors: Gamma, K
VISVIVA_PHYSICS(shell, SHELL, ShellMap, SectionEnergy<8>)  // four nodes with directors: membrane, bending, shear
VISVIVA_PHYSICS(layer, LAYER, LayerMap, LayerEnergy)  // of a shell whose directors stretch: C
VISVIVA_PHYSICS(pressed_layer, PRESSED_LAYER, PressedLayerMap, PressedLayerEnergy)  // and its pressure
VISVIVA_PHYSICS(damped_beam, DAMPED_BEAM, BeamMap, SectionEnergy<6, 21>, ViscousPairing<6>)  // Gamma, K, their rates
VISVIVA_PHYSICS(conduction, CONDUCTION, ScalarMap, CapacityEnergy, ConductionPairing)  // temperature, its gradient
VISVIVA_PHYSICS(latent_conduction, LATENT_CONDUCTION, ScalarMap, HeatContentEnergy, HeatContentPairing)  // with a capacity that depends on it
VISVIVA_PHYSICS(branch, BRANCH, SolidMap, BranchEnergy)  // C, with the viscous strain of a Maxwell branch
VISVIVA_PHYSICS(branch_in_plane, BRANCH_IN_PLANE, PlaneMap, BranchEnergy)
VISVIVA_PHYSICS(branch_of_revolution, BRANCH_OF_REVOLUTION, RevolutionMap, BranchEnergy)
VISVIVA_PHYSICS(fracture, FRACTURE, SolidScalarMap, FractureEnergy<false>)  // C, damage and its gradient
VISVIVA_PHYSICS(fracture_in_plane, FRACTURE_IN_PLANE, PlaneScalarMap, FractureEnergy<false>)
VISVIVA_PHYSICS(fracture_of_revolution, FRACTURE_OF_REVOLUTION, RevolutionScalarMap, FractureEnergy<false>)
VISVIVA_PHYSICS(heated_fracture, HEATED_FRACTURE, StretchedMap<SolidScalarMap>, FractureEnergy<true>)  // and a free strain
VISVIVA_PHYSICS(heated_fracture_in_plane, HEATED_FRACTURE_IN_PLANE, StretchedMap<PlaneScalarMap>, FractureEnergy<true>)
VISVIVA_PHYSICS(heated_fracture_of_revolution, HEATED_FRACTURE_OF_REVOLUTION, StretchedMap<RevolutionScalarMap>, FractureEnergy<true>)
VISVIVA_PHYSICS(history_fracture, HISTORY_FRACTURE, SolidScalarMap, HistoryEnergy<false>)  // C, damage, by a history field
VISVIVA_PHYSICS(history_fracture_in_plane, HISTORY_FRACTURE_IN_PLANE, PlaneScalarMap, HistoryEnergy<false>)
VISVIVA_PHYSICS(history_fracture_of_revolution, HISTORY_FRACTURE_OF_REVOLUTION, RevolutionScalarMap, HistoryEnergy<false>)
// clang-format on
