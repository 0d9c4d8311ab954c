// Bodies for scenes of scattering: a ball, a relief, heads and parts of them.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "io/mesh/mesh_parts.h"
#include "sample/camera.h"
#include "sample/scene.h"

namespace lit_scenes {

using pellucid::sample::Vec3;
namespace sample = pellucid::sample;
namespace io = pellucid::io;

struct Body {
    std::string name;
    sample::Mesh mesh;  // mm
    sample::HeadPose pose;
    sample::Bounds focus = {};  // what a picture shows; empty: all of it
};

inline Body ball(double radius, int rings) {
    return {"ball", sample::makeSphere(radius, rings, 2 * rings), {}};
}

// Walls and a floor for a square of (cells + 1)^2 vertices: without them light from below would come
// through a body that has no thickness.
inline void closeBelow(sample::Mesh& mesh, int cells, float floor) {
    const auto top = [&](int k) {  // counter-clockwise round the square, seen from above
        const int side = k / cells % 4, i = k % cells, n = cells + 1;
        return uint32_t(side == 0   ? i
                        : side == 1 ? i * n + cells
                        : side == 2 ? cells * n + cells - i
                                    : (cells - i) * n);
    };
    const Vec3 outward[] = {{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
    const auto add = [&](uint32_t from, bool low, Vec3 normal) {
        for (int c = 0; c < 3; ++c)
            mesh.positions.push_back(low && c == 2 ? floor : mesh.positions[3 * size_t(from) + size_t(c)]);
        for (double n : {normal.x, normal.y, normal.z}) mesh.normals.push_back(float(n));
        return uint32_t(mesh.positions.size() / 3 - 1);
    };
    for (int k = 0; k < 4 * cells; ++k) {
        const uint32_t a = top(k), b = top(k + 1);
        const Vec3 n = outward[k / cells];
        const uint32_t corners[] = {add(a, true, n), add(b, true, n), add(b, false, n), add(a, false, n)};
        for (int i : {0, 1, 2, 0, 2, 3}) mesh.triangles.push_back(corners[i]);
    }
    const uint32_t a = add(top(0), true, {0, 0, -1}), b = add(top(cells), true, {0, 0, -1}),
                   c = add(top(2 * cells), true, {0, 0, -1}), d = add(top(3 * cells), true, {0, 0, -1});
    for (uint32_t v : {a, c, b, a, d, c}) mesh.triangles.push_back(v);
}

// A square of relief: a monkey saddle with a ridge and a pit in it, curved both ways at every scale down to 1
// mm.
inline Body relief(int cells) {
    Body body{"relief", {}, {{0, 1, 0}, {0, 0, 1}}};
    const double half = 15;
    const auto height = [](double x, double y) {
        const double u = x / 12, v = y / 12;
        return 3 * (u * u * u - 3 * u * v * v) + 2.5 * std::exp(-(x - 4) * (x - 4) / 2.5) -
               3 * std::exp(-((x + 5) * (x + 5) + (y - 3) * (y - 3)) / 5);
    };
    for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) {
            const double x = half * (2.0 * i / cells - 1), y = half * (2.0 * j / cells - 1), e = 1e-4;
            const Vec3 n = normalize(Vec3{-(height(x + e, y) - height(x - e, y)) / (2 * e),
                                          -(height(x, y + e) - height(x, y - e)) / (2 * e), 1});
            for (double p : {x, y, height(x, y)}) body.mesh.positions.push_back(float(p));
            for (double p : {n.x, n.y, n.z}) body.mesh.normals.push_back(float(p));
        }
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const uint32_t a = uint32_t(j * (cells + 1) + i), b = a + uint32_t(cells) + 1;
            for (uint32_t v : {a, a + 1, b, b, a + 1, b + 1}) body.mesh.triangles.push_back(v);
        }
    closeBelow(body.mesh, cells, -12);
    return body;
}

// One of data/heads, subdivided: skin is material 1, all else only throws shadows (2).
inline Body head(const std::string& path, const std::string& name, int levels) {
    io::PartedMesh parted = io::loadParts(path, levels);
    Body body{name, {}, {{0, 1, 0}, {0, 0, 1}}};
    if (parted.mesh.normals.empty()) io::computeNormals(parted.mesh);
    body.mesh.positions = parted.mesh.positions;
    body.mesh.normals = parted.mesh.normals;
    body.mesh.triangles = parted.mesh.triangles;
    for (uint32_t part : parted.partOf)
        body.mesh.materials.push_back(part == uint32_t(parted.part("skin")) ? 1 : 2);
    return body;
}

// The part of a body round one of its vertices, `size` mm a side.
inline Body closeUp(Body body, const std::string& name, const std::function<double(Vec3)>& foremost,
                    double size) {
    Vec3 best{};
    for (size_t v = 0; 3 * v < body.mesh.positions.size(); ++v) {
        const float* p = &body.mesh.positions[3 * v];
        const Vec3 at{p[0], p[1], p[2]};
        if (v == 0 || foremost(at) > foremost(best)) best = at;
    }
    const Vec3 half = Vec3{1, 1, 1} * (size / 2);
    body.focus = sample::Bounds();
    body.focus.add(best - half);
    body.focus.add(best + half);
    body.name += " " + name;
    return body;
}

}  // namespace lit_scenes
