// Small double-precision vectors and matrices of the sample renderer.
#pragma once
#include <array>
#include <cmath>
#include <numbers>

namespace pellucid::sample {

constexpr double pi = std::numbers::pi;

struct Vec3 {
    double x = 0, y = 0, z = 0;

    friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
    friend Vec3 operator*(Vec3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
    friend Vec3 operator*(double s, Vec3 a) { return a * s; }
    friend double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    friend Vec3 cross(Vec3 a, Vec3 b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
    friend double length(Vec3 a) { return std::sqrt(dot(a, a)); }
};

// The unit vector along a, or `otherwise` where a has no direction.
inline Vec3 normalize(Vec3 a, Vec3 otherwise = {0, 0, 1}) {
    const double l = length(a);
    return l > 0 ? a * (1 / l) : otherwise;
}

// A unit vector across `direction`, as near to `wish` as possible, or to an axis if they are parallel.
Vec3 perpendicular(Vec3 direction, Vec3 wish);

// Row-major, multiplies column vectors: out[i] = sum over j of m[4 i + j] in[j], as in pellucid.h.
struct Matrix4 {
    std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

    static Matrix4 fromRows(Vec3 x, double xw, Vec3 y, double yw, Vec3 z, double zw, Vec3 w = {},
                            double ww = 1) {
        return {{x.x, x.y, x.z, xw, y.x, y.y, y.z, yw, z.x, z.y, z.z, zw, w.x, w.y, w.z, ww}};
    }
    std::array<float, 16> toFloats() const;
    Vec3 project(Vec3 p) const;  // divided by the fourth component
    Matrix4 inverse() const;     // throws std::domain_error when singular
    friend Matrix4 operator*(const Matrix4& a, const Matrix4& b);
};

}  // namespace pellucid::sample
