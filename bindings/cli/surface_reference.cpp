#include "surface_reference.h"

#include <cmath>

#include "io/file_error.h"
#include "io/input_file.h"
#include "io/mesh/mesh_parts.h"

namespace pellucid::cli {
namespace {

sample::Vec3 vectorOf(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

// Irradiance / pi of the ambient light along n: real spherical harmonics of order 2 [Ramamoorthi & Hanrahan
// 2001].
std::array<double, 3> ambientAlong(const PelAmbient& ambient, sample::Vec3 n) {
    const double basis[9] = {0.282095,
                             0.488603 * n.y,
                             0.488603 * n.z,
                             0.488603 * n.x,
                             1.092548 * n.x * n.y,
                             1.092548 * n.y * n.z,
                             0.315392 * (3 * n.z * n.z - 1),
                             1.092548 * n.x * n.z,
                             0.546274 * (n.x * n.x - n.y * n.y)};
    std::array<double, 3> sum;
    for (int c = 0; c < 3; ++c) {
        sum[c] = ambient.constant[c];
        for (int i = 0; i < 9; ++i) sum[c] += basis[i] * ambient.sh[i][c];
        sum[c] = std::max(0.0, sum[c]);
    }
    return sum;
}

}  // namespace

sample::Lighting lightingOf(const io::SceneFile& scene) {
    sample::Lighting lighting;
    for (const io::SceneLight& l : scene.lights) {
        sample::SurfaceLight light;
        light.type = sample::SurfaceLight::Type(l.light.type);
        light.toLight = normalize(vectorOf(l.light.toLight));
        light.position = vectorOf(l.light.position);
        light.spotDirection = normalize(vectorOf(l.light.spotDirection));
        light.spotCosInner = l.light.spotCosInner;
        light.spotCosOuter = l.light.spotCosOuter;
        light.range = l.light.range;
        for (int c = 0; c < 3; ++c) light.color[c] = l.light.color[c];
        lighting.lights.push_back(light);
    }
    bool ambient = false;
    for (float v : scene.ambient.constant) ambient = ambient || v != 0;
    for (const auto& row : scene.ambient.sh)
        for (float v : row) ambient = ambient || v != 0;
    if (ambient) lighting.ambient = [a = scene.ambient](sample::Vec3 n) { return ambientAlong(a, n); };
    return lighting;
}

ReferenceMesh loadReferenceMesh(const std::string& path, int subdivide, const std::string& part) {
    ReferenceMesh out;
    if (io::extensionOf(path) == "obj" && (subdivide > 0 || !part.empty())) {
        io::PartedMesh parted = io::loadParts(path, subdivide);
        if (!part.empty()) {
            const int wanted = parted.part(part);
            if (wanted < 0) {
                std::string names;
                for (const std::string& name : parted.parts) names += (names.empty() ? "" : ", ") + name;
                throw io::FileError(path, "has no part '" + part + "'; it has: " + names);
            }
            for (uint32_t p : parted.partOf) out.materials.push_back(p == uint32_t(wanted) ? 1 : 2);
        }
        out.mesh = std::move(parted.mesh);
    } else {
        if (!part.empty()) throw io::FileError(path, "has no parts; only the groups of an OBJ file are");
        out.mesh = io::loadMesh(path);
        io::loopSubdivide(out.mesh, subdivide);
    }
    if (out.mesh.normals.empty()) io::computeNormals(out.mesh);
    return out;
}

}  // namespace pellucid::cli
