// Depth maps seen from a light.
#pragma once
#include "sample/scene.h"

namespace pellucid::sample {

struct DirectionalLight {
    Vec3 toLight{0, 0, 1};  // unit
};

struct SpotLight {
    Vec3 position;             // mm
    Vec3 direction{0, 0, -1};  // unit, the way the light looks
    double outerAngle = 20;    // degrees from the axis to the cone's edge; the map's square encloses the cone
};

enum class ShadowProjection { Parallel, Perspective };

struct ShadowMap {
    int size = 0;              // texels a side; row 0 at v = 0
    std::vector<float> depth;  // size * size, z in [0, 1]; 1 where nothing was hit
    ShadowProjection projection = ShadowProjection::Parallel;
    // World to homogeneous (u, v, z); texel centres at ((x + 1/2) / size, (y + 1/2) / size)
    Matrix4 worldToUvz;
    Vec3 right, down, forward;  // unit, world: along +u, along +v, away from the light
    double extent = 0;          // mm that the map spans a side; perspective: at distance 1 mm
    // Parallel: distance = nearDistance + z * depthRange, from the plane through the origin across the light.
    double nearDistance = 0;  // mm
    double depthRange = 0;    // mm
    // Perspective: distance = 1 / (depthA * z + depthB), along the axis from the light.
    double depthA = 0;  // 1/mm
    double depthB = 0;  // 1/mm

    double distance(double z) const;  // mm along the axis
};

// The map encloses the scene with `margin` mm to spare. Throws std::invalid_argument for a negative size.
ShadowMap renderShadowMap(const Scene& scene, const DirectionalLight& light, int size, double margin = 1);
// Near and far plane are fitted to the scene; the near plane is at least a thousandth of the far plane.
ShadowMap renderShadowMap(const Scene& scene, const SpotLight& light, int size);

}  // namespace pellucid::sample
