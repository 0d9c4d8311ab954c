// Bodies for scenes of scattering: a ball, a relief, heads and parts of them.
#pragma once
#include "tools.h"

#include "io/mesh/mesh_parts.h"
#include "sample/camera.h"
#include "sample/scene.h"

namespace lit_scenes {

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

// An ellipsoid of 20 x 14 x 1 mm, flat as seen from the front.
inline Body leaf(int rings) {
    Body body{"leaf", sample::makeSphere(1, rings, 2 * rings), {{0, 1, 0}, {0, 0, 1}}};
    const double half[] = {10, 7, 0.5};
    for (size_t v = 0; v < body.mesh.positions.size(); v += 3) {
        float *p = &body.mesh.positions[v], *n = &body.mesh.normals[v];
        for (int k = 0; k < 3; ++k) n[k] = p[k] / float(half[k]), p[k] *= float(half[k]);
        const float length = std::hypot(n[0], n[1], n[2]);
        for (int k = 0; k < 3; ++k) n[k] /= length;
    }
    return body;
}

// A monkey saddle with a ridge and a pit in it, curved both ways at every scale down to 1 mm.
inline double saddle(double x, double y) {
    const double u = x / 12, v = y / 12;
    return 3 * (u * u * u - 3 * u * v * v) + 2.5 * std::exp(-(x - 4) * (x - 4) / 2.5) -
           3 * std::exp(-((x + 5) * (x + 5) + (y - 3) * (y - 3)) / 5);
}

// Pores 0.3 mm deep and 1.2 mm apart on skin that is slightly bent.
inline double pores(double x, double y) {
    const double a = std::cos(x * 5.236), b = std::cos((0.5 * x + 0.866 * y) * 5.236);
    return -0.02 * x * x - 0.3 * std::pow((2 + a + b) / 4, 4);
}

// A square of relief with walls and a floor, which block light from below.
inline Body relief(int cells, double half = 15, double (*height)(double, double) = saddle) {
    Body body{"relief", {}, {{0, 1, 0}, {0, 0, 1}}};
    sample::Mesh& mesh = body.mesh;
    const float floor = -12;
    const auto add = [&](sample::Vec3 p, sample::Vec3 n) {
        for (double v : {p.x, p.y, p.z}) mesh.positions.push_back(float(v));
        for (double v : {n.x, n.y, n.z}) mesh.normals.push_back(float(v));
        return uint32_t(mesh.positions.size() / 3 - 1);
    };
    const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        for (uint32_t v : {a, b, c, a, c, d}) mesh.triangles.push_back(v);
    };
    const int n = cells + 1;
    for (int k = 0; k < n * n; ++k) {
        const double x = half * (2.0 * (k % n) / cells - 1), y = half * (2.0 * (k / n) / cells - 1), e = 1e-4;
        add({x, y, height(x, y)},
            normalize(sample::Vec3{-(height(x + e, y) - height(x - e, y)) / (2 * e),
                                   -(height(x, y + e) - height(x, y - e)) / (2 * e), 1}));
    }
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const auto a = uint32_t(j * n + i), b = a + uint32_t(n);
            quad(b, a, a + 1, b + 1);
        }
    const auto rim = [&](int k, bool low,
                         sample::Vec3 normal) {  // counter-clockwise round the square, from above
        const int side = k / cells % 4, i = k % cells;
        const int v = side == 0 ? i : side == 1 ? i * n + cells : side == 2 ? n * n - 1 - i : (cells - i) * n;
        const float* p = &mesh.positions[3 * size_t(v)];
        return add({p[0], p[1], low ? floor : p[2]}, normal);
    };
    const sample::Vec3 outward[] = {{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}}, down{0, 0, -1};
    for (int k = 0; k < 4 * cells; ++k) {
        const sample::Vec3 out = outward[k / cells];
        const uint32_t a = rim(k, true, out), b = rim(k + 1, true, out), c = rim(k + 1, false, out);
        quad(a, b, c, rim(k, false, out));
    }
    const uint32_t a = rim(0, true, down), b = rim(cells, true, down), c = rim(2 * cells, true, down);
    quad(a, rim(3 * cells, true, down), c, b);
    return body;
}

#ifdef PELLUCID_SOURCE_DIR
// Where the files of heads are.
inline std::string headFile(const std::string& name) {
    const char* folder = std::getenv("PELLUCID_HEADS_DIR");
    return (folder ? std::string(folder) : std::string(PELLUCID_SOURCE_DIR) + "/data/heads") + "/" + name +
           ".obj";
}
#endif

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

// Two balls that touch, of materials 1 and 2.
inline Body twoBalls(double radius, int rings) {
    Body body{"two balls", sample::makeSphere(radius, rings, 2 * rings, {-radius, 0, 0}), {}};
    body.mesh.materials.assign(body.mesh.triangles.size() / 3, 1);
    sample::Mesh other = sample::makeSphere(radius, rings, 2 * rings, {radius, 0, 0});
    other.materials.assign(other.triangles.size() / 3, 2);
    body.mesh.append(other);
    return body;
}

// The vertex with the largest value.
inline sample::Vec3 foremostOf(const Body& body, const std::function<double(sample::Vec3)>& value) {
    sample::Vec3 best{};
    for (size_t v = 0; 3 * v < body.mesh.positions.size(); ++v) {
        const float* p = &body.mesh.positions[3 * v];
        const sample::Vec3 at{p[0], p[1], p[2]};
        if (v == 0 || value(at) > value(best)) best = at;
    }
    return best;
}

// The part of a body round one of its vertices, `size` mm a side.
inline Body closeUp(Body body, const std::string& name, const std::function<double(sample::Vec3)>& foremost,
                    double size) {
    const sample::Vec3 best = foremostOf(body, foremost);
    const sample::Vec3 half = sample::Vec3{1, 1, 1} * (size / 2);
    body.focus = sample::Bounds();
    body.focus.add(best - half);
    body.focus.add(best + half);
    body.name += " " + name;
    return body;
}

}  // namespace lit_scenes
