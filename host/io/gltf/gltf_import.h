// A glTF file taken over as a scene of this library: what `pellucid import` and Python's files.load_gltf have in common.
#pragma once
#include <string>
#include <vector>

#include "io/gltf/gltf_scene.h"

namespace pellucid::io {

struct GltfImportOptions {
    std::vector<std::string> profiles;  // PROFILE of all materials, or MATERIAL=PROFILE of one, in place of what the file says
    double unitMm = 1000;  // millimetres per unit; glTF's unit is the metre
    double lights = 1;     // factor of the lights' brightness
};

struct ImportedGltf {
    GltfScene gltf;  // positions, cameras and lights in mm; warnings also of what was left out here
    std::vector<std::string> names;  // of materials, fit for files
    std::vector<GltfLook> looks;     // of each material
    SceneFile scene;  // materials from 1 on in the file's order; lights, or one lamp; the first camera's place
    bool lampAdded = false;  // the file has no light
};

// Throws FileError as readGltf does and where there are more than 255 materials, std::invalid_argument for a material in `profiles` that
// the file does not have.
ImportedGltf importGltf(const std::string& path, const GltfImportOptions& options = {});

// Writes scene.toml, mesh.obj with mesh.mtl, and NAME.toml of each profile into `folder`, which exists.
void writeImported(const std::string& folder, const ImportedGltf& imported);

}  // namespace pellucid::io
