// The shadow maps of a shader's lights as surfaces that light falls on (kernels/shared/light_space.h).
#pragma once
#include "shading/shader_state.h"
#include "shared/light_space.h"

namespace pel {

struct LightMap {
    PelLightMap constants;  // all but where its levels and bytes lie
    ImageView image;
};

// Maps of all lights that shine: cascades from the finest on, faces of cubes one by one. No more than
// PEL_LIGHT_MAPS; a light of which one would be too many is left out. `origin`: of the kernels' positions.
//
// Of parallel maps, `step` by `step` texels are taken together that are no wider than `coarsest`, a length;
// 0: one by one.
std::vector<LightMap> lightMaps(const std::vector<ShaderLight>& lights, const float origin[3],
                                double coarsest = 0);

}  // namespace pel
