// Checks of a light's shadow map at commit: form, images, and the fields that they need.
#include <cmath>

#include "shading/check_settings.h"

namespace pel {
namespace {

void checkCube(const ShaderLight& light, const std::string& name) {
    const PelLight& l = light.params;
    if (l.type == PEL_LIGHT_DIRECTIONAL)
        invalidArgument(
            name,
            ".shadowProjection is a cube, and its type directional: cubes are for point and spot lights");
    const ImageView& map = light.images[PEL_LIGHT_SHADOW_MAP];
    if (map.height != 6 * uint64_t(map.width))
        invalidArgument("the shadow map of ", name, " is ", map.width, " x ", map.height,
                        "; a cube of this width is ", map.width, " x ", 6 * map.width,
                        ": six square faces, one below the other, +x -x +y -y +z -z");
    const float* m = l.worldToShadow;
    double largest = 0;
    for (int r = 0; r < 3; ++r) {
        double at = m[4 * r + 3];
        for (int c = 0; c < 3; ++c)
            at += double(m[4 * r + c]) * l.position[c],
                largest = std::max(largest, std::abs(double(l.position[c])));
        if (!(std::abs(at) <= 1e-3 * std::max(1.0, largest)))
            invalidArgument(name, ".worldToShadow takes the light's position to a place where component ", r,
                            " is ", at, "; a cube has its light in the origin");
        for (int q = 0; q <= r; ++q) {
            double dot = 0;
            for (int c = 0; c < 3; ++c) dot += double(m[4 * r + c]) * m[4 * q + c];
            if (!(std::abs(dot - (q == r)) < 1e-3))
                invalidArgument(name, ".worldToShadow stretches or shears (rows ", q, " and ", r,
                                " have the product ", dot,
                                "); a cube needs a rotation and the light in the origin");
        }
    }
    if (l.shadowProjection == PEL_SHADOW_CUBE && l.shadowDepthA == 0)
        invalidArgument(
            name,
            ".shadowDepthA is 0: A and B of distance = 1 / (A z + B) along the axis of a face are needed; "
            "PEL_SHADOW_CUBE_RADIAL is for distances from the light");
    if (l.shadowProjection == PEL_SHADOW_CUBE_RADIAL && !(l.shadowDepthRange > 0))
        invalidArgument(name, ".shadowDepthRange is ", l.shadowDepthRange,
                        ": the distance from the light at depth 1 is needed, above 0");
}

void checkCascades(const ShaderLight& light, const std::string& name) {
    const PelLight& l = light.params;
    if (l.type != PEL_LIGHT_DIRECTIONAL || l.shadowProjection != PEL_SHADOW_PARALLEL)
        invalidArgument(name, ".shadowCascades is ", l.shadowCascades,
                        "; cascades are parallel maps of directional lights, and this is another kind of "
                        "light or projection");
    for (uint32_t i = 0; i < l.shadowCascades; ++i) {
        const ShadowCascade c = shadowCascade(light, i);
        const std::string matrix = i ? text("cascadeToShadow[", i - 1, "]") : "worldToShadow";
        if (!*c.map)
            invalidArgument(name, ".shadowCascades is ", l.shadowCascades, ", and its image ",
                            lightSlotName(PelLightSlot(PEL_LIGHT_CASCADE_1 + i - 1)), " is not set");
        checkFinite(name.c_str(), matrix.c_str(), *c.worldToShadow, 16);
        const std::string range = i ? text("cascadeDepthRange[", i - 1, "]") : "shadowDepthRange";
        checkFinite(name.c_str(), range.c_str(), &c.depthRange, 1);
        if (c.depthRange == 0 || (c.depthRange < 0) != (l.shadowDepthRange < 0))
            invalidArgument(name, ".", range, " is ", c.depthRange,
                            ": the length that depths 0 to 1 span is needed, of one sign for all cascades");
        const float* m = *c.worldToShadow;
        double volume = 0;  // what a unit cube becomes
        for (int k = 0; k < 3; ++k) {
            const int p = (k + 1) % 3, q = (k + 2) % 3;
            volume += m[k] * (double(m[4 + p]) * m[8 + q] - double(m[4 + q]) * m[8 + p]);
        }
        if (!(std::abs(volume) > 0) || m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] == 0)
            invalidArgument(name, ".", matrix,
                            " is singular or no parallel projection (row 3 must be 0, 0, 0 and not 0): each "
                            "cascade needs "
                            "its own world to (u, v, z)");
    }
}

void checkContent(const ShaderLight& light, const std::string& name) {
    const PelLight& l = light.params;
    const ImageView& map = light.images[PEL_LIGHT_SHADOW_MAP];
    if (l.shadowContent == PEL_SHADOW_CONTENT_MOMENTS && map.info().components < 2)
        invalidArgument("the shadow map of ", name, " has format ", map.info().name,
                        "; PEL_SHADOW_CONTENT_MOMENTS needs two components, the means of z and of z^2");
    if (l.shadowContent != PEL_SHADOW_CONTENT_EXPONENTIAL) return;
    const bool nearness =
        l.shadowProjection == PEL_SHADOW_PERSPECTIVE || l.shadowProjection == PEL_SHADOW_CUBE;
    const float growth = nearness ? -l.shadowDepthA : l.shadowDepthRange;
    if (!std::isfinite(l.shadowExponent) || !(l.shadowExponent * growth > 0) ||
        std::abs(l.shadowExponent) > 1e4f)
        invalidArgument(name, ".shadowExponent is ", l.shadowExponent,
                        "; exponential maps need c of exp(c z), ", growth > 0 ? "above" : "below",
                        " 0 here so that c z grows away from the light, such as ", growth > 0 ? "80" : "-80");
}

}  // namespace

void checkLightMap(const ShaderLight& light, uint32_t index) {
    const PelLight& l = light.params;
    const std::string name = text("PelLight ", index);
    checkFinite(name.c_str(), "worldToShadow", l.worldToShadow, 16);
    checkFinite(name.c_str(), "shadowDepthRange", &l.shadowDepthRange, 1);
    checkFinite(name.c_str(), "shadowDepthA", &l.shadowDepthA, 1);
    checkFinite(name.c_str(), "shadowDepthB", &l.shadowDepthB, 1);
    if (l.shadowCascades) checkCascades(light, name);
    if (l.shadowProjection == PEL_SHADOW_PARALLEL && l.shadowDepthRange == 0)
        invalidArgument(name, ".shadowDepthRange is 0: the length that depths 0 to 1 span is needed");
    if (l.shadowProjection == PEL_SHADOW_PERSPECTIVE && l.shadowDepthA == 0)
        invalidArgument(name, ".shadowDepthA is 0: A and B of distance = 1 / (A z + B) are needed");
    if (isCube(l)) checkCube(light, name);
    checkContent(light, name);
}

}  // namespace pel
