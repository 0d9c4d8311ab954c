// The features of a shader's state, in PelFeature bits. Nothing else turns a feature on.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Taps of the disk that replaces the whole profile for materials with settings that sums over blocks do not
// support.
constexpr uint32_t diskTapsForBlocks = 64;

// The state with its images cropped to PelShaderOptions.regionX to regionHeight, and no region. Throws if it
// is not inside them.
ShaderState inRegion(ShaderState state);

// The PelFeature bits of a state. Throws if a required input is missing or does not match.
uint32_t deriveFeatures(const ShaderState& state);
template <class Has>
bool anyMaterial(const ShaderState& state, const Has& has) {
    return std::ranges::any_of(state.materials, [&](const auto& entry) { return has(entry.second); });
}
// The features that one material needs, as far as their other inputs exist.
uint32_t materialNeeds(const ShaderState& state, const ShaderMaterial& material);
// The features for the projection, cascades and content of a light's shadow map.
uint32_t formFeatures(const PelLight& light);

// Whether a light's shadow image is made from its shadow map.
bool filtersShadow(const ShaderState& state, const ShaderLight& light);
// Whether some material takes a wide shadow from the map of the light; all others take sharp shadows.
bool filtersWide(const ShaderState& state, const ShaderLight& light);
// Whether a material's diffuse light comes from irradiance per pixel.
inline bool readsIrradiance(const ShaderMaterial& material) {
    return material.params.scattering != PEL_SCATTERING_PREINTEGRATED;
}
// Whether the irradiance of the material is scattered, by any method.
inline bool scattersIrradiance(const ShaderMaterial& material) {
    return readsIrradiance(material) && material.params.scattering != PEL_SCATTERING_NONE;
}
// By taps on a disk, not by the whole profile.
inline bool scattersOnDisk(const ShaderMaterial& material) {
    return material.params.scattering == PEL_SCATTERING_SCREEN && material.params.scatterTaps > 0;
}
// By taps, on a disk or along lines.
inline bool scattersByTaps(const ShaderMaterial& material) {
    return scattersOnDisk(material) || material.params.scattering == PEL_SCATTERING_SEPARABLE;
}
// Whether the shader makes that irradiance, which needs sharp shadows.
bool makesIrradiance(const ShaderState& state);
// Whether light from behind thin sheets is made: where the host gives it, it is added later.
bool makesLightFromBehind(const ShaderState& state, uint32_t features);
inline bool isBlack(const float (&color)[3]) {
    return color[0] == 0 && color[1] == 0 && color[2] == 0;
}
// Whether light comes from all round, or indirect light is given per pixel.
bool hasAmbient(const ShaderState& state);
// Whether PelAmbient gives no light; there may still be a cube map.
bool isBlack(const PelAmbient& ambient);

// Whether a light has a shadow map and a colour, so that its light may be summed over the map
// (docs/mathematics.md, section 10, "Light space").
bool shines(const ShaderLight& light);
// The number of those maps; each cascade and each face of a cube counts.
uint32_t mapsOf(const ShaderLight& light);
// Spheres and rectangles.
bool isArea(const PelLight& light);
bool hasAreaLight(const ShaderState& state);
// Whether maps hold all light: every light that has a colour has one, there are some and not too many, and
// there is no ambient light.
bool lightIsMapped(const ShaderState& state);

// Whether the material's albedo and radius come from maps of skin, if there are some.
inline bool takesSkinMaps(const ShaderMaterial& material) {
    return material.profile && material.profile->pigments();
}
bool usesSkinMaps(const ShaderState& state);

// Replaces auto by a method in each material's params, and removes the wide shadow images that sharp shadows
// from maps replace. `methods`: bit i: the build has the PelScattering i. Returns warnings, one a line, about
// inputs that auto lacked. `tooMany`: bytes that scattering on the screen takes, where they are more than
// PelShaderOptions.scratchBudget; else 0.
std::string chooseMethods(ShaderState& state, uint32_t methods, uint64_t tooMany);

// Throws if a control cannot be honoured.
void checkScattering(const ShaderState& state);

// The state with "none" for each material's method, and without other features that need further programs:
// specular light, light through thin parts, normal maps, eyes.
ShaderState standInOf(const ShaderState& state);

// Ambient light on each iris, and the table of each eye that brought none; eyes of one shape share them.
void prepareEyes(const Ref<Device>& device, std::map<uint32_t, ShaderMaterial>& materials);
// Takes both from eyes of the same shape in `from`.
void adoptEyes(std::map<uint32_t, ShaderMaterial>& materials, const std::map<uint32_t, ShaderMaterial>& from);
// Sets empty tables for a warm-up; false if no eye needs one.
bool pretendEyes(const Ref<Device>& device, std::map<uint32_t, ShaderMaterial>& materials);

}  // namespace pel
