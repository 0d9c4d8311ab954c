// What PEL_SCATTERING_AUTO comes to.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Puts a method in the place of auto in each material's params, and takes away the wide shadow images that
// sharp shadows from maps replace. `methods`: bit i: the build has the PelScattering i. Returns sentences,
// one a line, about what auto had to do without. `tooMany`: bytes that scattering on the screen takes, where
// they are more than PelShaderOptions.scratchBudget; else 0.
std::string chooseMethods(ShaderState& state, uint32_t methods, uint64_t tooMany);

}  // namespace pel
