// What a shader's state asks for, in PelFeature bits; nothing else turns a feature on.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// PelFeature bits of what is bound and non-zero. Throws when something needed is missing or does not fit.
uint32_t deriveFeatures(const ShaderState& state);
// Those that a material asks for by itself, as far as the rest is there.
uint32_t materialNeeds(const ShaderState& state, const ShaderMaterial& material);
// Those of the forms that a light's shadow map has.
uint32_t formFeatures(const PelLight& light);

// Whether a light's shadow image is made from its shadow map.
bool filtersShadow(const ShaderState& state, const ShaderLight& light);
// Whether a material's diffuse light comes from irradiance per pixel.
inline bool readsIrradiance(const ShaderMaterial& material) {
    return material.params.scattering != PEL_SCATTERING_PREINTEGRATED;
}
// Whether that has to be made, which takes sharp shadows.
bool makesIrradiance(const ShaderState& state);
// Whether light from behind thin sheets is made: where the host gives it, it is added later.
bool makesLightFromBehind(const ShaderState& state, uint32_t features);
// Whether PelAmbient gives no light; there may be a cube map beside it.
bool isBlack(const PelAmbient& ambient);

}  // namespace pel
