// The settings of a PelShader. A commit makes a ShaderPlan from them (shader_plan.h).
#pragma once
#include "core/image_view.h"
#include "eye/eye.h"

namespace pel {

// The eye around a material that is its sclera.
struct ShaderEye {
    PelEye given{};
    PelEye params{};  // checked, with its defaults filled in (eye/eye.h)
    Ref<Profile> irisProfile;
    Ref<Lut> caustics;  // the caller's, or made at commit
    bool ownCaustics = false;
    AmbientNodes ambient{};
    bool ambientKnown = false;
    ImageView iris;              // texture; none: fibres are drawn
    uint64_t textureNumber = 0;  // different for each call that sets a texture
};

// Texels along a side of its iris in the form that shading samples.
inline uint32_t irisTexels(const ShaderEye& eye) {
    return eye.iris ? eye.iris.width : PEL_FIBRE_TEXELS;
}

struct ShaderMaterial {
    PelMaterial given;  // as the caller set it, with these
    Ref<Profile> profile;
    Ref<Lut> givenCurvatureLut, givenShadowLut;
    // The same with defaults filled in (shading/material.h, features.h), and what follows from it.
    PelMaterial params;
    Ref<Lut> curvatureLut, shadowLut, transmission;
    float through[3];     // share of the light on a sheet's other side
    float gain[3];        // length: mean free path times curvatureGain; 0: no gain
    float absorption[3];  // sqrt(1 - albedo of a single scattering) of that medium
    float gainSlope[3], gainSaturation[3];
    float gainWindow;  // length over which the mean curvature is measured
    // Of the wide shadow, where a light leaves them to the profile.
    float shadowBias, shadowSoftness, shadowConeSlope;
    std::vector<ImageView> normalMap;  // its levels, the finest first
    ImageView scatteredTexture;
    std::optional<ShaderEye> eye;
};

struct ShaderLight {
    PelLight params;
    std::array<ImageView, PEL_LIGHT_SLOT_COUNT> images;
};

struct ShaderState {
    PelShaderOptions options = pelShaderOptionsDefaults();
    std::array<ImageView, PEL_SLOT_COUNT> images;
    std::map<uint32_t, ShaderMaterial> materials;
    std::vector<ShaderLight> lights;
    PelAmbient ambient = pelAmbientDefaults();
    ImageView ambientCube, reflectionCube;  // six faces
    ImageView environment;                  // equirectangular, or six faces
    std::array<float, 9> environmentAxes{1, 0, 0, 0, 1, 0, 0, 0, 1};
    uint64_t environmentNumber = 0;  // different for each call that sets one
    PelCamera camera = pelCameraDefaults();
};

// One of a light's cascades, 0 the finest.
struct ShadowCascade {
    const float (*worldToShadow)[16];
    float depthRange;
    const ImageView* map;
};
inline ShadowCascade shadowCascade(const ShaderLight& light, uint32_t index) {
    const PelLight& l = light.params;
    if (index == 0) return {&l.worldToShadow, l.shadowDepthRange, &light.images[PEL_LIGHT_SHADOW_MAP]};
    return {&l.cascadeToShadow[index - 1], l.cascadeDepthRange[index - 1],
            &light.images[PEL_LIGHT_CASCADE_1 + index - 1]};
}
// How much u (row 0) or v (row 1) of a parallel map grows per length.
inline double uvPerLength(const float (&worldToShadow)[16], int row) {
    return length(threeAt(worldToShadow + 4 * row)) / std::abs(double(worldToShadow[15]));
}
// How many maps a light has.
inline uint32_t cascadesOf(const ShaderLight& light) {
    return light.params.shadowCascades ? light.params.shadowCascades : 1;
}
inline bool isCube(const PelLight& light) {
    return light.shadowProjection >= PEL_SHADOW_CUBE;
}

}  // namespace pel
