// Checks of the materials' controls of scattering at commit.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Throws if a control cannot be honoured.
void checkScattering(const ShaderState& state);

}  // namespace pel
