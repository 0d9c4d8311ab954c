// The shadow maps of a shader's lights as surfaces that light falls on (kernels/shared/light_space.h).
#pragma once
#include "shading/shader_state.h"
#include "shared/light_space.h"

namespace pel {

struct LightMap {
    PelLightMap constants;  // all but where its levels and bytes lie
    ImageView image;
};

// Maps of all lights that shine: cascades from the finest on, faces of cubes one by one. At most
// PEL_LIGHT_MAPS; a light whose maps do not all fit is left out. `origin`: of the kernels' positions.
//
// In parallel maps, `step` x `step` texels are merged, together no wider than `coarsest`, a length; 0: texels
// are not merged.
std::vector<LightMap> lightMaps(const std::vector<ShaderLight>& lights, const float origin[3],
                                double coarsest = 0);

}  // namespace pel
