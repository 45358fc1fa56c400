// The materials, see material_list.hpp; their energies are in materials.hpp.
#pragma once

namespace visviva {

enum class MaterialKind : int {
#define VISVIVA_MATERIAL(energy, ...) energy,
#include "visviva/material/material_list.hpp"
#undef VISVIVA_MATERIAL
};

/// Of a material: its name in Python; whether its energy depends on the three invariants alone, and there is
/// a multiple of I1 and a function of J, so that its moduli in space are lambda(J) 1 x 1 + 2 mu(J) I; place
/// of the modulus of its volumetric energy among the parameters, the number of which follows there, or -1.
struct MaterialTraits {
    MaterialKind kind;
    const char* name;
    bool isotropic = false, plain = false;
    int bulk = -1;
};
inline constexpr MaterialTraits material_traits[] = {
#define VISVIVA_MATERIAL(energy, python, ...) \
    {.kind = MaterialKind::energy, .name = #python __VA_OPT__(, ) __VA_ARGS__},
#include "visviva/material/material_list.hpp"
#undef VISVIVA_MATERIAL
};
constexpr const MaterialTraits& traits(MaterialKind kind) { return material_traits[static_cast<int>(kind)]; }

inline constexpr int material_max_parameters = 18;

}  // namespace visviva
