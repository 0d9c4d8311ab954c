#include "sample/vector.h"

#include <algorithm>
#include <stdexcept>

namespace pellucid::sample {

Vec3 perpendicular(Vec3 direction, Vec3 wish) {
    const Vec3 d = normalize(direction);
    const auto across = [&](Vec3 v) { return v - d * dot(v, d); };
    if (Vec3 v = across(wish); length(v) > 1e-6 * length(wish)) return normalize(v);
    const bool alongX = std::abs(d.x) > std::abs(d.y);
    return normalize(across(alongX ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
}

std::array<float, 16> Matrix4::toFloats() const {
    std::array<float, 16> f;
    std::transform(m.begin(), m.end(), f.begin(), [](double v) { return float(v); });
    return f;
}

Vec3 Matrix4::project(Vec3 p) const {
    const auto row = [&](int i) {
        return m[4 * i] * p.x + m[4 * i + 1] * p.y + m[4 * i + 2] * p.z + m[4 * i + 3];
    };
    return {row(0) / row(3), row(1) / row(3), row(2) / row(3)};
}

Matrix4 operator*(const Matrix4& a, const Matrix4& b) {
    Matrix4 r;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            double sum = 0;
            for (int k = 0; k < 4; ++k) sum += a.m[4 * i + k] * b.m[4 * k + j];
            r.m[4 * i + j] = sum;
        }
    return r;
}

// Gauss-Jordan elimination with row pivoting.
Matrix4 Matrix4::inverse() const {
    Matrix4 a = *this, r;
    for (int column = 0; column < 4; ++column) {
        int pivot = column;
        for (int i = column + 1; i < 4; ++i)
            if (std::abs(a.m[4 * i + column]) > std::abs(a.m[4 * pivot + column])) pivot = i;
        const double p = a.m[4 * pivot + column];
        if (p == 0 || !std::isfinite(p)) throw std::domain_error("a matrix without an inverse");
        for (int j = 0; j < 4; ++j) {
            std::swap(a.m[4 * column + j], a.m[4 * pivot + j]);
            std::swap(r.m[4 * column + j], r.m[4 * pivot + j]);
        }
        for (int j = 0; j < 4; ++j) {
            a.m[4 * column + j] /= p;
            r.m[4 * column + j] /= p;
        }
        for (int i = 0; i < 4; ++i) {
            const double f = a.m[4 * i + column];
            if (i == column || f == 0) continue;
            for (int j = 0; j < 4; ++j) {
                a.m[4 * i + j] -= f * a.m[4 * column + j];
                r.m[4 * i + j] -= f * r.m[4 * column + j];
            }
        }
    }
    return r;
}

}  // namespace pellucid::sample
