#include "reference/screen.h"

#include <cmath>

namespace reference {
namespace {

bool finite(Vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool usable(const ScreenImage& image, int pixel) {
    if (!image.ids.empty() && image.ids[pixel] == 0) return false;
    return finite(image.normals[pixel]) && finite(image.positions[pixel]) &&
           length(image.normals[pixel]) > 1e-6;
}

bool connected(const ScreenImage& image, int here, int there, double edge) {
    if (!usable(image, there) || (!image.ids.empty() && image.ids[here] != image.ids[there])) return false;
    const Vec3 step = image.positions[there] - image.positions[here];
    for (int end : {here, there})
        if (std::abs(dot(step, normalized(image.normals[end]))) > edge * length(step)) return false;
    return true;
}

}  // namespace

std::vector<double> screenCurvature(const ScreenImage& image, double edge) {
    std::vector<double> result(image.normals.size(), 0.0);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const int here = y * image.width + x;
            if (!usable(image, here)) continue;
            Vec3 turn, step;
            for (int axis = 0; axis < 2; ++axis) {
                // From the neighbour before to the one after, or from or to the pixel itself where one is
                // missing.
                int ends[2] = {here, here}, steps = 0;
                for (int side = 0; side < 2; ++side) {
                    const int nx = x + (axis == 0 ? 2 * side - 1 : 0),
                              ny = y + (axis == 1 ? 2 * side - 1 : 0);
                    if (nx < 0 || ny < 0 || nx >= image.width || ny >= image.height) continue;
                    const int there = ny * image.width + nx;
                    if (connected(image, here, there, edge)) ends[side] = there, ++steps;
                }
                if (steps == 0) continue;
                const Vec3 dn = normalized(image.normals[ends[1]]) - normalized(image.normals[ends[0]]);
                const Vec3 dp = image.positions[ends[1]] - image.positions[ends[0]];
                for (int k = 0; k < 3; ++k) {
                    turn[k] += std::abs(dn[k]) / steps;
                    step[k] += std::abs(dp[k]) / steps;
                }
            }
            if (length(step) > 0) result[here] = length(turn) / length(step);
        }
    return result;
}

}  // namespace reference
