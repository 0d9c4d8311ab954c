// The keys of a scene file, once: reader and writer both walk these lists. A visitor has
//   number(key, float&, Range)   numbers(key, float*, count, Range)   rows(key, float*, rows, columns)
//   integer(key, uint32_t&, Range)   text(key, string&)   texts(key, vector<string>&, most, least)
//   choice(key, enum&, names)   table(key, isPresent, function)
#pragma once
#include <string_view>

#include "io/choice_keys.h"
#include "io/scene/scene_file.h"
#include "shared/field_ranges.h"
#include "shared/image_slots.h"

namespace pellucid::io {

using Range = pel::FieldRange;
namespace range = pel::range;

constexpr std::string_view cascadeKeys[] = {"cascade_1", "cascade_2", "cascade_3"};
constexpr std::string_view scenePresets[] = {"none", "faceworks"};  // ScenePreset

struct SlotKey {
    PelImageSlot slot;
    std::string_view key;
    size_t components;
};
// Inputs name their channels, outputs their files.
#define PELLUCID_INPUT_TARGET(...)
#define PELLUCID_INPUT_SHADE(...) {__VA_ARGS__},
#define PELLUCID_INPUT_PASS(...) {__VA_ARGS__},
#define PELLUCID_INPUT_OUTPUT(...)
#define PELLUCID_OUTPUT_TARGET(...)
#define PELLUCID_OUTPUT_SHADE(...)
#define PELLUCID_OUTPUT_PASS(...)
#define PELLUCID_OUTPUT_OUTPUT(...) {__VA_ARGS__},
#define PELLUCID_INPUT(name, number, role, content, components, key, words, bits) \
    PELLUCID_INPUT_##role(PEL_SLOT_##name, key, components)
#define PELLUCID_OUTPUT(name, number, role, content, components, key, words, bits) \
    PELLUCID_OUTPUT_##role(PEL_SLOT_##name, key)
constexpr SlotKey slotKeys[] = {PEL_EACH_IMAGE(PELLUCID_INPUT)};

struct OutputKey {
    PelImageSlot slot;
    std::string_view key;
};
constexpr OutputKey outputKeys[] = {PEL_EACH_IMAGE(PELLUCID_OUTPUT)};

template <class Visitor, class Scene>
void outputFileKeys(Visitor& v, Scene& scene) {
    for (const OutputKey& k : outputKeys) v.text(k.key, scene.outputs[k.slot]);
}

template <class Visitor, class Scene>
void channelKeys(Visitor& v, Scene& scene) {
    for (const SlotKey& k : slotKeys) {
        const size_t least = k.slot == PEL_SLOT_SCATTER_WEIGHT ? 1 : k.components;  // its radius may be left out
        v.texts(k.key, scene.channels[k.slot], k.components, least);
    }
}

template <class Visitor, class Camera>
void cameraKeys(Visitor& v, Camera& camera) {
    v.numbers("position", camera.position, 3, range::any);
    v.numbers("inverse_view_projection", camera.inverseViewProjection, 16, range::any);
}

template <class Visitor, class Scene>
void ambientKeys(Visitor& v, Scene& scene) {
    v.numbers("constant", scene.ambient.constant, 3, range::any);
    v.rows("sh", scene.ambient.sh[0], 9, 3);
    v.text("cube", scene.ambientCube);
}

template <class Visitor, class Light>
void shadowMapKeys(Visitor& v, Light& l) {
    v.text("file", l.shadowMapFile);
    v.text("channel", l.shadowMapChannel);
    v.choice("projection", l.light.shadowProjection, shadowProjections);
    v.numbers("world_to_shadow", l.light.worldToShadow, 16, range::any);
    v.number("depth_range", l.light.shadowDepthRange, range::any);
    v.number("depth_a", l.light.shadowDepthA, range::any);
    v.number("depth_b", l.light.shadowDepthB, range::any);
    v.integer("filter_texels", l.light.shadowFilterTexels, range::light::shadowFilterTexels);
    v.number("bias", l.light.shadowBias, range::light::shadowBias);
    v.number("softness", l.light.shadowSoftness, range::light::shadowSoftness);
    v.number("cone_slope", l.light.shadowConeSlope, range::light::shadowConeSlope);
    v.choice("content", l.light.shadowContent, shadowContents);
    v.text("second_channel", l.secondChannel);
    v.number("exponent", l.light.shadowExponent, range::any);
    v.number("min_deviation", l.light.shadowMinDeviation, range::light::shadowMinDeviation);
    v.number("bleeding", l.light.shadowBleeding, range::light::shadowBleeding);
    v.integer("cascades", l.light.shadowCascades, range::light::shadowCascades);
    for (uint32_t i = 0; i < 3; ++i)
        v.table(cascadeKeys[i], i + 1 < l.light.shadowCascades, [&](auto& inner) {
            inner.text("file", l.cascades[i].file);
            inner.text("channel", l.cascades[i].channel);
            inner.text("second_channel", l.cascades[i].secondChannel);
            inner.numbers("world_to_shadow", l.light.cascadeToShadow[i], 16, range::any);
            inner.number("depth_range", l.light.cascadeDepthRange[i], range::any);
        });
}

template <class Visitor, class Light>
void lightKeys(Visitor& v, Light& l) {
    v.choice("type", l.light.type, lightTypes);
    v.numbers("to_light", l.light.toLight, 3, range::any);
    v.numbers("position", l.light.position, 3, range::any);
    v.numbers("spot_direction", l.light.spotDirection, 3, range::any);
    v.number("spot_cos_inner", l.light.spotCosInner, range::light::spotCosInner);
    v.number("spot_cos_outer", l.light.spotCosOuter, range::light::spotCosOuter);
    v.numbers("color", l.light.color, 3, range::light::color);
    v.number("range", l.light.range, range::light::range);
    v.text("wide_shadow", l.wideShadow);
    v.table("shadow_map", !l.shadowMapFile.empty(), [&](auto& inner) { shadowMapKeys(inner, l); });
}

template <class Visitor, class Material>
void materialKeys(Visitor& v, Material& m) {
    v.integer("id", m.id, {1, 255});
    v.text("curvature_lut", m.curvatureLut);
    v.text("shadow_lut", m.shadowLut);
    v.text("profile", m.profile);
    v.choice("preset", m.preset, scenePresets);
    v.number("transmission", m.material.transmission, range::material::transmission);
    v.number("curvature_gain", m.material.curvatureGain, range::material::curvatureGain);
    v.numbers("albedo", m.material.albedo, 3, range::material::albedo);
    v.number("diffusion_radius", m.material.diffusionRadius, range::material::diffusionRadius);
    v.numbers("normal_blend", m.material.normalBlend, 3, range::material::normalBlend);
    v.number("shadow_filter_width", m.material.shadowFilterWidth, range::material::shadowFilterWidth);
    v.numbers("deep_scatter_color", m.material.deepScatterColor, 3, range::material::deepScatterColor);
    v.number("deep_scatter_radius", m.material.deepScatterRadius, range::material::deepScatterRadius);
    v.number("deep_scatter_normal_offset", m.material.deepScatterNormalOffset,
             range::material::deepScatterNormalOffset);
    v.number("thickness_filter_radius", m.material.thicknessFilterRadius, range::material::thicknessFilterRadius);
    v.integer("thickness_taps", m.material.thicknessTaps, range::material::thicknessTaps);
    v.number("specular", m.material.specular, range::material::specular);
    v.number("roughness", m.material.roughness, range::material::roughness);
    v.number("f0", m.material.f0, range::material::f0);
    v.text("normal_map", m.normalMap);
    v.number("uv_scale", m.material.uvScale, range::material::uvScale);
    v.choice("specular_model", m.material.specularModel, specularModels);
    v.number("roughness2", m.material.roughness2, range::material::roughness2);
    v.number("lobe_mix", m.material.lobeMix, range::material::lobeMix);
    v.number("deep_scatter_ambient", m.material.deepScatterAmbient, range::material::deepScatterAmbient);
    v.choice("scattering", m.material.scattering, scatterings);
    v.integer("scatter_taps", m.material.scatterTaps, range::material::scatterTaps);
    v.number("albedo_before", m.material.albedoBefore, range::material::albedoBefore);
    v.numbers("border_color", m.material.borderColor, 3, range::material::borderColor);
    v.number("thin_thickness", m.material.thinThickness, range::material::thinThickness);
    v.text("scattered_texture", m.scatteredTexture);
}

template <class Visitor, class Eye>
void eyeKeys(Visitor& v, Eye& e) {
    v.integer("material", e.material, {1, 255});
    v.numbers("center", e.eye.center, 3, range::any);
    v.numbers("gaze", e.eye.gaze, 3, range::any);
    v.numbers("up", e.eye.up, 3, range::any);
    v.number("sclera_radius", e.eye.scleraRadius, range::eye::scleraRadius);
    v.number("cornea_radius", e.eye.corneaRadius, range::eye::corneaRadius);
    v.number("cornea_conic", e.eye.corneaConic, range::eye::corneaConic);
    v.number("limbus_radius", e.eye.limbusRadius, range::eye::limbusRadius);
    v.number("limbus_width", e.eye.limbusWidth, range::eye::limbusWidth);
    v.number("limbus_darkening", e.eye.limbusDarkening, range::eye::limbusDarkening);
    v.number("chamber_depth", e.eye.chamberDepth, range::eye::chamberDepth);
    v.number("cornea_index", e.eye.corneaIndex, range::eye::corneaIndex);
    v.number("aqueous_index", e.eye.aqueousIndex, range::eye::aqueousIndex);
    v.number("iris_radius", e.eye.irisRadius, range::eye::irisRadius);
    v.number("iris_concavity", e.eye.irisConcavity, range::eye::irisConcavity);
    v.number("pupil_radius", e.eye.pupilRadius, range::eye::pupilRadius);
    v.number("texture_pupil", e.eye.texturePupil, range::eye::texturePupil);
    v.numbers("iris_color", e.eye.irisColor, 3, range::eye::irisColor);
    v.integer("iris_seed", e.eye.irisSeed, range::notNegative);
    v.number("tear_roughness", e.eye.tearRoughness, range::eye::tearRoughness);
    v.number("wet_line_roughness", e.eye.wetLineRoughness, range::eye::wetLineRoughness);
    v.number("tear_index", e.eye.tearIndex, range::eye::tearIndex);
    v.text("iris_texture", e.irisTexture);
    v.text("iris_profile", e.irisProfile);
    v.text("caustics", e.caustics);
}

template <class Visitor, class Lut>
void curvatureLutKeys(Visitor& v, Lut& l) {
    v.text("name", l.name);
    v.text("file", l.file);
    v.choice("form", l.info.curvature.form, curvatureForms);
    v.choice("axis", l.info.curvature.axis, lutAxes);
    v.text("profile", l.profile);
    v.integer("width", l.info.curvature.width, range::curvatureLut::width);
    v.integer("height", l.info.curvature.height, range::curvatureLut::height);
    v.number("diffusion_radius", l.info.curvature.diffusionRadius, range::curvatureLut::diffusionRadius);
    v.number("radius_min", l.info.curvature.radiusMin, range::curvatureLut::radiusMin);
    v.number("radius_max", l.info.curvature.radiusMax, range::curvatureLut::radiusMax);
}

template <class Visitor, class Lut>
void shadowLutKeys(Visitor& v, Lut& l) {
    v.text("name", l.name);
    v.text("file", l.file);
    v.text("profile", l.profile);
    v.integer("width", l.info.shadow.width, range::shadowLut::width);
    v.integer("height", l.info.shadow.height, range::shadowLut::height);
    v.number("diffusion_radius", l.info.shadow.diffusionRadius, range::shadowLut::diffusionRadius);
    v.number("width_min", l.info.shadow.widthMin, range::shadowLut::widthMin);
    v.number("width_max", l.info.shadow.widthMax, range::shadowLut::widthMax);
    v.number("sharpening", l.info.shadow.sharpening, range::shadowLut::sharpening);
    v.choice("axis", l.info.shadow.axis, lutAxes);
    v.integer("closed_ends", l.info.shadow.closedEnds, range::shadowLut::closedEnds);
}

}  // namespace pellucid::io
