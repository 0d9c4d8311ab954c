#include "shading/features.h"

#include "shading/check_settings.h"
#include "shading/launch_ranges.h"
#include "shared/light_space.h"

namespace pel {
namespace {

void need(bool present, const char* what, const char* why) {
    if (!present) invalidArgument("the ", what, " is needed ", why, ", but not set");
}

void checkSizes(const ShaderState& state) {
    const ImageView& target = state.images[PEL_SLOT_RADIANCE];
    // Outputs beside radiance: they may not overlap any other image.
    const auto checkOutputs = [&](const ImageView& view, const std::string& what, int itself) {
        for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
            if (isOutput(slot) && slot != itself && state.images[slot] &&
                overlapsElsewhere(state.images[slot], view))
                invalidArgument("the ", slotName(slot), " image overlaps the ", what,
                                " image in memory, but not at the same pixels");
    };
    auto check = [&](const ImageView& view, const std::string& what, int itself = -1) {
        if (!view) return;
        checkOutputs(view, what, itself);
        if (view.width != target.width || view.height != target.height)
            invalidArgument("the ", what, " image is ", view.width, " x ", view.height,
                            ", the radiance image ", target.width, " x ", target.height,
                            "; all images of a frame need one size");
        if (overlapsElsewhere(target, view))
            invalidArgument("the radiance image overlaps the ", what,
                            " image in memory, but not at the same pixels: pixels would be overwritten "
                            "before they are read");
    };
    for (int slot = 1; slot < PEL_SLOT_COUNT; ++slot) check(state.images[slot], slotName(slot), slot);
    const auto checkApart = [&](const ImageView& view, const std::string& what) {
        if (!view) return;
        checkOutputs(view, what, -1);
        if (overlapsElsewhere(target, view))
            invalidArgument("the radiance image overlaps the ", what, " in memory");
    };
    checkApart(state.ambientCube, "ambient cube");
    checkApart(state.reflectionCube, "reflection cube");
    checkApart(state.environment, "environment");
    for (const auto& [id, material] : state.materials)
        if (material.eye) checkApart(material.eye->iris, text("iris texture of material ", id));
    for (size_t i = 0; i < state.lights.size(); ++i) {
        check(state.lights[i].images[PEL_LIGHT_WIDE_SHADOW], text("wide shadow ", i));
        for (int slot = PEL_LIGHT_SHADOW_MAP; slot < PEL_LIGHT_SLOT_COUNT; ++slot)
            checkApart(state.lights[i].images[slot], text(lightSlotName(PelLightSlot(slot)), " ", i));
    }
}

// One kernel reads all wide shadows, and all shadow maps: each with one format.
void checkLightFormats(const ShaderState& state, PelLightSlot slot) {
    const ImageView* first = nullptr;
    for (const ShaderLight& light : state.lights) {
        const ImageView& view = light.images[slot];
        if (!view) continue;
        if (slot == PEL_LIGHT_WIDE_SHADOW && view.format != PEL_FORMAT_R32F &&
            std::ranges::any_of(state.lights, [&](const ShaderLight& l) { return filtersShadow(state, l); }))
            fail(PEL_ERROR_UNSUPPORTED, "a wide shadow image has format ", view.info().name,
                 "; it must be R32F if the wide shadow of another light is made from its shadow map");
        if (!first) first = &view;
        if (view.format != first->format)
            fail(PEL_ERROR_UNSUPPORTED, "one ", lightSlotName(slot), " image has format ", first->info().name,
                 ", another ", view.info().name, "; those of all lights need the same");
    }
}

// One kernel reads all maps, cascades too.
void checkShadowMaps(const ShaderState& state) {
    const ShaderLight* first = nullptr;
    for (const ShaderLight& light : state.lights) {
        const ImageView& map = light.images[PEL_LIGHT_SHADOW_MAP];
        if (!map) continue;
        if (!first) first = &light;
        if (light.params.shadowContent != first->params.shadowContent)
            fail(PEL_ERROR_UNSUPPORTED, "one light has shadowContent ", int(first->params.shadowContent),
                 ", another ", int(light.params.shadowContent),
                 "; the shadow maps of all lights need the same");
        for (uint32_t i = 1; i < light.params.shadowCascades; ++i)
            if (const ImageView& cascade = *shadowCascade(light, i).map;
                cascade && cascade.format != map.format)
                fail(PEL_ERROR_UNSUPPORTED, "the first cascade has format ", map.info().name, ", another ",
                     cascade.info().name, "; all shadow maps need the same");
    }
}

// One program reads the normal maps of all materials.
void checkNormalMapFormats(const ShaderState& state) {
    const ImageView* first = nullptr;
    for (const auto& [id, material] : state.materials) {
        if (material.normalMap.empty()) continue;
        const ImageView& view = material.normalMap[0];
        if (!first) first = &view;
        if (formatCode(view, 1) != formatCode(*first, 1))
            fail(PEL_ERROR_UNSUPPORTED, "the normal map of material ", id, " has format ", view.info().name,
                 ", another ", first->info().name,
                 ", or another packing; those of all materials need the same");
    }
}

}  // namespace

bool makesIrradiance(const ShaderState& state) {
    return !state.images[PEL_SLOT_IRRADIANCE] && anyMaterial(state, readsIrradiance);
}

bool makesLightFromBehind(const ShaderState& state, uint32_t features) {
    return features & PEL_FEATURE_MAKE_IRRADIANCE && !state.images[PEL_SLOT_IRRADIANCE_BACK] &&
           anyMaterial(state, [](const ShaderMaterial& m) { return m.params.thinThickness > 0; });
}

// True if irradiance is made, or if materials that read it have specular light.
static bool takesSharpShadows(const ShaderState& state) {
    return makesIrradiance(state) || anyMaterial(state, [](const ShaderMaterial& m) {
               return readsIrradiance(m) && m.params.specular > 0;
           });
}

bool filtersShadow(const ShaderState& state, const ShaderLight& light) {
    return !light.images[PEL_LIGHT_WIDE_SHADOW] && light.images[PEL_LIGHT_SHADOW_MAP] &&
           (light.params.shadowFilterTexels > 0 || takesSharpShadows(state));
}

bool filtersWide(const ShaderState& state, const ShaderLight& light) {
    if (light.params.shadowFilterTexels == 0) return false;
    return isArea(light.params) ||
           anyMaterial(state, [](const ShaderMaterial& m) { return !readsIrradiance(m); });
}

uint32_t formFeatures(const PelLight& l) {
    uint32_t features = 0;
    if (isCube(l)) features |= PEL_FEATURE_SHADOW_CUBE;
    if (l.shadowCascades) features |= PEL_FEATURE_SHADOW_CASCADES;
    if (l.shadowContent == PEL_SHADOW_CONTENT_EXPONENTIAL) features |= PEL_FEATURE_SHADOW_EXPONENTIAL;
    if (l.shadowContent == PEL_SHADOW_CONTENT_MOMENTS) features |= PEL_FEATURE_SHADOW_MOMENTS;
    return features;
}

bool isBlack(const PelAmbient& a) {
    return isBlack(a.constant) &&
           std::all_of(std::begin(a.sh), std::end(a.sh), [](auto& c) { return isBlack(c); });
}

// Whether PelAmbient, a cube map or an environment gives light.
static bool isSurrounded(const ShaderState& state) {
    return !isBlack(state.ambient) || state.ambientCube || state.environment;
}

bool hasAmbient(const ShaderState& state) {
    return isSurrounded(state) || state.images[PEL_SLOT_INDIRECT];
}

uint32_t materialNeeds(const ShaderState& state, const ShaderMaterial& material) {
    const auto& images = state.images;
    const PelMaterial& m = material.params;
    const auto some = [&](auto has) { return std::any_of(state.lights.begin(), state.lights.end(), has); };
    const bool wide = some(
        [&](const ShaderLight& l) { return l.images[PEL_LIGHT_WIDE_SHADOW] || filtersShadow(state, l); });
    const bool map = some([](const ShaderLight& l) { return bool(l.images[PEL_LIGHT_SHADOW_MAP]); });
    const bool tables = !readsIrradiance(material);
    uint32_t needs = tables ? 0 : PEL_FEATURE_IRRADIANCE;
    if (!state.lights.empty()) {
        if (tables && material.curvatureLut && images[PEL_SLOT_CURVATURE])
            needs |= PEL_FEATURE_DIRECT_SCATTER;
        if (tables && material.shadowLut && wide) needs |= PEL_FEATURE_SHADOW_LUT;
        if (!isBlack(m.deepScatterColor)) {
            if (images[PEL_SLOT_THICKNESS])
                needs |= PEL_FEATURE_DEEP_SCATTER;
            else if (map && m.thicknessTaps)
                needs |= PEL_FEATURE_DEEP_SCATTER | PEL_FEATURE_THICKNESS_TAPS;
        }
        if (tables && material.transmission && m.transmission > 0 && isBlack(m.deepScatterColor)) {
            if (images[PEL_SLOT_THICKNESS])
                needs |= PEL_FEATURE_TRANSMISSION;
            else if (map && m.thicknessTaps && (images[PEL_SLOT_POSITION] || images[PEL_SLOT_DEPTH]))
                needs |= PEL_FEATURE_TRANSMISSION | PEL_FEATURE_THICKNESS_TAPS;
        }
        if (m.specular > 0) needs |= PEL_FEATURE_SPECULAR;
        if (m.specular > 0 && m.specularModel == PEL_SPECULAR_GGX) needs |= PEL_FEATURE_GGX;
    }
    if (m.specular > 0 && state.environment) needs |= PEL_FEATURE_ENVIRONMENT;
    if (material.eye)
        needs |=
            PEL_FEATURE_EYE | (state.reflectionCube || state.environment ? PEL_FEATURE_REFLECTION_CUBE : 0);
    if (isSurrounded(state) && images[PEL_SLOT_THICKNESS] && m.deepScatterAmbient > 0 &&
        !isBlack(m.deepScatterColor))
        needs |= PEL_FEATURE_AMBIENT_SCATTER;
    return needs;
}

ShaderState inRegion(ShaderState state) {
    PelShaderOptions& o = state.options;
    const ImageView frame = state.images[PEL_SLOT_RADIANCE];
    if (!o.regionWidth || !frame) return state;
    checkSizes(state);
    if (!o.regionHeight || uint64_t(o.regionX) + o.regionWidth > frame.width ||
        uint64_t(o.regionY) + o.regionHeight > frame.height)
        invalidArgument("the region of PelShaderOptions is ", o.regionWidth, " x ", o.regionHeight,
                        " pixels from (", o.regionX, ", ", o.regionY, ") on, and the images are ",
                        frame.width, " x ", frame.height, "; it must lie inside them");
    const auto crop = [&](ImageView& view) {
        if (!view) return;
        view.byteOffset += o.regionY * view.rowStride + o.regionX * view.pixelStride;
        view.width = o.regionWidth, view.height = o.regionHeight;
    };
    for (ImageView& view : state.images) crop(view);
    for (ShaderLight& light : state.lights) crop(light.images[PEL_LIGHT_WIDE_SHADOW]);
    o.regionX = o.regionY = o.regionWidth = o.regionHeight = 0;
    return state;
}

uint32_t deriveFeatures(const ShaderState& state) {
    const auto& images = state.images;
    need(bool(images[PEL_SLOT_RADIANCE]), "radiance image", "as the output");
    need(bool(images[PEL_SLOT_NORMAL_SHADING]), "shading normal image", "by every term");
    checkSizes(state);
    if (state.materials.empty())
        invalidArgument("no material is set: pelShaderSetMaterial gives an id its material");
    if (!images[PEL_SLOT_MATERIAL] && !state.materials.contains(1))
        invalidArgument("without a material image all pixels are of material 1, which is not set");
    checkLightFormats(state, PEL_LIGHT_WIDE_SHADOW);
    checkLightFormats(state, PEL_LIGHT_SHADOW_MAP);
    checkShadowMaps(state);

    bool wide = false, filtered = false, positional = false;
    uint32_t forms = 0;
    for (size_t i = 0; i < state.lights.size(); ++i) {
        const ShaderLight& light = state.lights[i];
        filtered |= filtersShadow(state, light);
        wide |= light.images[PEL_LIGHT_WIDE_SHADOW] || filtersShadow(state, light);
        positional |= light.params.type != PEL_LIGHT_DIRECTIONAL;
        if (light.images[PEL_LIGHT_SHADOW_MAP]) {
            checkLightMap(light, uint32_t(i));
            forms |= formFeatures(light.params);
        }
    }
    uint32_t features = 0;
    if (wide) features |= PEL_FEATURE_SHADOW;
    if (filtered) features |= PEL_FEATURE_FILTER_SHADOW;
    if (hasAmbient(state)) features |= PEL_FEATURE_AMBIENT;
    if (state.ambientCube || state.environment) features |= PEL_FEATURE_AMBIENT_CUBE;
    for (const auto& [id, material] : state.materials) features |= materialNeeds(state, material);
    if (features & (PEL_FEATURE_THICKNESS_TAPS | PEL_FEATURE_FILTER_SHADOW)) features |= forms;
    if (makesIrradiance(state)) features |= PEL_FEATURE_MAKE_IRRADIANCE;
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
        if (isOutput(slot) && images[slot]) features |= PEL_FEATURE_OUTPUTS;
    // Blurred normals matter to scattered and ambient light. A host's image is used first, then a normal map,
    // then the blur.
    const bool read = !state.lights.empty() || features & PEL_FEATURE_AMBIENT;
    if (read && !images[PEL_SLOT_NORMAL_BLURRED])
        for (const auto& [id, material] : state.materials) {
            if (!material.normalMap.empty())
                features |= PEL_FEATURE_NORMAL_MAP;
            else if (state.options.blurNormals &&
                     (!readsIrradiance(material) || !isBlack(material.params.deepScatterColor)))
                features |= PEL_FEATURE_BLUR_NORMALS;
        }
    if (features & PEL_FEATURE_NORMAL_MAP) {
        need(bool(images[PEL_SLOT_UV]), "UV image", "by normal maps");
        need(bool(images[PEL_SLOT_TANGENT]), "tangent image", "by normal maps");
        checkNormalMapFormats(state);
    }
    const bool position = images[PEL_SLOT_POSITION] || images[PEL_SLOT_DEPTH];
    if (images[PEL_SLOT_DEPTH] && !images[PEL_SLOT_POSITION])
        checkInvertible("PelCamera", state.camera.inverseViewProjection);
    constexpr const char* what = "position image (or the depth image)";
    if (features & PEL_FEATURE_THICKNESS_TAPS) need(position, what, "to measure thickness in the shadow map");
    if (features & (PEL_FEATURE_SPECULAR | PEL_FEATURE_ENVIRONMENT))
        need(position, what, "by the specular term");
    if (features & PEL_FEATURE_BLUR_NORMALS) need(position, what, "to blur normals over a length");
    if (filtered) need(position, what, "to filter a wide shadow from a shadow map");
    if (features & PEL_FEATURE_EYE) need(position, what, "by eyes");
    if (positional) need(position, what, "by lights that have a position");
    return features;
}

bool shines(const ShaderLight& light) {
    return light.images[PEL_LIGHT_SHADOW_MAP] && !isBlack(light.params.color);
}

bool isArea(const PelLight& light) {
    return light.type >= PEL_LIGHT_SPHERE;
}

bool hasAreaLight(const ShaderState& state) {
    return std::ranges::any_of(state.lights, [](const ShaderLight& l) { return isArea(l.params); });
}

uint32_t mapsOf(const ShaderLight& light) {
    return isCube(light.params) ? 6 : cascadesOf(light);
}

bool usesSkinMaps(const ShaderState& state) {
    return state.images[PEL_SLOT_SKIN] && anyMaterial(state, takesSkinMaps);
}

bool lightIsMapped(const ShaderState& state) {
    uint32_t maps = 0;
    for (const ShaderLight& light : state.lights) {
        if (isBlack(light.params.color)) continue;
        if (!shines(light)) return false;
        maps += mapsOf(light);
    }
    return maps > 0 && maps <= PEL_LIGHT_MAPS && !hasAmbient(state);
}

}  // namespace pel
