#include "sample/occlusion.h"

#include <numbers>
#include <stdexcept>

namespace pellucid::sample {

constexpr int pattern = 4;           // pixels along a side
constexpr double offset = 0.05;      // mm from the surface, for the vertex normals lean from the triangles'
constexpr double alikeNormal = 0.8;  // cosine
constexpr double alikeHeight = 0.5;  // mm above or below the tangent plane

// The share of cosine-distributed rays from `p` that hit nothing. `k`: the place in the pattern.
static float unoccluded(const Scene& scene, Vec3 p, Vec3 n, int rays, int k) {
    const Vec3 across = normalize(std::abs(n.x) < 0.5 ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0})),
               along = cross(n, across);
    int clear = 0;
    for (int i = 0; i < rays; ++i) {
        // One set of points over all pixels of the pattern: equal steps of cosine squared, golden azimuths.
        const double step = i * pattern * pattern + k, height2 = (step + 0.5) / (pattern * pattern * rays),
                     angle = 2 * std::numbers::pi * std::fmod(step / std::numbers::phi, 1.0);
        const double side = std::sqrt(1 - height2);
        const Vec3 d =
            across * (side * std::cos(angle)) + along * (side * std::sin(angle)) + n * std::sqrt(height2);
        clear += !scene.occluded({p + n * offset, d}, INFINITY);
    }
    return float(clear) / float(rays);
}

Image ambientOcclusion(const Scene& scene, const GBuffer& g, int rays) {
    if (rays < 1) throw std::invalid_argument("ambientOcclusion: at least one ray a pixel");
    Image own(g.width, g.height, 1, 1), mean(g.width, g.height, 1, 1);
    const auto isBackground = [&](int x, int y) { return g.coverage.at(0, x, y) == 0; };
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x)
            if (!isBackground(x, y))
                own.at(0, x, y) =
                    unoccluded(scene, vectorAt(g.position, x, y), vectorAt(g.geometricNormal, x, y), rays,
                               x % pattern + pattern * (y % pattern));
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
                    sum += own.at(0, u, v), count += 1;
                }
            mean.at(0, x, y) = sum / count;
        }
    return mean;
}

}  // namespace pellucid::sample
