// Scenes of glTF 2.0 (.gltf, .glb): triangles in the world, materials, cameras and lights as plain data
// [Khronos, glTF 2.0 Specification]. docs/guide/gltf.md says what is left out with a warning.
#pragma once
#include <Imath/ImathVec.h>

#include <cmath>

#include "io/mesh/mesh_file.h"
#include "io/scene/scene_file.h"

namespace pellucid::io {

using Triple = Imath::V3d;

inline Triple vectorOf(const float* v) {
    return {v[0], v[1], v[2]};
}

// An encoded picture.
struct GltfImage {
    std::string name;   // for messages; ends with .png or .jpg
    std::string bytes;  // of the PNG or JPEG file; empty for other formats
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
    // KHR_materials_volume: after attenuationDistance the fraction attenuationColor of light remains. A
    // thickness of 0 is a thin wall.
    double thickness = 0, attenuationDistance = INFINITY;
    Triple attenuationColor{1, 1, 1};
    // KHR_materials_volume_scatter (in its draft KHR_materials_scatter): the albedo of a half-space.
    std::optional<Triple> multiscatterColor;
    double scatterAnisotropy = 0;  // -1 to 1
};

struct GltfCamera {
    Triple position{0, 0, 0}, forward{0, 0, -1}, up{0, 1, 0};  // world; unit
    double verticalFov = 0;                                    // radians
    double aspect = 0;                                         // width / height; 0: the picture's own
};

struct GltfScene {
    MeshData mesh;                        // normals always; uvs or none; in the pose of the nodes
    std::vector<uint32_t> materialOf;     // index of `materials` per triangle
    std::vector<GltfMaterial> materials;  // those that are used, in the file's order
    std::vector<GltfImage> images;
    std::vector<GltfCamera> cameras;  // perspective cameras in the order of nodes
    std::vector<SceneLight> lights;
};

// Reads a file that the scene names by a relative path without "..", "." or a scheme; percent signs decoded.
using GltfResource = std::function<std::string(const std::string& relative)>;

// Throws FileError, whose message names the place in the file ("meshes[2].primitives[0].indices"): damaged,
// an index that leads to nothing, bytes outside a buffer, positions that are not finite, a node above
// itself, an extension that is required and unknown, no triangle.
GltfScene decodeGltf(const std::string& path, const std::string& bytes, const GltfResource& resource);
// Files are found beside `path`.
GltfScene readGltf(const std::string& path);

}  // namespace pellucid::io
