// The controls of scattering that materials have, as a whole at commit.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Throws where a control cannot be kept to.
void checkScattering(const ShaderState& state);

}  // namespace pel
