// A glTF file taken over as a scene of this library: what `pellucid import` and Python's files.load_gltf have in common.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "io/gltf/gltf_scene.h"

namespace pellucid::io {

struct GltfImportOptions {
    std::vector<std::string> profiles;  // PROFILE of all materials, or MATERIAL=PROFILE of one, in place of what the file says
    double unitMm = 1000;  // millimetres per unit; glTF's unit is the metre
    std::optional<double> lights;  // factor of the lights' brightness; none: chosen so that the picture is well exposed
};

struct ImportedGltf {
    GltfScene gltf;  // positions, cameras and lights in mm; warnings also of what was left out here
    std::vector<std::string> names;  // of materials, fit for files
    std::vector<GltfLook> looks;     // of each material
    SceneFile scene;  // materials from 1 on in the file's order; lights, or one lamp; the first camera's place
    bool lampAdded = false;  // the file has no light
    double lightFactor = 1;  // what the lights of the file were multiplied by
};

// Throws FileError as readGltf does, std::invalid_argument for a material in `profiles` that the file does not have.
ImportedGltf importGltf(const std::string& path, const GltfImportOptions& options = {});
// The same of a scene that was read already.
ImportedGltf importScene(GltfScene scene, const GltfImportOptions& options = {});

// Writes scene.toml, mesh.obj with mesh.mtl, and NAME.toml of each profile into `folder`, which exists.
void writeImported(const std::string& folder, const ImportedGltf& imported);

}  // namespace pellucid::io
