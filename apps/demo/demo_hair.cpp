#include "demo/demo_hair.h"

#include <algorithm>
#include <optional>

namespace pellucid::demo {
namespace {

using sample::Vec3;

// A number from 0 to 1 that looks random: a property of a strand, or of a clump of lashes.
double chance(int i, uint32_t property) {
    uint32_t x = uint32_t(i) * 2654435769u + property * 2246822519u;
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return (x ^ (x >> 16)) * 0x1p-32;
}

class Hair {
  public:
    explicit Hair(const sample::Scene& skin) : skin_(skin) {}
    std::vector<Strand> strands;

    // `side`: 1 for the left eye, which is at positive x. Lashes stand in clumps of two to four, whose tips
    // meet; gaps between clumps differ, and the outer third is denser.
    void addLashes(const sample::EyeLook& eye, double side) {
        int lash = 0;
        for (const double up : {1.0, -1.0}) {
            double along = -0.52;
            for (int clump = lash; along < 0.78; clump = lash) {
                const int count = 2 + int(3 * chance(clump, 0));
                const double apart = (up > 0 ? 0.0105 : 0.017) * (along > 0.25 ? 0.8 : 1);
                const double middle = along + 0.5 * apart * (count - 1), gap = chance(clump, 1);
                for (int i = 0; i < count; ++i, ++lash)
                    addLash(eye, side, middle, along + apart * (i + 0.6 * chance(lash, 2)), up, clump, lash);
                along += apart * (count + 3 * gap * gap);
            }
        }
    }

    // An arc over the eye, of hairs that rise at its inner end and lie along it further out.
    void addBrow(Vec3 eye, double side, double eyeDistance) {
        constexpr int count = 240;
        const double e = eyeDistance;
        for (int i = 0; i < count; ++i) {
            const double s = chance(i, 0), across = 2 * chance(i, 1) - 1, t = chance(i, 2);
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
            if (points.size() > segments) addStrand(points, 0.05);
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
            if (scalp.above((a + b + c) * (1 / 3.0)) <= -0.1) continue;
            for (sum += 0.5 * length(cross(b - a, c - a)) * perArea; i < sum; ++i) {
                double v = chance(i, 0), w = chance(i, 1);
                if (v + w > 1) v = 1 - v, w = 1 - w;
                const Vec3 root = a + (b - a) * v + (c - a) * w;
                const double inside = scalp.cover(root);
                if (inside * inside <= chance(i, 2)) continue;
                const Vec3 n = normalize(corner(mesh.normals, mesh.triangles[3 * t]));
                addShort(root, n, crown, 0.25 + 0.75 * inside, i);
            }
        }
    }

  private:
    static constexpr int segments = 4;
    static Vec3 corner(const std::vector<float>& values, uint32_t v) {
        return {values[3 * size_t(v)], values[3 * size_t(v) + 1], values[3 * size_t(v) + 2]};
    }
    void addShort(Vec3 root, Vec3 n, Vec3 crown, double size, int i) {
        const double a = chance(i, 1) - 0.5, b = chance(i, 2), length = 11 * size * (0.7 + 0.6 * b);
        const Vec3 combed = sample::perpendicular(n, root - crown), aside = cross(n, combed);
        const Vec3 way = normalize(combed + aside * (0.7 * a));
        std::vector<Vec3> points;
        for (int k = 0; k <= segments; ++k) {
            const double u = double(k) / segments;
            points.push_back(root +
                             (way * u + n * (u * (0.5 - 0.33 * u)) + aside * (0.25 * a * u * u)) * length);
        }
        addStrand(points, 0.045 + 0.03 * size, n);
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
    // the outer one. `clump`, `own`: numbers of the clump and the lash.
    void addLash(const sample::EyeLook& eye, double side, double clumped, double along, double up, int clump,
                 int own) {
        const auto edge = lidEdge(eye, eye.centre.x + side * along * eye.radius, up);
        if (!edge) return;
        const double outer = std::clamp(along + 0.2, 0.0, 0.8);
        const double grown = chance(own, 3) < 0.15 ? 0.55 : 0.8 + 0.25 * chance(own, 4);  // some are young
        const double length = eye.radius * (up > 0 ? 0.52 + 0.32 * outer : 0.24 + 0.13 * outer) * grown *
                              (0.75 + 0.35 * chance(clump, 5));
        const double fan =
            side * (0.6 * clumped + 0.35 * (chance(clump, 6) - 0.5)) + 0.16 * (chance(own, 7) - 0.5);
        const double together = (0.4 + 0.6 * chance(clump, 8)) * side * (clumped - along) * eye.radius;
        // Forward and a little down first, then up.
        const double first = up > 0 ? -0.25 : 0.1, curl = (up > 0 ? 1.35 : 0.7) +
                                                          0.5 * (chance(clump, 9) - 0.5) +
                                                          0.3 * (chance(own, 10) - 0.5);
        constexpr int pieces = 7;
        std::vector<Vec3> points{*edge + Vec3{0, up * 0.25, 0}};
        for (int k = 0; k < pieces; ++k) {
            const double angle = first + curl * (k + 0.5) / pieces;
            points.push_back(points.back() + Vec3{together, 0, 0} * (1.0 / pieces) +
                             Vec3{fan, up * std::sin(angle), std::cos(angle)} * (length / pieces));
        }
        addStrand(points, up > 0 ? 0.075 : 0.055);
    }
    void addStrand(std::vector<Vec3> points, double radius, Vec3 normal = {0, 0, 1}) {
        strands.push_back({std::move(points), radius, normal});
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
