#include "sample/wide_shadow.h"

#include <algorithm>
#include <stdexcept>

namespace pellucid::sample {

namespace {

// Below this cosine to the light the tangent plane is not followed any steeper: five times the sideways
// distance.
constexpr double flattestCosine = 0.2;

// In smaller filters the number of texels would change from pixel to pixel.
constexpr float leastRadius = 2;  // texels

// By value, not by reference as std::max: else the loop below has branches and is not vectorised.
inline float atLeast0(float v) {
    return v > 0 ? v : 0;
}
inline float atMost1(float v) {
    return v < 1 ? v : 1;
}

// pi f as a function of T, for inner loops: sqrt(T) times the least-squares polynomial of 1 / (1 + T) +
// atan(sqrt(T)) / sqrt(T) on [0, 1], which is at most 5e-5 off.
inline float weightOf(float t) {
    const float g =
        1.999952f + t * (-1.329611f + t * (1.151664f + t * (-0.898892f + t * (0.483327f - 0.121076f * t))));
    return std::sqrt(t) * g;
}

// The receiver over the map, and the filter round it. Depth goes on in the tangent plane, z + dzdx (x - x0) +
// dzdy (y - y0) in texels, also in a perspective map: there z is affine in 1 / distance, and that is affine
// across a plane's image.
struct Filter {
    float x, y, z, dzdx, dzdy;
    float radius;       // texels
    float bias, cone;   // dz at the centre, and what it grows by up to the rim
    float perSoftness;  // 1 / dz over which an occluder comes to count in full
    int step;           // every step-th texel is read

    float lit(const ShadowMap& map) const {
        float sum = 0, total = 0;
        for (int row = first(y, radius); float(row) <= y + radius; row += step) {
            const float dy = float(row) - y, rest = std::max(0.0f, radius * radius - dy * dy),
                        half = std::sqrt(rest);
            const int begin = first(x, half), end = std::max(begin, int(std::floor(x + half)) + 1);
            const bool inside = row >= 0 && row < map.size;
            // Columns [low, high) are on the map; to the left and right of it everything is lit.
            const int low = inside ? std::clamp(roundUp(0), begin, end) : end;
            const int high = inside ? std::clamp(roundUp(map.size), low, end) : end;
            const float outside = plainWeight(dy, begin, low) + plainWeight(dy, std::max(high, begin), end);
            sum += outside;
            total += outside;
            const float* depth = map.depth.data() + size_t(row) * size_t(map.size);
            if (low < high)
                step == 1 ? addRow<1>(depth, dy, low, high, sum, total)
                          : addRow<0>(depth, dy, low, high, sum, total);
        }
        return total > 0 ? sum / total : 1;
    }

  private:
    // Smallest multiple of step that is not below v.
    int roundUp(int v) const { return v > 0 ? (v + step - 1) / step * step : -(-v / step) * step; }
    int first(float centre, float reach) const { return roundUp(int(std::ceil(centre - reach))); }
    float tAt(float dx, float dy) const {
        return atLeast0(1 - (dx * dx + dy * dy) * (1 / (radius * radius)));
    }
    float plainWeight(float dy, int begin, int end) const {
        float sum = 0;
        for (int column = begin; column < end; column += step) sum += weightOf(tAt(float(column) - x, dy));
        return sum;
    }
    // A constant step lets the compiler vectorise; 0: the variable one.
    template <int constantStep>
    void addRow(const float* depth, float dy, int begin, int end, float& sum, float& total) const {
        const float start = z - bias + dzdy * dy;
        float rowSum = 0, rowTotal = 0;
        const int stride = constantStep > 0 ? constantStep : step;
#pragma omp simd reduction(+ : rowSum, rowTotal)
        for (int column = begin; column < end; column += stride) {
            const float dx = float(column) - x, t = tAt(dx, dy), weight = weightOf(t);
            const float receiver = start + dzdx * dx - cone * std::sqrt(1 - t);
            const float shown = 1 + (depth[column] - receiver) * perSoftness;
            rowSum += weight * atMost1(atLeast0(shown));
            rowTotal += weight;
        }
        sum += rowSum;
        total += rowTotal;
    }
};

float filterPixel(const ShadowMap& map, const WideShadowOptions& options, Vec3 position, Vec3 normal) {
    if (!(map.worldToUvz.transformPoint(position)[3] > 0)) return 1;  // behind a spot light
    const Vec3 uvz = map.worldToUvz.project(position);
    // Towards the light, scaled so that it has length 1 along the map's axis.
    Vec3 toLight = -map.forward;
    if (map.projection == ShadowProjection::Perspective)
        toLight =
            toLight - map.right * ((uvz.x - 0.5) * map.extent) - map.down * ((uvz.y - 0.5) * map.extent);
    const double distance = map.distance(uvz.z), zPerLength = map.zPerLength(distance);
    const double texel = map.lengthPerUv(distance) / map.size;
    const double cosine = dot(normal, toLight);
    const double tilt = 1 / std::max(cosine, flattestCosine);
    const double slope = tilt * texel * zPerLength;
    // A point that faces away is behind its own body: up to two filter widths of that are not its shadow, the
    // curvature look-up table darkens it.
    const double body = 2 * options.filterWidth * std::max(0.0, -cosine);
    Filter filter;
    filter.x = float(uvz.x * map.size - 0.5);
    filter.y = float(uvz.y * map.size - 0.5);
    filter.z = float(uvz.z);
    filter.dzdx = float(dot(normal, map.right) * slope);
    filter.dzdy = float(dot(normal, map.down) * slope);
    filter.radius = std::max(float(0.5 * options.filterWidth / texel), leastRadius);
    filter.bias = float((options.depthBias + body) * zPerLength);
    filter.cone = float(options.coneSlope * tilt * 0.5 * options.filterWidth * zPerLength);
    filter.perSoftness = float(1 / (options.softness * options.filterWidth * zPerLength));
    filter.step = std::max(1, int(std::ceil(2 * filter.radius / float(options.maxTexels))));
    return filter.lit(map);
}

}  // namespace

double wideFilterEdge(double p) {
    const double q = std::clamp(2 * p - 1, -1.0, 1.0);
    return 0.5 * (1 + q * std::sqrt(2 - q * q));
}

Image filterWideShadow(const GBuffer& gbuffer, const ShadowMap& map, const WideShadowOptions& options) {
    Image out(gbuffer.width, gbuffer.height, 1, 1.0f);
    if (map.size == 0) return out;
    if (!(options.filterWidth > 0) || options.maxTexels < 4)
        throw std::invalid_argument("wide shadow: filterWidth must be above 0 and maxTexels 4 or more");
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < gbuffer.height; ++y)
        for (int x = 0; x < gbuffer.width; ++x)
            if (gbuffer.coverage.at(0, x, y) > 0)
                out.at(0, x, y) = filterPixel(map, options, vectorAt(gbuffer.position, x, y),
                                              vectorAt(gbuffer.geometricNormal, x, y));
    return out;
}

}  // namespace pellucid::sample
