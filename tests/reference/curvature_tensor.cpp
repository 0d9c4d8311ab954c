#include "reference/curvature.h"

namespace reference {
namespace {

// A symmetric bilinear form on space that vanishes along one normal: uu u u' + uv (u v' + v u') + vv v v'.
struct TangentForm {
    Vec3 u, v;  // orthonormal, in the tangent plane
    double uu = 0, uv = 0, vv = 0;
    double operator()(Vec3 a, Vec3 b) const {
        const double au = dot(a, u), av = dot(a, v), bu = dot(b, u), bv = dot(b, v);
        return uu * au * bu + uv * (au * bv + av * bu) + vv * av * bv;
    }
};

// Solves the symmetric 3x3 system by Cramer's rule.
Vec3 solve(Vec3 row0, Vec3 row1, Vec3 row2, Vec3 right) {
    const double determinant = dot(row0, cross(row1, row2));
    return (right.x * cross(row1, row2) + right.y * cross(row2, row0) + right.z * cross(row0, row1)) /
           determinant;
}

TangentForm faceForm(const Vec3 (&p)[3], const Vec3 (&n)[3]) {
    TangentForm form;
    form.u = normalized(p[1] - p[0]);
    form.v = normalized(cross(cross(p[1] - p[0], p[2] - p[0]), form.u));
    // Normal equations of: II (edge) = normal difference, six equations for (uu, uv, vv).
    double a = 0, b = 0, c = 0;
    Vec3 right;
    for (int i = 0; i < 3; ++i) {
        const Vec3 edge = p[(i + 1) % 3] - p[i], turn = n[(i + 1) % 3] - n[i];
        const double eu = dot(edge, form.u), ev = dot(edge, form.v);
        const double tu = dot(turn, form.u), tv = dot(turn, form.v);
        a += eu * eu;
        b += eu * ev;
        c += ev * ev;
        right = right + Vec3{eu * tu, ev * tu + eu * tv, ev * tv};
    }
    const Vec3 solution = solve({a, b, 0}, {b, a + c, b}, {0, b, c}, right);
    form.uu = solution.x;
    form.uv = solution.y;
    form.vv = solution.z;
    return form;
}

// The shortest rotation that takes unit vector from to unit vector to, applied to x (Rodrigues).
Vec3 rotated(Vec3 x, Vec3 from, Vec3 to) {
    const Vec3 axis = cross(from, to);
    const double cosine = dot(from, to);
    if (cosine <= -1) return -1.0 * x;  // no shortest rotation: the form does not see the sign
    return cosine * x + cross(axis, x) + dot(axis, x) / (1 + cosine) * axis;
}

}  // namespace

std::array<double, 3> voronoiAreas(Vec3 a, Vec3 b, Vec3 c) {
    const Vec3 corner[3] = {a, b, c};
    const double doubled = length(cross(b - a, c - a));
    double cosine[3], side2[3];  // unnormalised cosine at each corner; squared length opposite to it
    for (int i = 0; i < 3; ++i) {
        const Vec3 one = corner[(i + 1) % 3] - corner[i], two = corner[(i + 2) % 3] - corner[i];
        cosine[i] = dot(one, two);
        side2[i] = dot(two - one, two - one);
    }
    std::array<double, 3> areas{};
    if (!(doubled > 0)) return areas;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        if (cosine[i] > 0) continue;
        // Obtuse at i: the other two corners keep right triangles with half a leg and the angle there.
        areas[j] = side2[k] / 8 * doubled / cosine[j];
        areas[k] = side2[j] / 8 * doubled / cosine[k];
        areas[i] = 0.5 * doubled - areas[j] - areas[k];
        return areas;
    }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        areas[i] = (side2[k] * cosine[k] + side2[j] * cosine[j]) / (8 * doubled);
    }
    return areas;
}

std::vector<PrincipalCurvatures> tensorCurvature(const Mesh& mesh) {
    const size_t count = mesh.positions.size();
    std::vector<TangentForm> forms(count);
    std::vector<double> weights(count, 0.0);
    for (size_t i = 0; i < count; ++i) {
        const Vec3 n = mesh.normals[i];
        const Vec3 other = std::abs(n.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        if (!(length(n) > 0)) continue;
        forms[i].u = normalized(cross(n, other));
        forms[i].v = normalized(cross(n, forms[i].u));
    }
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3 p[3] = {mesh.positions[triangle[0]], mesh.positions[triangle[1]],
                           mesh.positions[triangle[2]]};
        const Vec3 n[3] = {mesh.normals[triangle[0]], mesh.normals[triangle[1]], mesh.normals[triangle[2]]};
        const Vec3 across = cross(p[1] - p[0], p[2] - p[0]);
        if (!(length(across) > 0)) continue;
        const TangentForm face = faceForm(p, n);
        const auto areas = voronoiAreas(p[0], p[1], p[2]);
        for (int i = 0; i < 3; ++i) {
            TangentForm& form = forms[triangle[i]];
            const Vec3 facing = normalized(dot(across, n[i]) < 0 ? -1.0 * across : across);
            const Vec3 u = rotated(form.u, n[i], facing), v = rotated(form.v, n[i], facing);
            form.uu += areas[i] * face(u, u);
            form.uv += areas[i] * face(u, v);
            form.vv += areas[i] * face(v, v);
            weights[triangle[i]] += areas[i];
        }
    }
    std::vector<PrincipalCurvatures> curvatures(count);
    for (size_t i = 0; i < count; ++i) {
        if (!(weights[i] > 0)) continue;
        const double uu = forms[i].uu / weights[i], uv = forms[i].uv / weights[i],
                     vv = forms[i].vv / weights[i];
        const double mean = 0.5 * (uu + vv), radius = std::hypot(0.5 * (uu - vv), uv);
        curvatures[i] = {mean + radius, mean - radius};
    }
    return curvatures;
}

}  // namespace reference
