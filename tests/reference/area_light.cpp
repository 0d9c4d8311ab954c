#include "reference/area_light.h"

namespace reference {
namespace {

// Two unit vectors across a unit one.
std::pair<Vec3, Vec3> across(Vec3 n) {
    const Vec3 other = std::abs(n.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
    const Vec3 right = normalized(cross(other, n));
    return {right, cross(n, right)};
}

}  // namespace

std::vector<PixelLight> areaLights(const AreaLamp& lamp, Vec3 position, int side) {
    std::vector<PixelLight> lights;
    const Vec3 way = lamp.center - position;
    const double share = 1.0 / (double(side) * side);
    const auto add = [&](Vec3 toLight, double strength) {
        PixelLight light;
        light.toLight = toLight;
        light.color = strength * lamp.color;
        lights.push_back(light);
    };
    if (length(lamp.halfWidth) == 0) {
        const Vec3 axis = normalized(way);
        const auto [right, up] = across(axis);
        const double sine = std::min(lamp.radius / length(way), 1.0), cosine = std::sqrt(1 - sine * sine);
        const double solidAngle = 2 * pi * (1 - cosine), radiance = 1 / (lamp.radius * lamp.radius);
        for (int i = 0; i < side; ++i)
            for (int j = 0; j < side; ++j) {
                const double along = 1 - (i + 0.5) / side * (1 - cosine),
                             aside = std::sqrt(1 - along * along), turn = 2 * pi * (j + 0.5) / side;
                add(along * axis + aside * (std::cos(turn) * right + std::sin(turn) * up),
                    radiance * solidAngle * share / pi);
            }
        return lights;
    }
    const Vec3 axis = normalized(cross(lamp.halfWidth, lamp.halfHeight));
    if (dot(way, axis) >= 0) return lights;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const Vec3 to = way + ((2 * i + 1.0) / side - 1) * lamp.halfWidth +
                            ((2 * j + 1.0) / side - 1) * lamp.halfHeight;
            const double distance = length(to);
            add(to / distance, -dot(to, axis) / distance / (distance * distance) * share);
        }
    return lights;
}

}  // namespace reference
