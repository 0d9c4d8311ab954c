#include "sample/shadow_map.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace pellucid::sample {
namespace {

ShadowMap emptyMap(ShadowProjection projection, Vec3 forward, int size) {
    if (size < 0)
        throw std::invalid_argument("shadow map: a size of " + std::to_string(size) +
                                    "; it must be 0 or more");
    ShadowMap map;
    map.size = size;
    map.depth.assign(size_t(size) * size_t(size), 1.0f);
    map.projection = projection;
    map.forward = normalize(forward);
    map.down = -perpendicular(map.forward, {0, 0, 1});
    map.right = cross(map.down, map.forward);
    return map;
}

// rayAt(u, v) starts on the near side; zAt(ray, hit) is the depth that the map stores.
template <class RayAt, class ZAt>
void trace(const Scene& scene, ShadowMap& map, RayAt rayAt, ZAt zAt) {
    traceRays(
        scene, map.size, map.size,
        [&](int x, int y) { return rayAt((x + 0.5) / map.size, (y + 0.5) / map.size); },
        [&](int x, int y, const Ray& ray, const Hit& hit) {
            map.depth[size_t(y) * size_t(map.size) + size_t(x)] = float(std::clamp(zAt(ray, hit), 0.0, 1.0));
        });
}

}  // namespace

double ShadowMap::distance(double z) const {
    return projection == ShadowProjection::Parallel ? nearDistance + z * depthRange
                                                    : 1 / (depthA * z + depthB);
}

ShadowMap renderShadowMap(const Scene& scene, const DirectionalLight& light, int size, double margin) {
    ShadowMap map = emptyMap(ShadowProjection::Parallel, -light.toLight, size);
    Bounds seen;  // along right, down, forward
    for (int i = 0; i < 8 && !scene.bounds().empty(); ++i) {
        const Vec3 p = scene.bounds().corner(i);
        seen.add({dot(p, map.right), dot(p, map.down), dot(p, map.forward)});
    }
    if (seen.empty()) seen.add({});
    if (!(margin > 0)) margin = 1e-3;
    const Vec3 centre = seen.centre();
    map.extent = std::max(seen.high.x - seen.low.x, seen.high.y - seen.low.y) + 2 * margin;
    map.nearDistance = seen.low.z - margin;
    map.depthRange = seen.high.z - seen.low.z + 2 * margin;
    map.worldToUvz = Matrix4::fromRows(
        map.right * (1 / map.extent), 0.5 - centre.x / map.extent, map.down * (1 / map.extent),
        0.5 - centre.y / map.extent, map.forward * (1 / map.depthRange), -map.nearDistance / map.depthRange);
    trace(
        scene, map,
        [&](double u, double v) {
            return Ray{map.right * (centre.x + (u - 0.5) * map.extent) +
                           map.down * (centre.y + (v - 0.5) * map.extent) + map.forward * map.nearDistance,
                       map.forward};
        },
        [&](const Ray&, const Hit& hit) { return hit.distance / map.depthRange; });
    return map;
}

ShadowMap renderShadowMap(const Scene& scene, const SpotLight& light, int size) {
    ShadowMap map = emptyMap(ShadowProjection::Perspective, light.direction, size);
    double farPlane = 1e-3, nearPlane = INFINITY;
    for (int i = 0; i < 8 && !scene.bounds().empty(); ++i) {
        const double d = dot(scene.bounds().corner(i) - light.position, map.forward);
        farPlane = std::max(farPlane, 1.01 * d);
        nearPlane = std::min(nearPlane, 0.99 * d);
    }
    nearPlane = std::clamp(nearPlane, 1e-3 * farPlane, 0.9 * farPlane);
    const double half = std::tan(light.outerAngle * std::numbers::pi / 180), range = farPlane - nearPlane;
    map.extent = 2 * half;
    map.depthA = -range / (nearPlane * farPlane);
    map.depthB = 1 / nearPlane;
    const auto row = [&](Vec3 axis, double offset) {
        return std::pair(axis, -dot(axis, light.position) + offset);
    };
    const auto [u, uw] = row(map.right * (1 / map.extent) + map.forward * 0.5, 0);
    const auto [v, vw] = row(map.down * (1 / map.extent) + map.forward * 0.5, 0);
    const auto [z, zw] = row(map.forward * (farPlane / range), -nearPlane * farPlane / range);
    const auto [w, ww] = row(map.forward, 0);
    map.worldToUvz = Matrix4::fromRows(u, uw, v, vw, z, zw, w, ww);
    trace(
        scene, map,
        [&](double tu, double tv) {
            const Vec3 direction =
                map.forward + map.right * ((tu - 0.5) * map.extent) + map.down * ((tv - 0.5) * map.extent);
            // From the near plane on: surfaces closer to the light cast no shadow.
            return Ray{light.position + direction * nearPlane, normalize(direction)};
        },
        [&](const Ray& ray, const Hit& hit) {
            const double d = nearPlane + hit.distance * dot(ray.direction, map.forward);
            return (1 / d - map.depthB) / map.depthA;
        });
    return map;
}

}  // namespace pellucid::sample
