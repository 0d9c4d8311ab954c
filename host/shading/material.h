// What a material leaves to defaults.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Fills in material.params from material.given and its tables: a diffusion radius of 0 is that of the curvature table, else of
// the shadow table, so that no table is stretched unasked; without tables skin's.
void resolveMaterial(ShaderMaterial& material);

}  // namespace pel
