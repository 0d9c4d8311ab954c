#include "sample/sky.h"

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

namespace pellucid::sample {

constexpr double pi = std::numbers::pi;

// Nodes and weights of the Gauss-Legendre rule on [-1, 1]: Newton's method on the recurrence.
static std::vector<std::pair<double, double>> gaussLegendre(int count) {
    std::vector<std::pair<double, double>> rule;
    for (int i = 0; i < count; ++i) {
        double x = std::cos(pi * (i + 0.75) / (count + 0.5)), slope = 1;
        for (int step = 0; step < 20; ++step) {
            double p0 = 1, p1 = x;
            for (int n = 2; n <= count; ++n)
                p0 = std::exchange(p1, ((2 * n - 1) * x * p1 - (n - 1) * p0) / n);
            slope = count * (x * p1 - p0) / (x * x - 1);
            x -= p1 / slope;
        }
        rule.emplace_back(x, 2 / ((1 - x * x) * slope * slope));
    }
    return rule;
}

std::array<double, 9> harmonicBasis(Vec3 d) {
    const double c0 = std::sqrt(1 / (4 * pi)), c1 = std::sqrt(3 / (4 * pi)), c2 = std::sqrt(15 / (4 * pi)),
                 c20 = std::sqrt(5 / (16 * pi));
    return {c0,
            c1 * d.y,
            c1 * d.z,
            c1 * d.x,
            c2 * d.x * d.y,
            c2 * d.y * d.z,
            c20 * (3 * d.z * d.z - 1),
            c2 * d.x * d.z,
            0.5 * c2 * (d.x * d.x - d.y * d.y)};
}

Rgb Sky::radiance(Vec3 direction) const {
    const double height = dot(direction, up), towards = std::max(0.0, dot(direction, normalize(lamp)));
    // The floor meets the horizon over a few degrees, so that the projection sees no jump.
    const double above = std::clamp(0.5 + 5 * height, 0.0, 1.0), rise = std::sqrt(std::max(0.0, height));
    const double glow = std::pow(towards, lampSharpness);
    Rgb out;
    for (int c = 0; c < 3; ++c)
        out[c] = floor[c] * (1 - above) + (horizon[c] + (zenith[c] - horizon[c]) * rise) * above +
                 lampRadiance[c] * glow;
    return out;
}

Harmonics projectIrradiance(const std::function<Rgb(Vec3)>& radiance) {
    constexpr int rings = 64, spokes = 128;
    const std::array<double, 3> cosineLobe{1, 2.0 / 3, 1.0 / 4};
    Harmonics sum{};
    for (const auto& [z, weight] : gaussLegendre(rings))
        for (int j = 0; j < spokes; ++j) {
            const double phi = 2 * pi * (j + 0.5) / spokes, r = std::sqrt(1 - z * z);
            const Vec3 d{r * std::cos(phi), r * std::sin(phi), z};
            const auto basis = harmonicBasis(d);
            const Rgb light = radiance(d);
            for (int i = 0; i < 9; ++i)
                for (int c = 0; c < 3; ++c)
                    sum[i][c] += cosineLobe[i == 0  ? 0
                                            : i < 4 ? 1
                                                    : 2] *
                                 basis[i] * light[c] * weight * 2 * pi / spokes;
        }
    return sum;
}

Harmonics projectIrradiance(const Sky& sky) {
    return projectIrradiance([&](Vec3 d) { return sky.radiance(d); });
}

Rgb evaluate(const Harmonics& harmonics, Vec3 normal) {
    const auto basis = harmonicBasis(normal);
    Rgb out{};
    for (int i = 0; i < 9; ++i)
        for (int c = 0; c < 3; ++c) out[c] += harmonics[i][c] * basis[i];
    return out;
}

}  // namespace pellucid::sample
