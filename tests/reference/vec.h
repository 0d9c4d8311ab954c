// Three doubles with the arithmetic that the oracle needs: a vector in space or an RGB triple.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace reference {

constexpr double pi = std::numbers::pi;

struct Vec3 {
    double x = 0, y = 0, z = 0;
    double operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    double& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
    friend Vec3 operator/(Vec3 a, Vec3 b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
    friend Vec3 operator*(double k, Vec3 a) { return {k * a.x, k * a.y, k * a.z}; }
    friend Vec3 operator*(Vec3 a, double k) { return k * a; }
    friend Vec3 operator/(Vec3 a, double k) { return {a.x / k, a.y / k, a.z / k}; }
};
using Rgb = Vec3;

struct Vec2 {
    double x = 0, y = 0;
};

inline double dot(Vec3 a, Vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double determinant(Vec3 a, Vec3 b, Vec3 c) {
    return dot(a, cross(b, c));
}
// x with dot(a, x), dot(b, x), dot(c, x) = right, by Cramer's rule.
inline Vec3 solved(Vec3 a, Vec3 b, Vec3 c, Vec3 right) {
    return (right.x * cross(b, c) + right.y * cross(c, a) + right.z * cross(a, b)) / determinant(a, b, c);
}
inline double length(Vec3 a) {
    return std::sqrt(dot(a, a));
}
inline Vec3 normalized(Vec3 a) {
    return a / length(a);
}
inline bool finite(Vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline double max0(double x) {
    return std::max(x, 0.0);
}
inline double saturate(double x) {
    return std::clamp(x, 0.0, 1.0);
}
inline double smoothstep01(double t) {
    return t * t * (3 - 2 * t);
}
template <class Value>
Value mix(Value a, Value b, double t) {
    return (1 - t) * a + t * b;
}
// Between the four values at(column, row) round a place.
template <class At>
auto bilinearAt(double x, double y, const At& at) {
    const int i = int(std::floor(x)), j = int(std::floor(y));
    return mix(mix(at(i, j), at(i + 1, j), x - i), mix(at(i, j + 1), at(i + 1, j + 1), x - i), y - j);
}

// The point between `low`, where a test holds, and `high`, where it fails, at which it begins to fail.
template <class Test>
double bisected(double low, double high, const Test& holds) {
    for (int k = 0; k < 70; ++k) {
        const double middle = (low + high) / 2;
        (holds(middle) ? low : high) = middle;
    }
    return (low + high) / 2;
}

// Largest magnitude: the norm that the adaptive quadrature steers by.
inline double magnitude(double a) {
    return std::abs(a);
}
inline double magnitude(Vec3 a) {
    return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
}

}  // namespace reference
