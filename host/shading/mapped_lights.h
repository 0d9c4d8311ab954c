// Which lights have shadow maps that light may be summed over (docs/mathematics.md, section 10, "Light
// space").
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Whether a light has a shadow map and a colour.
bool shines(const ShaderLight& light);
// How many maps that is: cascades and faces of cubes one by one.
uint32_t mapsOf(const ShaderLight& light);
// Whether maps hold all light: every light that has a colour has one, there are some and not too many, and
// there is no ambient light.
bool lightIsMapped(const ShaderState& state);

}  // namespace pel
