#include "sample/look.h"

#include <algorithm>

namespace pellucid::sample {

constexpr double limbus = 0.5;  // from the axis of gaze, of the eye's radius [Le Grand and El Hage]

static double smoothstep(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

static LinearColor mix(const LinearColor& a, const LinearColor& b, double t) {
    return {a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t};
}

double SkinZone::weight(Vec3 p) const {
    const Vec3 d = p - centre;
    return 1 - smoothstep(1 - edge, 1, std::hypot(d.x / radii.x, d.y / radii.y, d.z / radii.z));
}

LinearColor SkinZone::colorAt(Vec3 p) const {
    return mix({1, 1, 1}, color, weight(p));
}

LinearColor EyeLook::at(Vec3 p) const {
    const Vec3 out = normalize(p - centre, gaze), up = perpendicular(gaze, {0, 1, 0});
    const double across = std::abs(dot(out, cross(gaze, up))), height = dot(out, up);
    const double corner = smoothstep(0.35, 0.85, across);
    // Veins run from the corners to the iris, and waver.
    const double phase = 44 * height + 1.7 * std::sin(9 * across + 7 * height) + 0.9 * std::sin(31 * across);
    const double vein = corner * std::pow(std::abs(std::cos(phase)), 16);
    // The sclera darkens and greys towards the iris over a width that varies.
    const double fromAxis = dot(out, gaze) > 0 ? std::hypot(across, height) : 1;
    const double width = 0.07 + 0.03 * std::sin(3 * std::atan2(height, across) + 1);
    const double grey = 0.4 * (1 - smoothstep(limbus, limbus + width, fromAxis));
    const LinearColor white{sclera[0] * (1 - 0.06 * vein), sclera[1] * (1 - 0.24 * corner - 0.22 * vein),
                            sclera[2] * (1 - 0.28 * corner - 0.2 * vein)};
    return mix(white, {0.5 * white[0], 0.5 * white[1], 0.56 * white[2]}, grey);
}

}  // namespace pellucid::sample
