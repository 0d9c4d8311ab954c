#include "demo/demo_hair.h"

#include <algorithm>
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

    // `side`: 1 for the left eye, which is at positive x. Lashes stand in clumps of two or three, whose tips
    // meet.
    void addLashes(const sample::EyeLook& eye, double side) {
        constexpr int upper = 34, lower = 22;
        for (int clump = 0; clump < upper + lower; ++clump) {
            const bool above = clump < upper;
            const int count = above ? 2 + clump % 2 : 2, of = above ? upper : lower;
            const double middle = ((above ? clump : clump - upper) + 0.3 + 0.4 * scattered(clump, 0)) / of;
            const double along = 1.28 * middle - 0.5, apart = 0.42 / of;
            for (int i = 0; i < count; ++i)
                addLash(eye, side, along, along + (i - 0.5 * (count - 1)) * apart, above ? 1 : -1, clump, i);
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

    // Short hair, combed away from the crown.
    void addCap(const Scalp& scalp) {
        constexpr double perArea = 1.3;  // strands a mm^2
        const sample::Mesh& mesh = skin_.mesh();
        const sample::Bounds& head = skin_.bounds();
        const double e = scalp.eyeDistance;
        const Vec3 crown{0.1 * e, head.high.y, head.centre().z - 0.45 * e};
        double sum = 0;
        int i = 0;
        for (size_t t = 0; t < mesh.materials.size(); ++t) {
            if (mesh.materials[t] != DEMO_SKIN) continue;
            const Vec3 a = corner(mesh.positions, mesh.triangles[3 * t]),
                       b = corner(mesh.positions, mesh.triangles[3 * t + 1]),
                       c = corner(mesh.positions, mesh.triangles[3 * t + 2]);
            if (scalp.height((a + b + c) * (1 / 3.0)) <= -0.1) continue;
            for (sum += 0.5 * length(cross(b - a, c - a)) * perArea; i < sum; ++i) {
                double v = scattered(i, 0), w = scattered(i, 1);
                if (v + w > 1) v = 1 - v, w = 1 - w;
                const Vec3 root = a + (b - a) * v + (c - a) * w;
                const double inside = scalp.cover(root);
                if (inside <= scattered(i, 2)) continue;
                const Vec3 n = normalize(corner(mesh.normals, mesh.triangles[3 * t]));
                addShort(root, n, crown, 0.5 + 0.5 * inside, i);
            }
        }
    }

  private:
    static constexpr int segments = 4;
    static Vec3 corner(const std::vector<float>& values, uint32_t v) {
        return {values[3 * size_t(v)], values[3 * size_t(v) + 1], values[3 * size_t(v) + 2]};
    }
    void addShort(Vec3 root, Vec3 n, Vec3 crown, double size, int i) {
        const double a = scattered(i, 1) - 0.5, b = scattered(i, 2), length = 11 * size * (0.7 + 0.6 * b);
        const Vec3 combed = sample::perpendicular(n, root - crown), aside = cross(n, combed);
        const Vec3 way = normalize(combed + aside * (0.7 * a));
        std::vector<Vec3> points;
        for (int k = 0; k <= segments; ++k) {
            const double u = double(k) / segments;
            points.push_back(root +
                             (way * u + n * (u * (0.5 - 0.33 * u)) + aside * (0.25 * a * u * u)) * length);
        }
        addStrand(points, 0.075, n);
    }
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
    // `clumped`, `along`: of the clump and the root, from -1 at the inner corner, where none grow, to 1 at
    // the outer one.
    void addLash(const sample::EyeLook& eye, double side, double clumped, double along, double up, int clump,
                 int i) {
        const auto edge = lidEdge(eye, eye.centre.x + side * along * eye.radius, up);
        if (!edge) return;
        const double a = scattered(clump, 1), b = scattered(clump, 2), own = scattered(3 * clump + i, 0);
        const double outer = std::clamp(along + 0.2, 0.0, 0.8);
        const double length = eye.radius * (up > 0 ? 0.46 + 0.3 * outer : 0.22 + 0.12 * outer) *
                              (0.72 + 0.36 * a) * (0.8 + 0.3 * own);
        const double fan = side * (0.55 * clumped + 0.3 * (b - 0.5));
        const double rise = (up > 0 ? 0.55 : 0.35) + 0.25 * a;
        const double together = 0.8 * side * (clumped - along) * eye.radius;
        std::vector<Vec3> points;
        for (int k = 0; k <= segments; ++k) {
            const double u = double(k) / segments;
            // Forward first, then up.
            points.push_back(*edge + Vec3{together * u, up * 0.25, 0} +
                             Vec3{fan * u, up * (rise * u * u - 0.15 * u), 1.05 * u - 0.35 * u * u} * length);
        }
        addStrand(points, up > 0 ? 0.1 : 0.075);
    }
    void addStrand(std::vector<Vec3> points, double radius, Vec3 normal = {0, 0, 1}) {
        if (points.size() == segments + 1) strands.push_back({std::move(points), radius, normal});
    }

    const sample::Scene& skin_;
};

}  // namespace

std::vector<Strand> strandsOf(const sample::Scene& skin, const DemoHead& head) {
    if (head.eyes.size() != 2) return {};
    Hair hair(skin);
    for (const sample::EyeLook& eye : head.eyes) {
        const double side = eye.centre.x > 0 ? 1 : -1;
        hair.addLashes(eye, side);
        hair.addBrow(eye.centre, side, head.scalp.eyeDistance);
    }
    hair.addCap(head.scalp);
    return hair.strands;
}

}  // namespace pellucid::demo
