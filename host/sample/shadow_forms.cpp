#include "sample/shadow_forms.h"

#include <algorithm>
#include <stdexcept>

#include "sample/trace.h"

namespace pellucid::sample {
namespace {

// Away from the light, along u, along v. [OpenGL 4.6, table 8.19]
constexpr Vec3 faces[6][3] = {{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                              {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},   {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                              {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}};

}  // namespace

CubeShadowMap renderCubeShadowMap(const Scene& scene, Vec3 light, int size) {
    if (size < 0)
        throw std::invalid_argument("cube shadow map: a size of " + std::to_string(size) +
                                    "; it must be 0 or more");
    CubeShadowMap map;
    map.size = size;
    map.depth.assign(size_t(6) * size_t(size) * size_t(size), 1.0f);
    map.worldToCube = Matrix4::fromRows({1, 0, 0}, -light.x, {0, 1, 0}, -light.y, {0, 0, 1}, -light.z);
    double farPlane = 1e-3;
    for (int i = 0; i < 8 && !scene.bounds().empty(); ++i)
        farPlane = std::max(farPlane, 1.01 * length(scene.bounds().corner(i) - light));
    // The nearest place of the box.
    const auto outside = [](double v, double low, double high) { return std::max({low - v, 0.0, v - high}); };
    const Bounds& box = scene.bounds();
    const Vec3 gap{outside(light.x, box.low.x, box.high.x), outside(light.y, box.low.y, box.high.y),
                   outside(light.z, box.low.z, box.high.z)};
    // Along an axis it may be nearer than that by the root of 3.
    const double nearPlane = std::clamp(0.99 * length(gap) / std::sqrt(3.0), 1e-3 * farPlane, 0.9 * farPlane);
    map.depthA = -(farPlane - nearPlane) / (nearPlane * farPlane);
    map.depthB = 1 / nearPlane;
    traceRays(
        scene, size, 6 * size,
        [&](int x, int y) {
            const auto& [axis, u, v] = faces[y / size];
            const Vec3 direction =
                axis + u * ((2 * x + 1.0) / size - 1) + v * ((2 * (y % size) + 1.0) / size - 1);
            return Ray{light + direction * nearPlane, normalize(direction)};
        },
        [&](int x, int y, const Ray& ray, const Hit& hit) {
            const double along = nearPlane + hit.distance * dot(ray.direction, faces[y / size][0]);
            const double z = (1 / along - map.depthB) / map.depthA;
            map.depth[size_t(y) * size_t(size) + size_t(x)] = float(std::clamp(z, 0.0, 1.0));
        });
    return map;
}

std::vector<ShadowMap> renderCascades(const Scene& scene, const DirectionalLight& light, Vec3 focus,
                                      const std::vector<double>& extents, int size) {
    std::vector<ShadowMap> maps;
    for (const double extent : extents) {
        ShadowMap map = renderShadowMap(scene, light, 0);  // its axes and depth range
        map.size = size;
        map.depth.assign(size_t(size) * size_t(size), 1.0f);
        map.extent = extent;
        const double u = dot(focus, map.right), v = dot(focus, map.down);
        map.worldToUvz = Matrix4::fromRows(
            map.right * (1 / extent), 0.5 - u / extent, map.down * (1 / extent), 0.5 - v / extent,
            map.forward * (1 / map.depthRange), -map.nearDistance / map.depthRange);
        traceRays(
            scene, size, size,
            [&](int x, int y) {
                return Ray{map.right * (u + ((x + 0.5) / size - 0.5) * extent) +
                               map.down * (v + ((y + 0.5) / size - 0.5) * extent) +
                               map.forward * map.nearDistance,
                           map.forward};
            },
            [&](int x, int y, const Ray&, const Hit& hit) {
                map.depth[size_t(y) * size_t(size) + size_t(x)] =
                    float(std::clamp(hit.distance / map.depthRange, 0.0, 1.0));
            });
        maps.push_back(std::move(map));
    }
    return maps;
}

}  // namespace pellucid::sample
