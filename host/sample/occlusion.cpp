#include "sample/occlusion.h"

namespace pellucid::sample {

constexpr int pattern = 4;             // pixels along a side
constexpr double normalOffset = 0.05;  // mm from the surface: vertex normals differ from the triangles'
constexpr double facetOffset = 0.3;    // facets at a slant to the light throw no shadow on their neighbours
constexpr double hairReach = 25;       // mm: further away, single hairs throw no shadow that shows
constexpr double alikeNormal = 0.8;    // cosine
constexpr double alikeHeight = 0.5;    // mm above or below the tangent plane

namespace {

Vec3 across(Vec3 n) {
    return normalize(std::abs(n.x) < 0.5 ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0}));
}

// The point of the unit disk in this direction, at the radius that encloses this share of the area.
std::array<double, 2> onDisk(double area, double turns) {
    const double radius = std::sqrt(area), angle = 2 * std::numbers::pi * turns;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

// A direction about `n` whose projection to the surface is (x, y) of the unit disk.
Vec3 above(Vec3 n, double x, double y) {
    return across(n) * x + cross(n, across(n)) * y + n * std::sqrt(std::max(0.0, 1 - x * x - y * y));
}

// Whether a pixel shows the surface about the place `p` with the normal `n`.
bool isAlike(const GBuffer& g, int x, int y, Vec3 p, Vec3 n) {
    return g.coverage.at(0, x, y) != 0 && dot(n, vectorAt(g.geometricNormal, x, y)) >= alikeNormal &&
           std::abs(dot(n, vectorAt(g.position, x, y) - p)) <= alikeHeight;
}

// Means over rays of similar pixels of a pattern; `empty` where no ray is above the horizon. Each ray starts
// `offset` from the surface in directionAt(normal, x, y), (x, y) in the unit disk; addTo(sum, ray, step) adds
// the light of the ray with this number in the pattern. All pixels of the pattern share a set of points:
// equal steps of the area, golden azimuths.
template <int Planes, class DirectionAt, class AddTo>
Image meanOverRays(const GBuffer& g, int rays, double offset, float empty, DirectionAt&& directionAt,
                   AddTo&& addTo) {
    if (rays < 1) throw std::invalid_argument("occlusion: at least one ray per pixel is needed");
    using Sum = std::array<float, Planes>;
    Image own(g.width, g.height, Planes + 1), mean(g.width, g.height, Planes, empty);  // and how many rays
    const auto isBackground = [&](int x, int y) { return g.coverage.at(0, x, y) == 0; };
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x) {
            Sum sum{};
            for (int i = 0; i < rays && !isBackground(x, y); ++i) {
                const Vec3 p = vectorAt(g.position, x, y), n = vectorAt(g.geometricNormal, x, y);
                const int step = i * pattern * pattern + x % pattern + pattern * (y % pattern);
                const auto at = onDisk((step + 0.5) / (pattern * pattern * rays),
                                       std::fmod(step / std::numbers::phi, 1.0));
                const Vec3 d = directionAt(n, at[0], at[1]);
                if (dot(n, d) <= 0) continue;
                addTo(sum, Ray{p + n * offset, d}, step);
                own.at(Planes, x, y) += 1;
            }
            for (int k = 0; k < Planes; ++k) own.at(k, x, y) = sum[size_t(k)];
        }
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x) {
            if (isBackground(x, y)) continue;
            const Vec3 p = vectorAt(g.position, x, y), n = vectorAt(g.geometricNormal, x, y);
            std::array<float, Planes + 1> sum{};
            for (int v = y - pattern / 2; v < y + pattern / 2; ++v)
                for (int u = x - pattern / 2; u < x + pattern / 2; ++u) {
                    if (u < 0 || v < 0 || u >= g.width || v >= g.height || !isAlike(g, u, v, p, n)) continue;
                    for (int k = 0; k <= Planes; ++k) sum[size_t(k)] += own.at(k, u, v);
                }
            for (int k = 0; k < Planes && sum[Planes] > 0; ++k)
                mean.at(k, x, y) = sum[size_t(k)] / sum[Planes];
        }
    return mean;
}

bool meetsHair(const Scene* hair, const Ray& ray, double within = INFINITY) {
    return hair && hair->occluded(ray, std::min(within, hairReach));
}

// The share of rays that hit nothing; 1 where there are none.
template <class DirectionAt>
Image unoccluded(const Scene& scene, const Scene* hair, const GBuffer& g, int rays, double offset,
                 DirectionAt&& directionAt) {
    return meanOverRays<1>(g, rays, offset, 1, directionAt,
                           [&](std::array<float, 1>& sum, const Ray& ray, int) {
                               sum[0] += !meetsHair(hair, ray) && !scene.occluded(ray, INFINITY);
                           });
}

// Light that comes back along a ray after one to three reflections.
Rgb reflectedLight(const Scene& scene, const Bounces& b, const Lighting& lamps, Ray ray, int step) {
    constexpr int most = 3;
    Rgb sum{}, part{1, 1, 1};
    for (int bounce = 0; bounce <= most; ++bounce) {
        Vec3 n;
        const Hit hit = scene.firstHit(ray, INFINITY, n);
        if (meetsHair(b.hair, ray, hit.distance)) break;
        if (hit.triangle == Hit::none) {
            const Rgb sky = bounce ? b.sky.radiance(ray.direction) : Rgb{};
            for (size_t c = 0; c < 3; ++c) sum[c] += part[c] * sky[c];
            break;
        }
        if (bounce == most || dot(n, ray.direction) >= 0) break;  // the inside is dark
        const Rgb light = irradianceAt(scene, lamps, SurfacePoint{hit.triangle, hit.weights});
        for (size_t c = 0; c < 3; ++c) part[c] *= b.albedo[c], sum[c] += part[c] * light[c];
        // A sequence of low discrepancy, shifted for each bounce [Roberts 2018, "The unreasonable
        // effectiveness of quasirandom sequences"].
        const auto at = onDisk(std::fmod((step + 1) * 0.7548776662 + 0.5 * bounce, 1.0),
                               std::fmod((step + 1) * 0.5698402910, 1.0));
        ray = {ray.origin + ray.direction * hit.distance + n * normalOffset, above(n, at[0], at[1])};
    }
    return sum;
}

}  // namespace

Image ambientOcclusion(const Scene& scene, const GBuffer& g, int rays, const Scene* hair) {
    return unoccluded(scene, hair, g, rays, normalOffset, above);
}

Image softShadow(const Scene& scene, const GBuffer& g, Vec3 toLight, double radius, int rays,
                 const Scene* hair) {
    const Vec3 right = across(toLight) * radius, up = cross(toLight, right);
    return unoccluded(scene, hair, g, rays, facetOffset,
                      [&](Vec3, double x, double y) { return normalize(toLight + right * x + up * y); });
}

Image bouncedLight(const Scene& scene, const GBuffer& g, const Bounces& b) {
    const Lighting lamps{b.lamps, {}};
    return meanOverRays<3>(g, b.rays, normalOffset, 0, above,
                           [&](std::array<float, 3>& sum, const Ray& ray, int step) {
                               const Rgb light = reflectedLight(scene, b, lamps, ray, step);
                               for (size_t c = 0; c < 3; ++c) sum[c] += float(light[c]);
                           });
}

Image enlarged(const Image& image, const GBuffer& from, const GBuffer& to) {
    constexpr double least = 1e-3;  // of a pixel further away than the next
    Image out(to.width, to.height, image.channels);
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < to.height; ++y)
        for (int x = 0; x < to.width; ++x) {
            const double atX = (x + 0.5) * from.width / to.width - 0.5,
                         atY = (y + 0.5) * from.height / to.height - 0.5;
            const bool isBackground = to.coverage.at(0, x, y) == 0;
            const Vec3 p = vectorAt(to.position, x, y), n = vectorAt(to.geometricNormal, x, y);
            double sum = 0, nearest = INFINITY;
            int nearX = std::clamp(int(atX + 0.5), 0, from.width - 1),
                nearY = std::clamp(int(atY + 0.5), 0, from.height - 1);
            for (int v = std::max(0, int(atY) - 1); v < std::min(from.height, int(atY) + 3); ++v)
                for (int u = std::max(0, int(atX) - 1); u < std::min(from.width, int(atX) + 3); ++u) {
                    if (isBackground || from.coverage.at(0, u, v) == 0) continue;
                    if (isAlike(from, u, v, p, n)) {
                        const double share =
                            std::max(least, 1 - std::abs(u - atX)) * std::max(least, 1 - std::abs(v - atY));
                        sum += share;
                        for (int c = 0; c < image.channels; ++c)
                            out.at(c, x, y) += float(share) * image.at(c, u, v);
                    } else if (const double away = length(vectorAt(from.position, u, v) - p); away < nearest)
                        nearest = away, nearX = u, nearY = v;
                }
            for (int c = 0; c < image.channels; ++c)
                out.at(c, x, y) = sum > 0 ? out.at(c, x, y) / float(sum) : image.at(c, nearX, nearY);
        }
    return out;
}

}  // namespace pellucid::sample
