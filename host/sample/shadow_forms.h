// Depth maps of other forms than one plain map: six faces round a point light, cascades of a directional one.
#pragma once
#include "sample/shadow_map.h"

namespace pellucid::sample {

// Six square faces, +x -x +y -y +z -z, one below the other, each laid out as OpenGL has it. Distance along
// the axis of a face = 1 / (depthA * z + depthB).
struct CubeShadowMap {
    int size = 0;              // texels a side of a face
    std::vector<float> depth;  // 6 * size * size, z in [0, 1]; 1 where nothing was hit
    Matrix4 worldToCube;       // the light in the origin
    double depthA = 0;         // 1/mm
    double depthB = 0;         // 1/mm
};
// Near and far plane are fitted to the scene; what is nearer than a thousandth of the far plane is not seen.
// Throws std::invalid_argument for a negative size.
CubeShadowMap renderCubeShadowMap(const Scene& scene, Vec3 light, int size);

// One map per extent (mm that it spans a side), about `focus`, as deep as the scene.
std::vector<ShadowMap> renderCascades(const Scene& scene, const DirectionalLight& light, Vec3 focus,
                                      const std::vector<double>& extents, int size);

}  // namespace pellucid::sample
