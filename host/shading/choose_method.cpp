#include "shading/features.h"

#include "shading/image_slots.h"

namespace pel {
namespace {

bool isAuto(const ShaderMaterial& material) {
    return material.given.scattering == PEL_SCATTERING_AUTO;
}
bool hasBorder(const PelMaterial& m) {
    return m.borderColor[0] > 0 || m.borderColor[1] > 0 || m.borderColor[2] > 0;
}
bool bringsTables(const ShaderMaterial& material) {
    return material.givenCurvatureLut || material.givenShadowLut;
}

// Whether every light's shadow is sharp where irradiance is made, or can be made so.
bool shadowsAreSharp(const ShaderState& state) {
    // by materials that are shaded by tables
    const bool wanted = std::ranges::any_of(
        state.materials, [](const auto& m) { return !isAuto(m.second) && !readsIrradiance(m.second); });
    return std::ranges::all_of(state.lights, [&](const ShaderLight& light) {
        return !light.images[PEL_LIGHT_WIDE_SHADOW] || light.params.plainShadow ||
               (light.images[PEL_LIGHT_SHADOW_MAP] && !wanted);
    });
}

}  // namespace

std::string chooseMethods(ShaderState& state, uint32_t methods, uint64_t tooMany) {
    std::string all;
    const auto say = [&](auto&&... parts) { all += (all.empty() ? "" : "\n") + text(parts...); };
    const bool places = state.images[PEL_SLOT_POSITION] || state.images[PEL_SLOT_DEPTH];
    const bool given = bool(state.images[PEL_SLOT_IRRADIANCE]);
    const bool onScreen =
        places && !tooMany && (given || shadowsAreSharp(state)) && (methods >> PEL_SCATTERING_SCREEN & 1);
    const bool lit = !state.lights.empty() || hasAmbient(state);
    bool scatters = false;
    for (auto& [id, material] : state.materials) {
        if (!isAuto(material)) continue;
        material.params.scattering = PEL_SCATTERING_PREINTEGRATED;
        if (!material.profile || bringsTables(material) || !(lit || given)) continue;
        if (onScreen) {
            material.params.scattering = PEL_SCATTERING_SCREEN;
            scatters = true;
            const bool border = hasBorder(material.params);  // not supported by blocks of pixels
            material.params.scatterTaps = border ? diskTapsForBlocks : 0;
            if (border)
                say("material ", id, " scatters by ", diskTapsForBlocks,
                    " taps on a disk, because it has a borderColor; without one it would scatter over the "
                    "whole profile, and include surfaces that only the shadow maps show");
        } else if (tooMany) {
            say("material ", id, " scatters by its tables, because PelShaderOptions.scratchBudget is ",
                state.options.scratchBudget,
                " bytes, and scattering on the screen needs memory for the whole frame, ", tooMany, " bytes");
        } else if (!places) {
            say("material ", id,
                " scatters by its tables, because there are neither positions nor depth; with them it would "
                "scatter on the screen, which is more accurate");
        } else {
            say("material ", id,
                " scatters by its tables, because a light has a wide shadow image; with an irradiance "
                "image, a shadow map instead, or PelLight.plainShadow, it would scatter on the screen, which "
                "is more accurate");
        }
    }
    // Materials without a profile and tables use the same irradiance and shadows as those that scatter.
    for (auto& [id, material] : state.materials)
        if (isAuto(material) && !material.profile && !bringsTables(material) && (scatters || given))
            material.params.scattering = PEL_SCATTERING_NONE;
    if (scatters && !given)
        for (ShaderLight& light : state.lights)
            if (light.images[PEL_LIGHT_SHADOW_MAP] && !light.params.plainShadow)
                light.images[PEL_LIGHT_WIDE_SHADOW] = ImageView();
    return all;
}

ShaderState standInOf(const ShaderState& given) {
    ShaderState state = given;
    state.options.blurNormals = 0;
    state.options.tileLists = PEL_TILES_ONE_LIST;
    for (auto& [id, material] : state.materials) {
        PelMaterial& m = material.params;
        m.scattering = material.given.scattering = PEL_SCATTERING_NONE;
        m.specular = m.transmission = m.thinThickness = m.albedoBefore = m.deepScatterAmbient = 0;
        std::fill_n(m.deepScatterColor, 3, 0.0f);
        std::fill_n(material.gain, 3, 0.0f);
        material.normalMap.clear();
        material.eye.reset();
    }
    return state;
}

static void checkMaterial(uint32_t id, const ShaderMaterial& material, const ShaderState& state) {
    const PelMaterial& m = material.params;
    if (m.thinThickness > 0 && (!material.profile || !readsIrradiance(material)))
        invalidArgument("material ", id, " has a thinThickness of ", m.thinThickness, " and ",
                        material.profile ? "scatters by its tables" : "no profile",
                        "; it needs a profile and a scattering other than preintegrated");
    if (m.thinThickness > 0 && state.images[PEL_SLOT_IRRADIANCE] && !state.images[PEL_SLOT_IRRADIANCE_BACK])
        invalidArgument(
            "material ", id, " has a thinThickness of ", m.thinThickness,
            ", but there is an irradiance image without a back irradiance image: the light on the "
            "other side is unknown");
    if (m.scattering == PEL_SCATTERING_TEXTURE && (!material.scatteredTexture || !state.images[PEL_SLOT_UV]))
        invalidArgument("material ", id, " uses light that was scattered in its texture, but there is no ",
                        material.scatteredTexture ? "UV image to sample it by"
                                                  : "such texture: pelShaderSetScatteredTexture sets it");
    if (!scattersIrradiance(material) || scattersByTaps(material)) return;
    if (hasBorder(m))
        fail(PEL_ERROR_UNSUPPORTED, "material ", id, " has a borderColor and scatters by \"",
             scatteringName(m.scattering),
             "\"; only separable, and screen with scatterTaps of 8 to 256, let light cross borders");
}

void checkScattering(const ShaderState& state) {
    for (const auto& [id, material] : state.materials) checkMaterial(id, material, state);
}

}  // namespace pel
