#include "shading/wide_shadow_constants.h"

#include <algorithm>
#include <cmath>

#include "shading/shading_constants.h"

namespace pel {

PelWideShadow describeWideShadow(const ShaderLight& light, uint32_t index, uint32_t cascade) {
    const PelLight& l = light.params;
    const ShadowCascade from = shadowCascade(light, cascade);
    const float(&matrix)[16] = *from.worldToShadow;
    PelWideShadow to{};
    std::copy_n(matrix, 16, to.worldToShadow);
    to.projection = l.shadowProjection;
    to.depthA = l.shadowDepthA;
    to.depthB = l.shadowDepthB;
    to.depthRange = from.depthRange;
    to.exponent = float(l.shadowExponent / std::log(2.0));
    if (l.shadowExponent != 0) to.perExponent = float(std::log(2.0) / l.shadowExponent);
    to.minDeviation = l.shadowMinDeviation;
    to.bleeding = l.shadowBleeding;
    to.bias = l.shadowBias;
    to.softness = l.shadowSoftness;
    to.coneSlope = l.shadowConeSlope;
    to.maxTexels = float(l.shadowFilterTexels);
    to.cascades = l.shadowCascades;
    to.map = describeImage(*from.map);
    to.out = describeImage(light.images[PEL_LIGHT_WIDE_SHADOW]);
    if (isCube(l)) return to;
    struct Vec {
        double x, y, z;
        Vec scaled(double s) const { return {x * s, y * s, z * s}; }
        Vec minus(Vec b) const { return {x - b.x, y - b.y, z - b.z}; }
        double dot(Vec b) const { return x * b.x + y * b.y + z * b.z; }
        Vec cross(Vec b) const { return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x}; }
        double length() const { return std::sqrt(dot(*this)); }
        void to(float (&out)[3]) const { out[0] = float(x), out[1] = float(y), out[2] = float(z); }
    };
    const auto row = [&](int r) {
        const float* m = matrix + 4 * r;
        return Vec{m[0], m[1], m[2]};
    };
    const bool perspective = l.shadowProjection == PEL_SHADOW_PERSPECTIVE;
    const double w = perspective ? row(3).length() : matrix[15];
    // Along a ray of the light u and v do not change; across it they grow by 1 / extent per length.
    Vec forward = perspective ? row(3).scaled(1 / w) : row(0).cross(row(1));
    if (!perspective) {
        const double length = forward.length(), sign = row(2).dot(forward) * w * from.depthRange < 0 ? -1 : 1;
        forward = forward.scaled(sign / length);
        to.zPerLength = float(row(2).dot(forward) / w);
    }
    const Vec right = row(0).minus(forward.scaled(row(0).dot(forward))),
              down = row(1).minus(forward.scaled(row(1).dot(forward)));
    const double u = right.length(), v = down.length(), skew = right.dot(down) / (u * v);
    if (!(u > 0 && v > 0 && std::isfinite(forward.length()) && std::abs(skew) < 0.999 &&
          (perspective || to.zPerLength != 0)))
        invalidArgument("PelLight ", index,
                        cascade ? text(".cascadeToShadow[", cascade - 1, "]") : ".worldToShadow",
                        " is singular: a wide shadow cannot be filtered from its shadow map");
    right.scaled(1 / u).to(to.right);
    down.scaled(1 / v).to(to.down);
    forward.to(to.forward);
    to.extent[0] = float(std::abs(w) / u);
    to.extent[1] = float(std::abs(w) / v);
    to.centre[0] = float(row(0).dot(forward) / w);
    to.centre[1] = float(row(1).dot(forward) / w);
    return to;
}

}  // namespace pel
