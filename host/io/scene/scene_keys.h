// The keys of a scene file, listed once for reader and writer. A visitor has
//   number(key, float&, Range)   numbers(key, float*, count, Range)   rows(key, float*, rows, columns)
//   integer(key, uint32_t&, Range)   text(key, string&)   texts(key, vector<string>&, most, least)
//   choice(key, enum&, names)   table(key, isPresent, function)
#pragma once
#include "fields/field_ranges.h"
#include "io/choice_keys.h"
#include "io/scene/scene_file.h"
#include "shared/shade_passes.h"

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
// Inputs name their channels, outputs their files; radiance names the channels of its previous content.
#define PELLUCID_INPUT_TARGET(...) {__VA_ARGS__},
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
        // The last channel, of radius, oxygenation or distance, is optional.
        const bool optional =
            k.slot == PEL_SLOT_SCATTER_WEIGHT || k.slot == PEL_SLOT_SKIN || k.slot == PEL_SLOT_MOTION;
        const size_t least = k.components - (optional ? 1 : 0);
        v.texts(k.key, scene.channels[k.slot], k.components, least);
    }
}

// The keys of a list of pellucid_fields.h, for the visitor `v` and the structure `s`.
#define PELLUCID_FIELD_KEY(type, name, value, min, max, special, unit, key, ...) \
    PELLUCID_KEY_##type(key, s.name, (Range{min, max, special}))
#define PELLUCID_KEY_FLOAT(key, field, range) v.number(key, field, range);
#define PELLUCID_KEY_FREE(key, field, range) v.number(key, field, range);
#define PELLUCID_KEY_UINT(key, field, range) v.integer(key, field, range);
#define PELLUCID_KEY_FREE_UINT(key, field, range) v.integer(key, field, range);
#define PELLUCID_KEY_COLOR(key, field, range) v.numbers(key, field, 3, range);
#define PELLUCID_KEY_VECTOR(key, field, range) v.numbers(key, field, 3, range);
#define PELLUCID_KEY_MATRIX(key, field, range) v.numbers(key, field, 16, range);

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
    v.choice("content", l.light.shadowContent, shadowContents);
    v.text("second_channel", l.secondChannel);
    auto& s = l.light;
    PEL_EACH_SHADOW_MAP_FIELD(PELLUCID_FIELD_KEY)
    for (uint32_t i = 0; i < 3; ++i) {
        const bool used = i + 1 < l.light.shadowCascades;
        if constexpr (requires { v.has(""); })
            if (!used && v.has(cascadeKeys[i]))
                v.fail(cascadeKeys[i], "is one cascade more than 'cascades' says");
        v.table(cascadeKeys[i], used, [&](auto& inner) {
            inner.text("file", l.cascades[i].file);
            inner.text("channel", l.cascades[i].channel);
            inner.text("second_channel", l.cascades[i].secondChannel);
            inner.numbers("world_to_shadow", l.light.cascadeToShadow[i], 16, range::any);
            inner.number("depth_range", l.light.cascadeDepthRange[i], range::any);
        });
    }
}

template <class Visitor, class Light>
void lightKeys(Visitor& v, Light& l) {
    v.choice("type", l.light.type, lightTypes);
    auto& s = l.light;
    PEL_EACH_DIRECTIONAL_LIGHT_FIELD(PELLUCID_FIELD_KEY)
    PEL_EACH_POSITIONAL_LIGHT_FIELD(PELLUCID_FIELD_KEY)
    PEL_EACH_SPOT_LIGHT_FIELD(PELLUCID_FIELD_KEY)
    PEL_EACH_SPHERE_LIGHT_FIELD(PELLUCID_FIELD_KEY)
    PEL_EACH_RECTANGLE_LIGHT_FIELD(PELLUCID_FIELD_KEY)
    PEL_EACH_LIGHT_FIELD(PELLUCID_FIELD_KEY)
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
    auto& s = m.material;
    PEL_EACH_MATERIAL_FIELD(PELLUCID_FIELD_KEY)
    v.text("normal_map", m.normalMap);
    v.texts("normal_map_levels", m.normalMapLevels, PEL_MAP_LEVELS, 1, "file name");
    v.choice("specular_model", m.material.specularModel, specularModels);
    v.choice("scattering", m.material.scattering, scatterings);
    v.number("scale", m.scale, {0, PEL_FINITE, -1});
    v.text("scattered_texture", m.scatteredTexture);
}

template <class Visitor, class Scene>
void optionKeys(Visitor& v, Scene& scene) {
    v.text("gbuffer", scene.gbuffer);
    auto& s = scene.options;
    PEL_EACH_OPTION_FIELD(PELLUCID_FIELD_KEY)
    v.integer("accumulate", s.accumulate, {0, 1});
    v.text("reflection_cube", scene.reflectionCube);
    v.text("environment", scene.environment);
    v.numbers("environment_axes", scene.environmentAxes, 9, range::any);
}

template <class Visitor, class Params>
void scatterKeys(Visitor& v, Params& s) {
    PEL_EACH_SCATTER_PARAM_FIELD(PELLUCID_FIELD_KEY)
    v.integer("accumulate", s.accumulate, {0, 1});
    v.integer("everywhere", s.everywhere, {0, 1});
    v.integer("frame_index", s.frameIndex, range::any);
    v.integer("half_rate", s.halfRate, {0, 1});
}

template <class Visitor, class Eye>
void eyeKeys(Visitor& v, Eye& e) {
    v.integer("material", e.material, {1, 255});
    auto& s = e.eye;
    PEL_EACH_EYE_FIELD(PELLUCID_FIELD_KEY)
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
    auto& s = l.info.curvature;
    PEL_EACH_CURVATURE_LUT_FIELD(PELLUCID_FIELD_KEY)
}

template <class Visitor, class Lut>
void shadowLutKeys(Visitor& v, Lut& l) {
    v.text("name", l.name);
    v.text("file", l.file);
    v.text("profile", l.profile);
    v.choice("axis", l.info.shadow.axis, lutAxes);
    auto& s = l.info.shadow;
    PEL_EACH_SHADOW_LUT_FIELD(PELLUCID_FIELD_KEY)
}

}  // namespace pellucid::io
