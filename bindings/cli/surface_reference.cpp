#include "surface_reference.h"

#include <charconv>
#include <cmath>

#include "command.h"
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

namespace {

constexpr uint32_t shadowOnly = 255;

// The id of each triangle: that of its group, or shadowOnly.
std::vector<uint32_t> idsOf(const std::string& path, const io::PartedMesh& mesh,
                            const std::vector<std::string>& parts, bool byMaterial) {
    std::vector<uint32_t> ids(mesh.partOf.size(), shadowOnly);
    for (const std::string& part : parts) {
        const size_t equals = part.find('=');
        const std::string name = byMaterial ? part.substr(equals + 1) : part;
        uint32_t id = 1;
        if (byMaterial) {
            const char *text = part.data(), *end = text + std::min(equals, part.size());
            const auto [stopped, error] = std::from_chars(text, end, id);
            if (error != std::errc() || stopped != end || id == 0 || id >= shadowOnly)
                throw UsageError("--part " + part +
                                 ": several parts are written ID=GROUP, with an id from 1 to " +
                                 std::to_string(shadowOnly - 1));
        }
        const int wanted = mesh.part(name);
        if (wanted < 0) {
            std::string names;
            for (const std::string& known : mesh.parts) names += (names.empty() ? "" : ", ") + known;
            throw io::FileError(path, "has no part '" + name + "'; it has: " + names);
        }
        for (size_t t = 0; t < ids.size(); ++t)
            if (mesh.partOf[t] == uint32_t(wanted)) ids[t] = id;
    }
    return ids;
}

}  // namespace

ReferenceMesh loadReferenceMesh(const std::string& path, int subdivide,
                                const std::vector<std::string>& parts) {
    ReferenceMesh out;
    if (io::extensionOf(path) == "obj" && (subdivide > 0 || !parts.empty())) {
        io::PartedMesh parted = io::loadParts(path, subdivide);
        out.byMaterial = parts.size() > 1 || (parts.size() == 1 && parts[0].find('=') != std::string::npos &&
                                              parted.part(parts[0]) < 0);
        if (!parts.empty()) out.materials = idsOf(path, parted, parts, out.byMaterial);
        out.mesh = std::move(parted.mesh);
    } else {
        if (!parts.empty()) throw io::FileError(path, "has no parts; only the groups of an OBJ file are");
        out.mesh = io::loadMesh(path);
        io::loopSubdivide(out.mesh, subdivide);
    }
    if (out.mesh.normals.empty()) io::computeNormals(out.mesh);
    return out;
}

}  // namespace pellucid::cli
