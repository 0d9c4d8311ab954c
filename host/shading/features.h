// The features of a shader's state, in PelFeature bits. Nothing else turns a feature on.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Of the disk in place of the whole profile, where a material asks for what sums over blocks cannot do.
constexpr uint32_t diskTapsForBlocks = 64;

// PelFeature bits of what is bound and not zero. Throws if something needed is missing or does not match.
uint32_t deriveFeatures(const ShaderState& state);
// The features that a material asks for by itself, if their other inputs exist.
uint32_t materialNeeds(const ShaderState& state, const ShaderMaterial& material);
// The features of the forms that a light's shadow map has.
uint32_t formFeatures(const PelLight& light);

// Whether a light's shadow image is made from its shadow map.
bool filtersShadow(const ShaderState& state, const ShaderLight& light);
// Whether some material takes what is made of a light's map as a wide shadow; all others take sharp ones.
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
