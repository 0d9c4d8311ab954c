// The features of a shader's state, in PelFeature bits. Nothing else turns a feature on.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Taps of the disk that replaces the whole profile for materials with settings that sums over blocks do not
// support.
constexpr uint32_t diskTapsForBlocks = 64;

// The PelFeature bits of a state. Throws if a required input is missing or does not match.
uint32_t deriveFeatures(const ShaderState& state);
// The features that one material needs, as far as their other inputs exist.
uint32_t materialNeeds(const ShaderState& state, const ShaderMaterial& material);
// The features of the forms that a light's shadow map has.
uint32_t formFeatures(const PelLight& light);

// Whether a light's shadow image is made from its shadow map.
bool filtersShadow(const ShaderState& state, const ShaderLight& light);
// Whether some material takes a wide shadow from the map of the light; all others take sharp shadows.
bool filtersWide(const ShaderState& state, const ShaderLight& light);
// Whether a material's diffuse light comes from irradiance per pixel.
inline bool readsIrradiance(const ShaderMaterial& material) {
    return material.params.scattering != PEL_SCATTERING_PREINTEGRATED;
}
// Whether that irradiance has to be made, which needs sharp shadows.
bool makesIrradiance(const ShaderState& state);
// Whether light from behind thin sheets is made: where the host gives it, it is added later.
bool makesLightFromBehind(const ShaderState& state, uint32_t features);
// Whether PelAmbient gives no light; there may still be a cube map.
bool isBlack(const PelAmbient& ambient);

}  // namespace pel
