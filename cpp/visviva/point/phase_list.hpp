// Physics of mixtures and order parameters, like those of physics_list.hpp, in a table of their own.
// clang-format off
VISVIVA_PHYSICS(mixture, MIXTURE, ConcentrationMap, MixtureEnergy<>, MixturePairing<0>)  // c, mu, their gradients
VISVIVA_PHYSICS(order_parameter, ORDER_PARAMETER, ScalarMap, MixtureEnergy<>, RelaxationPairing<false>)  // c, its gradient
VISVIVA_PHYSICS(conserved_order, CONSERVED_ORDER, LoadedScalarMap, MixtureEnergy<>, RelaxationPairing<true>)  // and a load
VISVIVA_PHYSICS(mixture_wall, MIXTURE_WALL, WallMap, WallEnergy, WallPairing)  // c, mu
VISVIVA_PHYSICS(order_wall, ORDER_WALL, OrderWallMap, WallEnergy)  // c
VISVIVA_PHYSICS(smooth_mixture, SMOOTH_MIXTURE, SmoothScalarMap, MixtureEnergy<>, SmoothPairing)  // c, gradient, Laplacian
VISVIVA_PHYSICS(mixture_solid, MIXTURE_SOLID, SolidMixtureMap, MixtureSolidEnergy, MixturePairing<6>)  // C, c, mu
VISVIVA_PHYSICS(mixture_in_plane, MIXTURE_IN_PLANE, PlaneMixtureMap, MixtureSolidEnergy, MixturePairing<6>)
// clang-format on
