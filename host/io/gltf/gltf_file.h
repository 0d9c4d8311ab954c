// Scenes of glTF 2.0 (.gltf, .glb): triangles in the world, materials, cameras and lights as plain data. What is read, and
// what is left out with a warning, is in docs/guide/gltf.md. Source: Khronos Group, glTF 2.0 Specification.
#pragma once
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace pellucid::io {

using Triple = std::array<double, 3>;

// A picture as the file has it.
struct GltfImage {
    std::string name;   // for messages; ends with the extension of its format: .png or .jpg
    std::string bytes;  // of the PNG or JPEG; empty: of another format
};

// Lengths are in metres.
struct GltfMaterial {
    std::string name;
    Triple baseColor{1, 1, 1};  // linear
    int baseColorImage = -1;    // index of `images`, or -1; with the mesh's UVs, repeated
    double metallic = 1, roughness = 1, ior = 1.5, specular = 1;
    double transmission = 0;         // KHR_materials_transmission
    double diffuseTransmission = 0;  // KHR_materials_diffuse_transmission
    Triple diffuseTransmissionColor{1, 1, 1};
    // KHR_materials_volume: of a path that long the share `attenuationColor` of light is left. Thickness 0: a thin wall.
    double thickness = 0, attenuationDistance = INFINITY;
    Triple attenuationColor{1, 1, 1};
    // KHR_materials_volume_scatter (KHR_materials_scatter in its draft): what a half-space of the medium reflects.
    std::optional<Triple> multiscatterColor;
    double scatterAnisotropy = 0;  // -1 to 1
};

struct GltfCamera {
    Triple position{}, forward{0, 0, -1}, up{0, 1, 0};  // world; unit
    double verticalFov = 0;                             // radians
    double aspect = 0;                                  // width / height; 0: the picture's own
};

struct GltfLight {
    enum class Kind { Directional, Point, Spot } kind = Kind::Directional;
    Triple color{1, 1, 1};
    double intensity = 1;                   // lux, or candela
    double range = 0;                       // 0: no limit
    double innerCone = 0, outerCone = 0.7;  // radians, of spots
    Triple position{}, forward{0, 0, -1};   // world; unit
};

struct GltfScene {
    MeshData mesh;                        // normals always; uvs or none; rest pose
    std::vector<uint32_t> materialOf;     // index of `materials` per triangle
    std::vector<GltfMaterial> materials;  // those that are used, in the file's order
    std::vector<GltfImage> images;
    std::vector<GltfCamera> cameras;  // perspective ones, in the order of nodes
    std::vector<GltfLight> lights;
};

// Bytes of a file that the scene names: a relative path without "..", "." or a scheme, percent signs decoded.
using GltfResource = std::function<std::string(const std::string& relative)>;

// Throws FileError, whose message names the place in the file ("meshes[2].primitives[0].indices"): damaged, an index that leads to nothing,
// bytes outside a buffer, positions that are not finite, a node above itself, an extension that is required and unknown, no triangle.
GltfScene decodeGltf(const std::string& path, const std::string& bytes, const GltfResource& resource);
// Files are found beside `path`.
GltfScene readGltf(const std::string& path);

}  // namespace pellucid::io
