// Warnings of a commit: settings that can be shaded but are probably not intended (pelShaderGetWarnings).

#include "shading/features.h"
#include "shading/image_slots.h"
#include "shading/material.h"

namespace pel {
namespace {

// Lengths of a light's parallel maps; 0 for others, whose texels grow with distance.
struct MapLengths {
    double span = 0;   // of the longer side of the largest cascade
    double texel = 0;  // of a texel's longer side in the finest
};

MapLengths lengthsOf(const ShaderLight& light) {
    MapLengths lengths;
    if (light.params.shadowProjection != PEL_SHADOW_PARALLEL || !light.images[PEL_LIGHT_SHADOW_MAP])
        return lengths;
    for (uint32_t k = 0; k < cascadesOf(light); ++k) {
        const ShadowCascade cascade = shadowCascade(light, k);
        for (int row = 0; row < 2; ++row) {
            const double perLength = uvPerLength(*cascade.worldToShadow, row);
            lengths.span = std::max(lengths.span, 1 / perLength);
            if (k == 0)
                lengths.texel = std::max(lengths.texel,
                                         1 / (perLength * (row ? cascade.map->height : cascade.map->width)));
        }
    }
    return lengths;
}

// A lit body of skin is at least as large as a fingertip: a map that spans less than that, and less than two
// reaches of the profile, cannot hold it.
constexpr double leastReaches = 2, fingertip = 20;  // mm

// The settings that have no effect with the material's method; "" if there are none.
std::string withoutEffect(const ShaderMaterial& material) {
    const PelMaterial &m = material.params, &given = material.given;
    const bool tables = !readsIrradiance(material);
    std::string names;
    const auto add = [&](bool idle, const char* name) {
        if (idle) names += (names.empty() ? "" : ", ") + std::string(name);
    };
    add(given.scatterTaps && given.scattering != PEL_SCATTERING_SEPARABLE &&
            given.scattering != PEL_SCATTERING_SCREEN,
        "scatterTaps");
    const bool stays = tables || m.scattering == PEL_SCATTERING_NONE;
    add(stays && !isBlack(m.borderColor), "borderColor");
    add(stays && m.albedoBefore > 0, "albedoBefore");
    return names;
}

// How the eye of a caustic table differs in shape; "" if it does not. Tables do not depend on the unit of
// length.
std::string otherShape(const PelEyeLutDesc& table, const PelEye& eye) {
    const double scale = double(eye.scleraRadius) / table.scleraRadius;
#define PEL_COMPARE_(type, name, value, least, most, none, unit, ...)                \
    if (const double is = table.name * (*unit ? scale : 1.0);                        \
        std::abs(is - eye.name) > 1e-3 * std::max(1e-3, std::abs(double(eye.name)))) \
        return text(#name " is ", float(is), " in the table and ", eye.name, " in the eye");
    PEL_EACH_EYE_SHAPE_FIELD(PEL_COMPARE_)
#undef PEL_COMPARE_
    return "";
}

}  // namespace

std::string warningsOf(const ShaderState& given, const ShaderState& state, uint32_t features) {
    std::string all;
    const auto warn = [&](auto&&... parts) { all += (all.empty() ? "" : "\n") + text(parts...); };
    const bool map = std::any_of(state.lights.begin(), state.lights.end(),
                                 [](const ShaderLight& l) { return bool(l.images[PEL_LIGHT_SHADOW_MAP]); });
    const bool thickness = bool(state.images[PEL_SLOT_THICKNESS]);
    if (const auto tables =
            std::ranges::find_if(state.materials, [](auto& m) { return !readsIrradiance(m.second); });
        tables != state.materials.end())
        for (size_t i = 0; i < given.lights.size(); ++i) {
            const ShaderLight& light = given.lights[i];
            const bool unshadowed = light.images[PEL_LIGHT_SHADOW_MAP] &&
                                    !light.images[PEL_LIGHT_WIDE_SHADOW] &&
                                    light.params.shadowFilterTexels == 0;
            // A map used only for thickness is no mistake, unless other materials get a shadow from it.
            const bool useful =
                (features & PEL_FEATURE_THICKNESS_TAPS) && !(features & PEL_FEATURE_MAKE_IRRADIANCE);
            if (unshadowed && !useful)
                warn("material ", tables->first,
                     " scatters by \"preintegrated\" and gets no shadow from the map ", "of light ", i,
                     ", whose shadowFilterTexels is 0; 4 to 256 would be right, 48 is the default");
        }
    if (state.images[PEL_SLOT_SKIN] && !usesSkinMaps(state))
        warn("the skin image is without effect: no material has a profile of pelProfileCreateSkinLayers");
    if (state.options.historyWeight > 0 && !anyMaterial(state, scattersByTaps))
        warn("historyWeight is without effect: no material scatters by taps");
    for (const auto& [id, material] : state.materials) {
        const PelMaterial& m = material.params;
        if (!isBlack(m.deepScatterColor) && !state.lights.empty() && !thickness && !(map && m.thicknessTaps))
            warn("material ", id,
                 " has a deepScatterColor without effect: there is neither a thickness image nor a light "
                 "with a shadow map and thicknessTaps above 0");
        if (material.curvatureLut && !state.lights.empty() && !state.images[PEL_SLOT_CURVATURE])
            warn("material ", id, " has a curvature table without effect: there is no curvature image");
        if (const std::string idle = withoutEffect(material); !idle.empty())
            warn("material ", id, " has ", idle, " without effect: it scatters by \"",
                 scatteringName(material.given.scattering), "\"",
                 m.scattering == material.given.scattering
                     ? ""
                     : text(", here \"", scatteringName(m.scattering), "\""),
                 " (docs/guide/methods.md, \"Controls\")");
        if (material.eye && !material.eye->ownCaustics) {
            const ShaderEye& eye = *material.eye;
            const PelLutInfo& table = eye.caustics->info();
            if (const std::string other = otherShape(table.eye, eye.params); !other.empty())
                warn("material ", id, " has the caustic table of another eye: ", other);
            if (eye.irisProfile && eye.irisProfile->name() != table.profile)
                warn("material ", id,
                     " has an irisProfile without effect: its caustic table was made with \"", table.profile,
                     "\" instead of \"", eye.irisProfile->name(), "\"");
        }
        if (scattersByTaps(material) &&
            std::ranges::equal(state.camera.inverseViewProjection, pelCameraDefaults().inverseViewProjection))
            warn("material ", id,
                 " scatters by taps, placed by PelCamera.inverseViewProjection, which is the default");
        const bool summed = m.scattering == PEL_SCATTERING_SCREEN || m.scattering == PEL_SCATTERING_LIGHT;
        if (summed && material.gain[0] > 0 && state.camera.inverseViewProjection[14] == 0 &&
            std::ranges::all_of(state.camera.position, [](float v) { return v == 0; }))
            warn("material ", id,
                 " scatters less accurately on curved parts, because it is not known from where they are "
                 "seen: set PelCamera.position, for a parallel view to a point far behind the camera");
        if (m.scattering == PEL_SCATTERING_LIGHT && !lightIsMapped(state))
            warn("material ", id,
                 " scatters by \"light\", but not all light comes from shadow maps: ambient light and lights "
                 "without a map are summed over the screen, as by \"screen\"; give every light a shadow map "
                 "and remove ambient light to avoid this");
        if (!material.profile) continue;
        const bool byMap = (features & PEL_FEATURE_TRANSMISSION) && !thickness && m.transmission != 0;
        // Another radius than the profile's own stretches its reach too.
        const double reach = material.profile->reach() * m.diffusionRadius / material.profile->radius();
        for (size_t i = 0; i < state.lights.size(); ++i) {
            const MapLengths map = lengthsOf(state.lights[i]);
            if (map.texel > reach && (byMap || summed))
                warn("a texel of the shadow map of light ", i, " is ", map.texel,
                     " wide, but light travels only ", reach, " in material ", id,
                     ": light through thin parts is inaccurate; use a finer map, or check that "
                     "millimetresPerUnit is ",
                     state.options.millimetresPerUnit);
            if (map.span > 0 &&
                map.span < std::min(leastReaches * reach, fingertip / state.options.millimetresPerUnit))
                warn("the shadow map of light ", i, " spans ", map.span, ", but light travels ", reach,
                     " in material ", id,
                     ", too far for an object of that size: check PelShaderOptions.millimetresPerUnit (",
                     state.options.millimetresPerUnit, ")");
        }
    }
    return all;
}

}  // namespace pel
