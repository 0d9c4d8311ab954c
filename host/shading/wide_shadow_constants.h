// The constants of a light's shadow map for the wide-shadow kernel.
#pragma once
#include "shading/shader_state.h"
#include "shared/shade_passes.h"

namespace pel {

// For a light's map, or for its cascade-th one. Throws if its matrix does not distinguish across from along.
PelWideShadow describeWideShadow(const ShaderLight& light, uint32_t index, uint32_t cascade = 0);

}  // namespace pel
