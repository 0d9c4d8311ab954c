#include "sample/wide_shadow.h"

#include <algorithm>
#include <numbers>

namespace pellucid::sample {

namespace {

constexpr double pi = std::numbers::pi;

// Below this cosine to the light the tangent plane is not followed any steeper: four times the sideways
// distance.
constexpr double flattestCosine = 0.25;

struct Tap {
    float x, y, r;  // in the unit disk
};

std::vector<Tap> makeTaps(int count) {
    std::vector<Tap> taps;
    const double golden = pi * (3 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
        const double outside = 1 - (i + 0.5) / count;
        double low = 0, high = 1;
        for (int step = 0; step < 40; ++step) {
            const double middle = 0.5 * (low + high);
            (wideFilterOutside(middle) > outside ? low : high) = middle;
        }
        taps.push_back({float(low * std::cos(i * golden)), float(low * std::sin(i * golden)), float(low)});
    }
    return taps;
}

// Depth of the receiver over the map: z + dzdx (x - x0) + dzdy (y - y0) in texels. Also for a perspective
// map: there z is affine in 1 / distance, and that is affine across a plane's image.
struct Receiver {
    float x, y, z, dzdx, dzdy;

    // Part of the bilinear footprint at (tx, ty) whose texels are not in front of the receiver.
    float lit(const ShadowMap& map, float tx, float ty, float bias) const {
        const float fx = std::floor(tx), fy = std::floor(ty), ax = tx - fx, ay = ty - fy;
        const int ix = int(fx), iy = int(fy);
        const float corner = z - bias + dzdx * (fx - x) + dzdy * (fy - y);
        const auto test = [&](int cx, int cy) {
            const int px = ix + cx, py = iy + cy;
            if (unsigned(px) >= unsigned(map.size) || unsigned(py) >= unsigned(map.size)) return 1.0f;
            const float receiver = corner + dzdx * float(cx) + dzdy * float(cy);
            return map.depth[size_t(py) * size_t(map.size) + size_t(px)] >= receiver ? 1.0f : 0.0f;
        };
        const float top = test(0, 0) * (1 - ax) + test(1, 0) * ax,
                    bottom = test(0, 1) * (1 - ax) + test(1, 1) * ax;
        return top * (1 - ay) + bottom * ay;
    }
};

float filterPixel(const ShadowMap& map, const std::vector<Tap>& taps, const WideShadowOptions& options,
                  Vec3 position, Vec3 normal) {
    const bool parallel = map.projection == ShadowProjection::Parallel;
    const auto lightSpace = [&](Vec3 p) {
        const auto h = map.worldToUvz.transformPoint(p);
        return Vec3{h[0] / h[3], h[1] / h[3], h[2] / h[3]};
    };
    // Towards the light, scaled so that it has length 1 along the map's axis.
    const auto toLight = [&](Vec3 uvz) {
        if (parallel) return -map.forward;
        return -(map.forward + map.right * ((uvz.x - 0.5) * map.extent) +
                 map.down * ((uvz.y - 0.5) * map.extent));
    };
    const double facing = dot(normal, normalize(toLight(lightSpace(position))));
    position = position + normal * (options.normalOffset * options.filterWidth * (1 - std::abs(facing)));

    const auto h = map.worldToUvz.transformPoint(position);
    if (!(h[3] > 0)) return 1;  // behind a spot light
    const Vec3 uvz = map.worldToUvz.project(position);
    const double distance = map.distance(uvz.z), zPerLength = map.zPerLength(distance);
    const double texel = map.lengthPerUv(distance) / map.size;
    const double cosine = dot(normal, toLight(uvz));
    // Followed to the limit on the lit side; past the terminator the tilt goes back to none.
    const double tilt = cosine > 0 ? 1 / std::max(cosine, flattestCosine)
                                   : std::max(0.0, 1 + cosine / flattestCosine) / flattestCosine;
    const double slope = tilt * texel * zPerLength;
    const Receiver receiver{float(uvz.x * map.size - 0.5), float(uvz.y * map.size - 0.5), float(uvz.z),
                            float(dot(normal, map.right) * slope), float(dot(normal, map.down) * slope)};
    const auto radius = float(0.5 * options.filterWidth / texel);
    const auto bias = float(options.depthBias * zPerLength);
    const auto cone = float(options.coneSlope * 0.5 * options.filterWidth * zPerLength);
    float sum = 0;
    for (const Tap& tap : taps)
        sum +=
            receiver.lit(map, receiver.x + radius * tap.x, receiver.y + radius * tap.y, bias + cone * tap.r);
    return sum / float(taps.size());
}

}  // namespace

double wideFilterDensity(double r) {
    const double t = std::max(0.0, 1 - r * r), root = std::sqrt(t);
    return (root / (1 + t) + std::atan(root)) / pi;
}

double wideFilterOutside(double r) {
    const double t = std::max(0.0, 1 - r * r), root = std::sqrt(t);
    return root + (t - 1) * std::atan(root);
}

double wideFilterEdge(double p) {
    const double q = std::clamp(2 * p - 1, -1.0, 1.0);
    return 0.5 * (1 + q * std::sqrt(2 - q * q));
}

Image filterWideShadow(const GBuffer& gbuffer, const ShadowMap& map, const WideShadowOptions& options) {
    Image out(gbuffer.width, gbuffer.height, 1, 1.0f);
    if (map.size == 0 || options.taps <= 0) return out;
    const std::vector<Tap> taps = makeTaps(options.taps);
    const auto vectorAt = [](const Image& image, int x, int y) {
        return Vec3{image.at(0, x, y), image.at(1, x, y), image.at(2, x, y)};
    };
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < gbuffer.height; ++y)
        for (int x = 0; x < gbuffer.width; ++x)
            if (gbuffer.coverage.at(0, x, y) > 0)
                out.at(0, x, y) = filterPixel(map, taps, options, vectorAt(gbuffer.position, x, y),
                                              vectorAt(gbuffer.geometricNormal, x, y));
    return out;
}

}  // namespace pellucid::sample
