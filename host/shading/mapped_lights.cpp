#include "shading/mapped_lights.h"

#include "shading/features.h"
#include "shared/light_space.h"

namespace pel {
namespace {

bool isBlack(const PelLight& light) {
    return light.color[0] == 0 && light.color[1] == 0 && light.color[2] == 0;
}

}  // namespace

bool shines(const ShaderLight& light) {
    return light.images[PEL_LIGHT_SHADOW_MAP] && !isBlack(light.params);
}

uint32_t mapsOf(const ShaderLight& light) {
    return isCube(light.params) ? 6 : cascadesOf(light);
}

bool lightIsMapped(const ShaderState& state) {
    uint32_t maps = 0;
    for (const ShaderLight& light : state.lights) {
        if (isBlack(light.params)) continue;
        if (!shines(light)) return false;
        maps += mapsOf(light);
    }
    return maps > 0 && maps <= PEL_LIGHT_MAPS && pel::isBlack(state.ambient) && !state.ambientCube;
}

}  // namespace pel
