// All materials of the core, one line each: VISVIVA_MATERIAL(its energy in materials.hpp, its name in Python,
// traits of material.hpp). Included where something is made of every line, hence no guard.
// clang-format off
VISVIVA_MATERIAL(hooke, HOOKE, .bulk = 0)  // lambda, mu: quadratic in the strain
VISVIVA_MATERIAL(neo_hooke, NEO_HOOKE, .isotropic = true, .plain = true, .bulk = 1)  // mu, bulk, volumetric
VISVIVA_MATERIAL(mooney, MOONEY, .isotropic = true, .bulk = 3)  // a, b, d, bulk, volumetric
VISVIVA_MATERIAL(isochoric, ISOCHORIC, .isotropic = true, .bulk = 4)  // c1, c2, c3, c01, bulk, volumetric
VISVIVA_MATERIAL(gent, GENT, .isotropic = true, .bulk = 2)  // mu, limit, bulk, volumetric
VISVIVA_MATERIAL(holzapfel, HOLZAPFEL, .bulk = 4)  // mu, k1, k2, kappa, bulk, volumetric, two structure tensors
VISVIVA_MATERIAL(ogden, OGDEN, .bulk = 0)  // bulk, volumetric, isochoric (0 or 1), three times mu, alpha
VISVIVA_MATERIAL(blatz_ko, BLATZ_KO, .isotropic = true, .plain = true)  // mu, beta
VISVIVA_MATERIAL(hencky, HENCKY, .bulk = 0)  // bulk, volumetric, mu
VISVIVA_MATERIAL(user, USER)  // evaluated by a callback
// clang-format on
