#include "reference/surface_integral.h"

namespace reference {
namespace {

constexpr double stop = 1e-9;  // change of a triangle's integral by splitting it that no longer matters
constexpr int deepest = 26;    // halvings: 1/r leaves 2^-26 of a triangle's share

struct Kernel {
    const Profile& profile;
    Rgb cut, scale;
    Vec3 x;
    Rgb operator()(Vec3 y) const {
        const double r = length(y - x);
        if (r == 0) return {};
        Rgb R = profile.radial(r);
        for (int c = 0; c < 3; ++c) R[c] = cut[c] > 0 && r >= cut[c] ? 0 : R[c] * scale[c];
        return R;
    }
};

double areaOf(const LitTriangle& t) {
    return 0.5 * length(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]));
}

// Radon's rule of 7 points, exact to degree 5 (Radon 1948).
Rgb sevenPoints(const Kernel& kernel, const LitTriangle& t) {
    const double root = std::sqrt(15.0);
    Rgb sum{};
    const auto add = [&](double a, double b, double c, double weight) {
        const Vec3 y = a * t.corner[0] + b * t.corner[1] + c * t.corner[2];
        const Rgb E = a * t.irradiance[0] + b * t.irradiance[1] + c * t.irradiance[2];
        sum = sum + weight * (kernel(y) * E);
    };
    add(1 / 3., 1 / 3., 1 / 3., 0.225);
    for (const double sign : {-1.0, 1.0}) {
        const double a = (6 + sign * root) / 21, b = 1 - 2 * a, weight = (155 + sign * root) / 1200;
        add(a, a, b, weight);
        add(a, b, a, weight);
        add(b, a, a, weight);
    }
    return areaOf(t) * sum;
}

std::array<LitTriangle, 4> quarters(const LitTriangle& t) {
    std::array<Vec3, 3> p;
    std::array<Rgb, 3> E;
    for (int k = 0; k < 3; ++k) {
        p[k] = 0.5 * (t.corner[k] + t.corner[(k + 1) % 3]);
        E[k] = 0.5 * (t.irradiance[k] + t.irradiance[(k + 1) % 3]);
    }
    return {{{{t.corner[0], p[0], p[2]}, {t.irradiance[0], E[0], E[2]}},
             {{p[0], t.corner[1], p[1]}, {E[0], t.irradiance[1], E[1]}},
             {{p[2], p[1], t.corner[2]}, {E[2], E[1], t.irradiance[2]}},
             {{p[0], p[1], p[2]}, {E[0], E[1], E[2]}}}};
}

// Triangles close to x are always split: the rule's points may miss a narrow R.
Rgb adaptive(const Kernel& kernel, const LitTriangle& t, Rgb whole, int depth) {
    const auto parts = quarters(t);
    std::array<Rgb, 4> values;
    Rgb sum{};
    for (int k = 0; k < 4; ++k) {
        values[k] = sevenPoints(kernel, parts[k]);
        sum = sum + values[k];
    }
    const double longest = std::max({length(t.corner[1] - t.corner[0]), length(t.corner[2] - t.corner[1]),
                                     length(t.corner[0] - t.corner[2])});
    const double away = length((t.corner[0] + t.corner[1] + t.corner[2]) / 3 - kernel.x);
    if (depth >= deepest || (longest < 0.5 * away && magnitude(sum - whole) < stop)) return sum;
    sum = {};
    for (int k = 0; k < 4; ++k) sum = sum + adaptive(kernel, parts[k], values[k], depth + 1);
    return sum;
}

Rgb scaleOf(const Profile& profile, Rgb cut) {
    Rgb scale{1, 1, 1};
    for (int c = 0; c < 3; ++c)
        if (cut[c] > 0) scale[c] = 1 / enclosedEnergy(profile, cut[c])[c];
    return scale;
}

}  // namespace

Rgb surfaceIntegral(const Profile& profile, const std::vector<LitTriangle>& mesh, Vec3 x, Rgb cut) {
    const Kernel kernel{profile, cut, scaleOf(profile, cut), x};
    Rgb sum{};
    for (const LitTriangle& t : mesh) sum = sum + adaptive(kernel, t, sevenPoints(kernel, t), 0);
    return sum;
}

}  // namespace reference
