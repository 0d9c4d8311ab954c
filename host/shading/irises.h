// What eyes need before they can be shaded.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Ambient light on each iris, and the table of each eye that brought none; eyes of one shape share them.
void prepareEyes(const Ref<Device>& device, std::map<uint32_t, ShaderMaterial>& materials);

}  // namespace pel
