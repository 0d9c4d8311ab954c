// Warnings of a commit: settings that can be shaded but are probably not intended (pelShaderGetWarnings).
#include <algorithm>
#include <cmath>

#include "shading/features.h"
#include "shading/image_slots.h"
#include "shading/mapped_lights.h"
#include "shading/material.h"

namespace pel {
namespace {

// Length of the longer side of a texel of a parallel map; 0 for others, whose texels grow with distance.
double texelLength(const PelLight& l, const ImageView& map) {
    if (l.shadowProjection != PEL_SHADOW_PARALLEL || !map) return 0;
    double longest = 0;
    for (int row = 0; row < 2; ++row) {
        const float* m = l.worldToShadow + 4 * row;
        const double perLength =
            std::hypot(double(m[0]), double(m[1]), double(m[2])) / std::abs(double(l.worldToShadow[15]));
        if (perLength > 0) longest = std::max(longest, 1 / (perLength * (row ? map.height : map.width)));
    }
    return longest;
}

bool isBlackColor(const float (&c)[3]) {
    return c[0] == 0 && c[1] == 0 && c[2] == 0;
}

// What is set and does nothing by the method that the material takes; "" if nothing is.
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
    add(stays && !isBlackColor(m.borderColor), "borderColor");
    add(stays && m.albedoBefore > 0, "albedoBefore");
    add(!tables && m.curvatureGain != 0, "curvatureGain");
    return names;
}

}  // namespace

std::string warningsOf(const ShaderState&, const ShaderState& state, uint32_t features) {
    std::string all;
    const auto warn = [&](auto&&... parts) { all += (all.empty() ? "" : "\n") + text(parts...); };
    const bool map = std::any_of(state.lights.begin(), state.lights.end(),
                                 [](const ShaderLight& l) { return bool(l.images[PEL_LIGHT_SHADOW_MAP]); });
    const bool thickness = bool(state.images[PEL_SLOT_THICKNESS]);
    for (const auto& [id, material] : state.materials) {
        const PelMaterial& m = material.params;
        if (!isBlackColor(m.deepScatterColor) && !state.lights.empty() && !thickness && !(map && m.thicknessTaps))
            warn("material ", id,
                 " has a deepScatterColor without effect: there is neither a thickness image nor a light "
                 "with a "
                 "shadow map and thicknessTaps above 0");
        if (material.curvatureLut && !state.lights.empty() && !state.images[PEL_SLOT_CURVATURE])
            warn("material ", id, " has a curvature table without effect: there is no curvature image");
        if (const std::string idle = withoutEffect(material); !idle.empty())
            warn("material ", id, " has ", idle, " without effect: it scatters by \"",
                 scatteringName(m.scattering), "\" (docs/guide/methods.md, \"Controls\")");
        if (m.scattering == PEL_SCATTERING_LIGHT && !lightIsMapped(state))
            warn("material ", id,
                 " asks for PelMaterial.scattering light, and shadow maps do not hold all light: what lights "
                 "without a map "
                 "and ambient light give is summed over the screen, as by screen; a shadow map for every "
                 "light and no "
                 "ambient light would be right");
        if (!(features & PEL_FEATURE_TRANSMISSION) || thickness || !material.profile || m.transmission == 0)
            continue;
        const double reach = material.profile->reach() / state.options.millimetresPerUnit;
        for (size_t i = 0; i < state.lights.size(); ++i) {
            const double texel =
                texelLength(state.lights[i].params, state.lights[i].images[PEL_LIGHT_SHADOW_MAP]);
            if (texel > reach)
                warn("a texel of the shadow map of light ", i, " is ", texel, " long, and light reaches ",
                     reach, " far in material ", id,
                     ": what comes through thin parts is guessed; a finer map is needed, or "
                     "millimetresPerUnit is not ",
                     state.options.millimetresPerUnit);
        }
    }
    return all;
}

}  // namespace pel
