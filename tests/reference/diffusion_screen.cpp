#include "reference/diffusion_screen.h"

namespace reference {

bool sound(const ScatterPicture& p, size_t i) {
    return p.ids[i] != 0 && finite(p.positions[i]) && finite(p.irradiance[i]);
}

std::optional<Vec3> shorterStep(const ScatterPicture& p, int x, int y, int dx, int dy) {
    std::optional<Vec3> shortest;
    for (int side : {-1, 1}) {
        const int u = x + side * dx, v = y + side * dy;
        if (!p.holds(u, v) || !sound(p, p.at(u, v)) || p.ids[p.at(u, v)] != p.ids[p.at(x, y)]) continue;
        const Vec3 step = side * (p.positions[p.at(u, v)] - p.positions[p.at(x, y)]);
        if (!shortest || length(step) < length(*shortest)) shortest = step;
    }
    return shortest;
}

// Unit, towards the camera; 0 where steps along both axes are missing.
static Vec3 outwardNormal(const ScatterPicture& p, int x, int y) {
    const auto right = shorterStep(p, x, y, 1, 0), down = shorterStep(p, x, y, 0, 1);
    if (!p.camera || !right || !down) return {};
    const Vec3 n = normalized(cross(*right, *down));
    return dot(n, *p.camera - p.positions[p.at(x, y)]) < 0 ? -1 * n : n;
}

double scatterReach(const Profile& profile) {
    double low = 0, high = 64 * magnitude(rmsWidth(profile));
    for (int k = 0; k < 40; ++k) {
        const double middle = (low + high) / 2;
        const Rgb within = enclosedEnergy(profile, middle);
        (std::min({within.x, within.y, within.z}) < 1 - 4e-3 ? low : high) = middle;
    }
    return high;
}

double surfaceArea(const ScatterPicture& p, int x, int y) {
    const auto right = shorterStep(p, x, y, 1, 0), down = shorterStep(p, x, y, 0, 1);
    if (!right && !down) return 0;
    if (!right) return dot(*down, *down);
    if (!down) return dot(*right, *right);
    const Vec3 normal = cross(*right, *down);
    if (!p.camera || length(normal) == 0) return length(normal);
    const Vec3 view = p.positions[p.at(x, y)] - *p.camera;
    const double cosine = std::abs(dot(normal, view)) / (length(normal) * length(view));
    return length(normal) * std::min(1.0, 4 * cosine);
}

std::vector<Rgb> scatterOnScreen(const ScatterPicture& p, const Profile& profile) {
    const double reach = scatterReach(profile);
    std::vector<double> areas(p.positions.size());
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x)
            if (sound(p, p.at(x, y))) areas[p.at(x, y)] = surfaceArea(p, x, y);
    std::vector<Rgb> result = p.irradiance;
    for (size_t i = 0; i < result.size(); ++i) {
        if (!(areas[i] > 0)) continue;
        const double s = p.radii.empty() ? 1 : p.radii[i];
        const Vec3 normal = p.directed > 0 ? outwardNormal(p, int(i) % p.width, int(i) / p.width) : Vec3{};
        // The pixel itself: the share of a disk of its area.
        Rgb weights = enclosedEnergy(profile, std::min(reach, std::sqrt(areas[i] / pi) / s)),
            light = weights * p.irradiance[i];
        for (size_t j = 0; j < result.size(); ++j) {
            if (i == j || !(areas[j] > 0) || p.ids[j] != p.ids[i]) continue;
            const Vec3 way = p.positions[j] - p.positions[i];
            const double distance = length(way);
            if (distance >= reach * s) continue;
            const Rgb weight = areas[j] / (s * s) * profile.radial(distance / s);
            weights = weights + weight;
            const double share = std::max(0.0, 1 - p.directed * dot(normal, way) / distance);
            light = light + (share * weight) * p.irradiance[j];
        }
        for (int c = 0; c < 3; ++c) result[i][c] = light[c] / weights[c];
    }
    return result;
}

}  // namespace reference
