// Which materials there are; their energies are in materials.hpp.
#pragma once

namespace visviva {

enum class MaterialKind : int {
    hooke = 0,      // lambda, mu: quadratic in the strain
    neo_hooke = 1,  // mu, bulk, volumetric: mu/2 (I1 - 3 - 2 ln J) + bulk U(J)
    mooney = 2,     // a, b, d, bulk, volumetric: a (I1 - 3) + b (I2 - 3) - d ln J + bulk U(J)
    isochoric = 3,  // c1, c2, c3, c01, bulk, volumetric: polynomial of the isochoric invariants + bulk U(J)
    gent = 4,       // mu, limit, bulk, volumetric
    holzapfel = 5,  // mu, k1, k2, kappa, bulk, volumetric, then the structure tensors of two fibres (6 each)
    ogden = 6,      // bulk, volumetric, isochoric (0 or 1), then mu, alpha of three terms
    blatz_ko = 7,   // mu, beta: mu/2 (I1 - 3) + mu/beta (J^-beta - 1)
    user = 8,       // evaluated by a callback
};

/// Of a material: its name in Python; whether its energy depends on the three invariants alone, and there is
/// a multiple of I1 and a function of J, so that its moduli in space are lambda(J) 1 x 1 + 2 mu(J) I.
struct MaterialTraits {
    MaterialKind kind;
    const char* name;
    bool isotropic = false, plain = false;
};
inline constexpr MaterialTraits material_traits[] = {
    {MaterialKind::hooke, "HOOKE"},         {MaterialKind::neo_hooke, "NEO_HOOKE", true, true},
    {MaterialKind::mooney, "MOONEY", true}, {MaterialKind::isochoric, "ISOCHORIC", true},
    {MaterialKind::gent, "GENT", true},     {MaterialKind::holzapfel, "HOLZAPFEL"},
    {MaterialKind::ogden, "OGDEN"},         {MaterialKind::blatz_ko, "BLATZ_KO", true, true},
    {MaterialKind::user, "USER"},
};
constexpr const MaterialTraits& traits(MaterialKind kind) { return material_traits[static_cast<int>(kind)]; }

inline constexpr int material_max_parameters = 18;

}  // namespace visviva
