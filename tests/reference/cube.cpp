#include "reference/cube.h"

namespace reference {

const CubeFace cubeFaces[6] = {{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                               {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},   {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                               {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}};

namespace {

Rgb texel(const CubeMap& cube, int face, int x, int y) {
    const Rgb& c = cube.at(face, x, y);
    return {max0(c.x), max0(c.y), max0(c.z)};
}

double centre(int i, int size) {
    return (2 * i + 1.0) / size - 1;
}

// Bilinear on one face alone, clamped to the outermost centres.
Rgb onFace(const CubeMap& cube, int face, double s, double t) {
    const int n = cube.size;
    const double x = std::clamp((s + 1) / 2 * n - 0.5, 0.0, n - 1.0),
                 y = std::clamp((t + 1) / 2 * n - 0.5, 0.0, n - 1.0);
    const int x0 = std::min(int(x), std::max(n - 2, 0)), y0 = std::min(int(y), std::max(n - 2, 0));
    const int x1 = std::min(x0 + 1, n - 1), y1 = std::min(y0 + 1, n - 1);
    return mix(mix(texel(cube, face, x0, y0), texel(cube, face, x1, y0), x - x0),
               mix(texel(cube, face, x0, y1), texel(cube, face, x1, y1), x - x0), y - y0);
}

// Light at a point of the cube's surface on an edge or corner: the mean of all faces that have it. On an
// edge, texels half a texel inside stand for a point that lies further out by 1 / (1 - 1/2n) once they are
// averaged.
Rgb onEdge(const CubeMap& cube, Vec3 point) {
    int meeting = 0;
    for (int c = 0; c < 3; ++c) meeting += std::abs(std::abs(point[c]) - 1) < 1e-12;
    Rgb sum;
    for (const CubeFace& f : cubeFaces) {
        if (dot(f.out, point) < 1 - 1e-12) continue;
        const double inward = meeting == 2 ? 1 - 0.5 / cube.size : 1;
        double s = dot(f.right, point), t = dot(f.down, point);
        if (std::abs(std::abs(s) - 1) > 1e-12) s *= inward;
        if (std::abs(std::abs(t) - 1) > 1e-12) t *= inward;
        sum = sum + onFace(cube, int(&f - cubeFaces), s, t);
    }
    return sum / meeting;
}

}  // namespace

Vec3 cubeDirection(int face, double s, double t) {
    return cubeFaces[face].out + s * cubeFaces[face].right + t * cubeFaces[face].down;
}

Rgb sampleCube(const CubeMap& cube, Vec3 d) {
    if (dot(d, d) == 0) return {};
    int face = 0;
    for (int f = 1; f < 6; ++f)
        if (dot(cubeFaces[f].out, d) > dot(cubeFaces[face].out, d)) face = f;
    const Vec3 p = d / dot(cubeFaces[face].out, d);
    const double s = dot(cubeFaces[face].right, p), t = dot(cubeFaces[face].down, p);
    // Knots of the interpolation along each side: -1, the centres, 1.
    std::vector<double> knots{-1};
    for (int i = 0; i < cube.size; ++i) knots.push_back(centre(i, cube.size));
    knots.push_back(1);
    const auto before = [&](double v) {
        int k = 0;
        while (k + 2 < int(knots.size()) && knots[k + 1] <= v) ++k;
        return k;
    };
    const int i = before(s), j = before(t);
    const auto knot = [&](int x, int y) {
        const bool inside = x > 0 && x <= cube.size && y > 0 && y <= cube.size;
        return inside ? texel(cube, face, x - 1, y - 1)
                      : onEdge(cube, cubeDirection(face, knots[x], knots[y]));
    };
    const double fs = (s - knots[i]) / (knots[i + 1] - knots[i]),
                 ft = (t - knots[j]) / (knots[j + 1] - knots[j]);
    return mix(mix(knot(i, j), knot(i + 1, j), fs), mix(knot(i, j + 1), knot(i + 1, j + 1), fs), ft);
}

}  // namespace reference
