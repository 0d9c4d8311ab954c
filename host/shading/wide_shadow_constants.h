// What the wide-shadow kernel knows of a light's shadow map.
#pragma once
#include "shading/shader_state.h"
#include "shared/shade_passes.h"

namespace pel {

// Of a light's map, or of the cascade-th of them. Throws when its matrix does not tell across from along.
PelWideShadow describeWideShadow(const ShaderLight& light, uint32_t index, uint32_t cascade = 0);

}  // namespace pel
