#include "demo/demo_hair.h"

#include <algorithm>
#include <numbers>
#include <optional>

namespace pellucid::demo {
namespace {

using sample::Vec3;

// Numbers from 0 to 1 that fill their range evenly and look random: multiples of irrational numbers.
double scattered(int i, int sequence) {
    constexpr double steps[] = {0.7548776662, 0.5698402910, 0.6180339887};
    const double x = (i + 0.5) * steps[sequence];
    return x - std::floor(x);
}

class Hair {
  public:
    explicit Hair(const sample::Scene& skin) : skin_(skin) {}
    std::vector<Strand> strands;

    // `side`: 1 for the left eye, which is at positive x.
    void addLashes(const sample::EyeLook& eye, double side) {
        constexpr int upper = 80, lower = 40;
        for (int i = 0; i < upper + lower; ++i) {
            const bool above = i < upper;
            const double along = 1.38 * (above ? i + 0.5 : i - upper + 0.5) / (above ? upper : lower) - 0.5;
            addLash(eye, side, along, above ? 1 : -1, i);
        }
    }

    // An arc over the eye, of hairs that rise at its inner end and lie along it further out.
    void addBrow(Vec3 eye, double side, double eyeDistance) {
        constexpr int count = 240;
        const double e = eyeDistance;
        for (int i = 0; i < count; ++i) {
            const double s = scattered(i, 0), across = 2 * scattered(i, 1) - 1, t = scattered(i, 2);
            const double width = (0.055 - 0.04 * s * s) * std::min(1.0, 0.5 + 5 * s);
            const double angle = 1.15 * std::exp(-5 * s) + 0.25 - 0.55 * s - 0.35 * across;
            const double length = (0.13 - 0.05 * s) * (0.75 + 0.5 * t);
            const double x = -0.27 + 0.60 * s, y = 0.29 + 0.10 * std::sin(2.4 * s) + width * across;
            std::vector<Vec3> points;
            for (int k = 0; k <= segments; ++k) {
                const double u = double(k) / segments, turned = angle - 0.3 * u;
                const auto hit = front(eye.x + side * e * (x + u * length * std::cos(turned)),
                                       eye.y + e * (y + u * length * std::sin(turned)));
                if (!hit || hit->material != DEMO_SKIN) break;
                points.push_back(hit->position + hit->normal * (0.7 * std::sin(2.6 * u)));
            }
            addStrand(points, 0.05);
        }
    }

  private:
    static constexpr int segments = 4;
    struct FrontHit {
        Vec3 position, normal;
        uint32_t material;
    };
    // What a ray from the front hits.
    std::optional<FrontHit> front(double x, double y) const {
        const sample::Ray ray{{x, y, skin_.bounds().high.z + 1}, {0, 0, -1}};
        Vec3 normal;
        const sample::Hit hit = skin_.firstHit(ray, INFINITY, normal);
        if (hit.triangle == sample::Hit::none) return {};
        return FrontHit{ray.origin + ray.direction * hit.distance, normal,
                        skin_.mesh().materials[hit.triangle]};
    }
    // The edge of the upper (`up` 1) or lower lid (-1) in the column x.
    std::optional<Vec3> lidEdge(const sample::EyeLook& eye, double x, double up) const {
        constexpr double step = 0.1;  // mm
        bool opened = false;
        for (double d = -0.4 * eye.radius; d < eye.radius; d += step) {
            const auto hit = front(x, eye.centre.y + up * d);
            if (!hit) return {};
            if (hit->material != DEMO_SKIN)
                opened = true;
            else if (opened)
                return hit->position;
        }
        return {};
    }
    // `along`: from -1 at the inner corner, where none grow, to 1 at the outer one.
    void addLash(const sample::EyeLook& eye, double side, double along, double up, int i) {
        const double x = eye.centre.x + side * along * eye.radius;
        const auto edge = lidEdge(eye, x, up);
        if (!edge) return;
        const double length = eye.radius * (up > 0 ? 0.52 + 0.16 * along : 0.26 + 0.06 * along) *
                              (0.75 + 0.4 * scattered(i, 0));
        const double fan = side * (0.45 * along + 0.25 * (scattered(i, 1) - 0.5));
        const double rise = up > 0 ? 0.75 : 0.45;
        std::vector<Vec3> points;
        for (int k = 0; k <= segments; ++k) {
            const double u = double(k) / segments;
            // Forward first, then up.
            points.push_back(*edge + Vec3{0, up * 0.25, 0} +
                             Vec3{fan * u, up * (rise * u * u - 0.15 * u), 0.95 * u - 0.35 * u * u} * length);
        }
        addStrand(points, up > 0 ? 0.065 : 0.045);
    }
    void addStrand(std::vector<Vec3> points, double radius) {
        if (points.size() == segments + 1) strands.push_back({std::move(points), radius});
    }

    const sample::Scene& skin_;
};

}  // namespace

std::vector<Strand> strandsOf(const sample::Scene& head, const std::vector<sample::EyeLook>& eyes) {
    if (eyes.size() != 2) return {};
    Hair hair(head);
    const double distance = length(eyes[0].centre - eyes[1].centre);
    for (const sample::EyeLook& eye : eyes) {
        const double side = eye.centre.x > 0 ? 1 : -1;
        hair.addLashes(eye, side);
        hair.addBrow(eye.centre, side, distance);
    }
    return hair.strands;
}

sample::Image coverageOf(const std::vector<Strand>& strands, const sample::Camera& camera,
                         const sample::GBuffer& g) {
    constexpr double tolerance = 0.3;  // mm: roots lie in the skin
    constexpr double thinnest = 0.15;  // at the tip, of the radius
    sample::Image cover(g.width, g.height, 1);
    const sample::Matrix4 toClip = camera.viewProjection(double(g.width) / g.height);
    const double pixelsPerSlope = 0.5 * g.height / std::tan(camera.verticalFov * std::numbers::pi / 360);
    // Pixels, and the depth along the camera's axis.
    const auto project = [&](Vec3 p) {
        const Vec3 c = toClip.project(p);
        return Vec3{(0.5 + 0.5 * c.x) * g.width, (0.5 - 0.5 * c.y) * g.height,
                    dot(p - camera.eye, camera.forward())};
    };
    for (const Strand& strand : strands)
        for (size_t k = 0; k + 1 < strand.points.size(); ++k) {
            const Vec3 a = project(strand.points[k]), ab = project(strand.points[k + 1]) - a;
            if (!(a.z > 0)) continue;  // behind the camera
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
                    const double half = strand.radius * (1 - (1 - thinnest) * along) * pixelsPerSlope / depth;
                    const double off = std::abs(dx * ab.y - dy * ab.x) / std::sqrt(square);
                    const double part = std::max(0.0, std::min(off + 0.5, half) - std::max(off - 0.5, -half));
                    float& sum = cover.at(0, x, y);
                    sum += float(part) * (1 - sum);
                }
        }
    return cover;
}

}  // namespace pellucid::demo
