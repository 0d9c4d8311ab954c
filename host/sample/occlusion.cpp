#include "sample/occlusion.h"

#include <numbers>
#include <stdexcept>

namespace pellucid::sample {

constexpr int pattern = 4;             // pixels along a side
constexpr double normalOffset = 0.05;  // mm from the surface, for the vertex normals lean from the triangles'
constexpr double facetOffset = 0.3;    // facets at a slant to the light throw no shadow on their neighbours
constexpr double hairReach = 25;       // mm: further away, single hairs throw no shadow that shows
constexpr double alikeNormal = 0.8;    // cosine
constexpr double alikeHeight = 0.5;    // mm above or below the tangent plane

namespace {

Vec3 across(Vec3 n) {
    return normalize(std::abs(n.x) < 0.5 ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0}));
}

// The share of rays that hit nothing, of those above their pixel's horizon, over similar pixels of a pattern;
// 1 where there are none. Each ray starts `offset` from the surface in directionAt(normal, x, y), (x, y) in
// the unit disk. Hair counts up to hairReach. All pixels of the pattern share a set of points: equal steps of
// the area, golden azimuths.
template <class DirectionAt>
Image unoccluded(const Scene& scene, const Scene* hair, const GBuffer& g, int rays, double offset,
                 DirectionAt&& directionAt) {
    if (rays < 1) throw std::invalid_argument("occlusion: at least one ray a pixel");
    Image own(g.width, g.height, 2), mean(g.width, g.height, 1, 1);  // own: clear ones, and those above
    const auto isBackground = [&](int x, int y) { return g.coverage.at(0, x, y) == 0; };
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x)
            for (int i = 0; i < rays && !isBackground(x, y); ++i) {
                const Vec3 p = vectorAt(g.position, x, y), n = vectorAt(g.geometricNormal, x, y);
                const double step = i * pattern * pattern + x % pattern + pattern * (y % pattern),
                             radius = std::sqrt((step + 0.5) / (pattern * pattern * rays)),
                             angle = 2 * std::numbers::pi * std::fmod(step / std::numbers::phi, 1.0);
                const Vec3 d = directionAt(n, radius * std::cos(angle), radius * std::sin(angle));
                if (dot(n, d) <= 0) continue;
                const Ray ray{p + n * offset, d};
                own.at(0, x, y) +=
                    !(hair && hair->occluded(ray, hairReach)) && !scene.occluded(ray, INFINITY);
                own.at(1, x, y) += 1;
            }
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x) {
            if (isBackground(x, y)) continue;
            const Vec3 p = vectorAt(g.position, x, y), n = vectorAt(g.geometricNormal, x, y);
            float sum = 0, count = 0;
            for (int v = y - pattern / 2; v < y + pattern / 2; ++v)
                for (int u = x - pattern / 2; u < x + pattern / 2; ++u) {
                    if (u < 0 || v < 0 || u >= g.width || v >= g.height || isBackground(u, v)) continue;
                    if (dot(n, vectorAt(g.geometricNormal, u, v)) < alikeNormal ||
                        std::abs(dot(n, vectorAt(g.position, u, v) - p)) > alikeHeight)
                        continue;
                    sum += own.at(0, u, v), count += own.at(1, u, v);
                }
            if (count > 0) mean.at(0, x, y) = sum / count;
        }
    return mean;
}

}  // namespace

Image ambientOcclusion(const Scene& scene, const GBuffer& g, int rays, const Scene* hair) {
    return unoccluded(scene, hair, g, rays, normalOffset, [](Vec3 n, double x, double y) {
        return across(n) * x + cross(n, across(n)) * y + n * std::sqrt(1 - x * x - y * y);
    });
}

Image softShadow(const Scene& scene, const GBuffer& g, Vec3 toLight, double radius, int rays,
                 const Scene* hair) {
    const Vec3 right = across(toLight) * radius, up = cross(toLight, right);
    return unoccluded(scene, hair, g, rays, facetOffset,
                      [&](Vec3, double x, double y) { return normalize(toLight + right * x + up * y); });
}

}  // namespace pellucid::sample
