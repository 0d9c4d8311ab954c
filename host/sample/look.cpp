#include "sample/look.h"

#include <algorithm>

namespace pellucid::sample {

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
    const Vec3 out = normalize(p - centre, gaze);
    const double along = dot(out, gaze);
    // Distance from the axis on the ball, as if it had its radius.
    const double r = radius * std::acos(std::clamp(along, -1.0, 1.0));
    const double blend = 0.06 * radius;
    // Fibres: a few waves round the axis.
    const Vec3 side = perpendicular(gaze, {0, 1, 0}), across = cross(gaze, side);
    const double angle = std::atan2(dot(out, side), dot(out, across));
    const double fibres = 0.8 + 0.2 * std::sin(31 * angle + 2 * std::sin(7 * angle)) * std::sin(13 * angle);
    const double ring = 1 - 0.6 * smoothstep(0.75 * irisRadius, irisRadius, r);  // the limbus is dark
    LinearColor color = iris;
    for (double& c : color) c *= fibres * ring;
    color = mix(color, sclera, smoothstep(irisRadius - 0.3 * blend, irisRadius + blend, r));
    return mix({0.01, 0.01, 0.01}, color,
               smoothstep(pupilRadius - 0.2 * blend, pupilRadius + 0.2 * blend, r));
}

}  // namespace pellucid::sample
