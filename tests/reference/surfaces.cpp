#include "reference/surfaces.h"

#include <numbers>

namespace reference {
namespace {

constexpr double pi = std::numbers::pi;

PrincipalCurvatures ordered(double a, double b) {
    return {std::max(a, b), std::min(a, b)};
}

PrincipalCurvatures fromMeanAndGaussian(double mean, double gaussian) {
    const double root = std::sqrt(max0(mean * mean - gaussian));
    return {mean + root, mean - root};
}

Vec3 direction(double longitude, double latitude) {
    return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
            std::sin(latitude)};
}

// Of the graph z(x, y) with this gradient and (zxx, zxy, zyy). Minus: one that bends up bends towards its
// upward normal.
SurfacePoint graphPoint(double x, double y, double z, Vec2 g, Vec3 h) {
    const double w2 = 1 + g.x * g.x + g.y * g.y, w = std::sqrt(w2);
    const double gaussian = (h.x * h.z - h.y * h.y) / (w2 * w2);
    const double mean = -((1 + g.y * g.y) * h.x - 2 * g.x * g.y * h.y + (1 + g.x * g.x) * h.z) / (2 * w2 * w);
    return {{x, y, z}, Vec3{-g.x, -g.y, 1} / w, fromMeanAndGaussian(mean, gaussian)};
}

}  // namespace

Surface planeSurface(double side) {
    return {[](double u, double v) { return SurfacePoint{{u, v, 0}, {0, 0, 1}, {0, 0}}; }, 0, side, 0, side};
}

Surface sphereSurface(double radius) {
    return ellipsoidSurface(radius, radius, radius);
}

Surface cylinderSurface(double radius, double height) {
    return {[=](double u, double v) {
                const Vec3 n = direction(u, 0);
                return SurfacePoint{radius * n + Vec3{0, 0, v}, n, {1 / radius, 0}};
            },
            0,
            2 * pi,
            0,
            height,
            true,
            false};
}

Surface coneSurface(double halfAngle, double slantBegin, double slantEnd) {
    return {[=](double u, double slant) {
                const double s = std::sin(halfAngle), c = std::cos(halfAngle);
                const Vec3 around = direction(u, 0);
                // Apex at the origin, opening downwards.
                return SurfacePoint{slant * (s * around + Vec3{0, 0, -c}),
                                    c * around + Vec3{0, 0, s},
                                    {1 / (slant * std::tan(halfAngle)), 0}};
            },
            0,
            2 * pi,
            slantBegin,
            slantEnd,
            true,
            false};
}

Surface torusSurface(double majorRadius, double minorRadius) {
    return {[=](double u, double v) {
                const Vec3 around = direction(u, 0), n = std::cos(v) * around + Vec3{0, 0, std::sin(v)};
                const double distance = majorRadius + minorRadius * std::cos(v);
                return SurfacePoint{majorRadius * around + minorRadius * n, n,
                                    ordered(1 / minorRadius, std::cos(v) / distance)};
            },
            0,
            2 * pi,
            0,
            2 * pi,
            true,
            true};
}

SurfacePoint ellipsoidPoint(Vec3 s, double a, double b, double c) {
    const Vec3 p{a * s.x, b * s.y, c * s.z}, gradient{s.x / a, s.y / b, s.z / c};
    const double g2 = dot(gradient, gradient), volume2 = a * a * b * b * c * c;
    // Everywhere umbilic: the root of mean² - gaussian would leave half the digits.
    if (a == b && b == c) return {p, s, {1 / a, 1 / a}};
    const double gaussian = 1 / (volume2 * g2 * g2);
    const double mean = (a * a + b * b + c * c - dot(p, p)) / (2 * volume2 * g2 * std::sqrt(g2));
    return {p, normalized(gradient), fromMeanAndGaussian(mean, gaussian)};
}

Surface ellipsoidSurface(double a, double b, double c) {
    return {[=](double u, double v) { return ellipsoidPoint(direction(u, v), a, b, c); },
            0,
            2 * pi,
            -pi / 3,
            pi / 3,
            true,
            false};
}

Surface monkeySaddle(double side) {
    return {[](double x, double y) {
                return graphPoint(x, y, x * x * x - 3 * x * y * y, {3 * (x * x - y * y), -6 * x * y},
                                  {6 * x, -6 * y, -6 * x});
            },
            -side / 2, side / 2, -side / 2, side / 2};
}

Surface gaussianBump(double height, double width, double side) {
    return {[=](double x, double y) {
                const double w2 = width * width, z = height * std::exp(-(x * x + y * y) / (2 * w2));
                return graphPoint(
                    x, y, z, {-x * z / w2, -y * z / w2},
                    {(x * x / w2 - 1) * z / w2, x * y * z / (w2 * w2), (y * y / w2 - 1) * z / w2});
            },
            -side / 2, side / 2, -side / 2, side / 2};
}

Surface catenoid(double waist) {
    return {[=](double u, double v) {
                const double c = std::cosh(v), k = 1 / (waist * c * c);
                return SurfacePoint{{waist * c * std::cos(u), waist * c * std::sin(u), waist * v},
                                    Vec3{std::cos(u), std::sin(u), -std::sinh(v)} / c,
                                    {k, -k}};
            },
            0, 2, -1, 1};
}

Surface ellipsoidCap(double a, double b, double c) {
    return {[=](double u, double v) {
                const double r2 = u * u + v * v;
                return ellipsoidPoint(Vec3{2 * u, 2 * v, 1 - r2} / (1 + r2), a, b, c);
            },
            -1, 1, -1, 1};
}

}  // namespace reference
