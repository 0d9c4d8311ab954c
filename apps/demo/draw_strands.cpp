#include "demo/demo_hair.h"

#include <algorithm>
#include <numbers>

namespace pellucid::demo {
namespace {

using sample::Vec3;

constexpr double tolerance = 0.3;                               // mm: roots lie in the skin
constexpr double thinnest = 0.15;                               // at the tip, of the radius
constexpr double albedo[] = {0.07, 0.045, 0.03}, gloss = 0.03;  // dark brown

// The light of a strand, by Kajiya and Kay: a diffuse cylinder, a highlight of the hair's colour and a
// narrower one of its surface.
std::array<double, 3> lightOf(const Strand& strand, const StrandLight& light, Vec3 eye) {
    // Starts a little in front of the skin: grazing light reaches hair behind the skin's horizon.
    const Vec3 middle = strand.points[strand.points.size() / 2] + strand.normal * 3;
    const Vec3 along = normalize(strand.points.back() - strand.points.front());
    const sample::Rgb sky = light.sky.radiance(strand.normal);
    std::array<double, 3> sum;
    for (size_t c = 0; c < 3; ++c) sum[c] = (albedo[c] + gloss) * sky[c];
    for (const StrandLight::Lamp& lamp : light.lamps) {
        const double facing = std::clamp(dot(strand.normal, lamp.toLight) + 0.25, 0.0, 1.0);
        if (facing == 0 || (light.occluders && light.occluders->occluded({middle, lamp.toLight}, INFINITY)))
            continue;
        const double sine = length(cross(along, lamp.toLight));
        const double half = length(cross(along, normalize(lamp.toLight + normalize(eye - middle))));
        const double wide = sine + std::pow(half, 40), narrow = std::pow(half, 80);
        for (size_t c = 0; c < 3; ++c) sum[c] += facing * lamp.color[c] * (albedo[c] * wide + gloss * narrow);
    }
    return sum;
}

// Of a strand, at this part of its length.
double radiusAt(const Strand& strand, double along) {
    return strand.radius * (1 - (1 - thinnest) * along);
}

}  // namespace

sample::Curves curvesOf(const std::vector<Strand>& strands) {
    sample::Curves curves;
    for (const Strand& strand : strands)
        for (size_t k = 0; k < strand.points.size(); ++k) {
            const Vec3 p = strand.points[k];
            const double radius = radiusAt(strand, double(k) / double(strand.points.size() - 1));
            if (k + 1 < strand.points.size()) curves.segments.push_back(uint32_t(curves.points.size() / 4));
            curves.points.insert(curves.points.end(), {float(p.x), float(p.y), float(p.z), float(radius)});
        }
    return curves;
}

sample::Image drawStrands(const std::vector<Strand>& strands, const StrandLight& light,
                          const sample::Camera& camera, const sample::GBuffer& g) {
    sample::Image out(g.width, g.height, 4);
    const sample::Matrix4 toClip = camera.viewProjection(double(g.width) / g.height);
    const double pixelsPerSlope = 0.5 * g.height / std::tan(camera.verticalFov * std::numbers::pi / 360);
    const auto depthOf = [&](Vec3 p) { return dot(p - camera.eye, camera.forward()); };
    // Pixels, and the depth along the camera's axis.
    const auto project = [&](Vec3 p) {
        const Vec3 c = toClip.project(p);
        return Vec3{(0.5 + 0.5 * c.x) * g.width, (0.5 - 0.5 * c.y) * g.height, depthOf(p)};
    };
    // The nearest strand first; the coverage that a pixel has already hides the others.
    std::vector<std::pair<double, const Strand*>> order;
    for (const Strand& strand : strands) {
        const Vec3 root = strand.points.front();
        if (dot(strand.normal, camera.eye - root) > -0.3 * length(camera.eye - root))
            order.emplace_back(depthOf(strand.points.back()), &strand);
    }
    std::ranges::stable_sort(order, {}, &std::pair<double, const Strand*>::first);
    for (const auto& [distance, drawn] : order) {
        const Strand& strand = *drawn;
        const std::array<double, 3> color = lightOf(strand, light, camera.eye);
        for (size_t k = 0; k + 1 < strand.points.size(); ++k) {
            const Vec3 a = project(strand.points[k]), ab = project(strand.points[k + 1]) - a;
            if (!(a.z > 0)) continue;  // behind the camera
            const double shade =
                0.4 + 0.6 * (double(k) + 0.5) / double(strand.points.size() - 1);  // roots lie dark
            const double square = ab.x * ab.x + ab.y * ab.y;
            const double reach = strand.radius * pixelsPerSlope / a.z + 1;
            const auto last = [&](double from, double by) { return std::max(from, from + by) + reach; };
            const auto first = [&](double from, double by) {
                return std::max(0, int(std::min(from, from + by) - reach));
            };
            for (int y = first(a.y, ab.y); y < std::min<double>(g.height, last(a.y, ab.y)); ++y)
                for (int x = first(a.x, ab.x); x < std::min<double>(g.width, last(a.x, ab.x)); ++x) {
                    const double dx = x + 0.5 - a.x, dy = y + 0.5 - a.y;
                    const double t = (dx * ab.x + dy * ab.y) / square;
                    if (!(t >= 0 && t < 1)) continue;
                    const double depth = a.z + t * ab.z;
                    if (depth > g.viewDepth.at(0, x, y) + tolerance) continue;
                    const double along = (double(k) + t) / double(strand.points.size() - 1);
                    const double half = radiusAt(strand, along) * pixelsPerSlope / depth;
                    const double off = std::abs(dx * ab.y - dy * ab.x) / std::sqrt(square);
                    const double part =
                        std::max(0.0, std::min(off + 0.5, half) - std::max(off - 0.5, -half)) *
                        (1 - out.at(3, x, y));
                    for (int c = 0; c < 3; ++c) out.at(c, x, y) += float(color[size_t(c)] * shade * part);
                    out.at(3, x, y) += float(part);
                }
        }
    }
    return out;
}

}  // namespace pellucid::demo
