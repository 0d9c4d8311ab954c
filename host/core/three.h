// Three numbers in double precision: vectors and colours.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

namespace pel {

using Three = std::array<double, 3>;

// {of(0), of(1), of(2)}
template <class OfIndex>
Three threeOf(const OfIndex& of) {
    return {of(0), of(1), of(2)};
}
template <class Number>
Three threeAt(const Number* values) {
    return {double(values[0]), double(values[1]), double(values[2])};
}
inline Three operator+(const Three& a, const Three& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Three operator-(const Three& a, const Three& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Three operator*(double k, const Three& a) {
    return {k * a[0], k * a[1], k * a[2]};
}
inline Three operator/(const Three& a, double k) {
    return {a[0] / k, a[1] / k, a[2] / k};
}
inline Three& operator+=(Three& a, const Three& b) {
    return a = a + b;
}
inline double dot(const Three& a, const Three& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Three& a) {
    return std::sqrt(dot(a, a));
}
inline Three cross(const Three& a, const Three& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double largest(const Three& v) {
    return std::max({v[0], v[1], v[2]});
}
inline double smallest(const Three& v) {
    return std::min({v[0], v[1], v[2]});
}

}  // namespace pel
