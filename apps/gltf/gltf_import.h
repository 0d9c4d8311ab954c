// Imports a glTF file as a scene of this library, for `pellucid import` and Python's load_gltf.
#pragma once

#include "gltf/gltf_file.h"

namespace pellucid::io {

struct GltfLook {
    SceneMaterial material;   // its profile: one of the library, or "NAME.toml" of profileText
    Triple albedo{0, 0, 0};   // without the texture
    std::string profileText;  // the file of a profile that was made for it, or ""
    // How the material was imported: "plain", "metal", "clear", "volume", "thin sheet", "profile"
    std::string how;
};

// Material `id`. `profile`: one of the library or a .toml file in place of the glTF material's volume, or "".
GltfLook lookOf(GltfMaterial material, const std::string& name, uint32_t id, const std::string& profile);

// Unique names of letters, digits, _ and -, for files and keys.
std::vector<std::string> plainNames(const std::vector<GltfMaterial>& materials);

// Single-scattering albedo of a medium whose half-space has this albedo [Kulla and Conty 2017].
double singleScatterAlbedo(double multiscatter, double anisotropy);

struct GltfImportOptions {
    // PROFILE of all materials, or MATERIAL=PROFILE of one, in place of what the file says
    std::vector<std::string> profiles;
    double unitMm = 1000;  // millimetres per unit; glTF's unit is the metre
    // Factor of the lights' brightness; none: chosen so that the picture is well exposed
    std::optional<double> lights;
};

struct ImportedGltf {
    GltfScene gltf;  // positions, cameras and lights in mm; warnings include those of the import
    std::vector<std::string> names;  // of materials, usable as file names
    std::vector<GltfLook> looks;     // of each material
    // Materials from 1 on in the file's order; lights, or one lamp; the first camera's place
    SceneFile scene;
    bool lampAdded = false;  // the file has no light
    double lightFactor = 1;  // what the lights of the file were multiplied by
};

// Throws FileError as readGltf does, std::invalid_argument for a material in `profiles` that the file does
// not have.
ImportedGltf importGltf(const std::string& path, const GltfImportOptions& options = {});
// The same of a scene that was read already.
ImportedGltf importScene(GltfScene scene, const GltfImportOptions& options = {});

// Writes scene.toml, mesh.obj with mesh.mtl, and NAME.toml of each profile into `folder`, which exists.
void writeImported(const std::string& folder, const ImportedGltf& imported);

}  // namespace pellucid::io
