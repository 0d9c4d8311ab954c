// A glTF's materials and lights as those of a scene file. Lengths become millimetres.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "gltf/gltf_file.h"
#include "io/scene/scene_file.h"

namespace pellucid::io {

struct GltfLook {
    SceneMaterial material;   // its profile: one of the library, or "NAME.toml" of profileText
    Triple albedo{};          // without the texture
    std::string profileName;  // of a profile made for it; "" if there is none
    std::string profileText;  // the profile file
    // How the material was imported, for the report: "plain", "metal", "clear", "volume", "thin sheet",
    // "profile"
    std::string how;
};

// Material `id`. `profile`: a profile of the library or a .toml file that replaces the volume of the glTF
// material; "" keeps it.
GltfLook lookOf(const GltfMaterial& material, const std::string& name, uint32_t id,
                const std::string& profile);

// Of a light whose position and range are in millimetres. `brightness` multiplies its colour.
SceneLight sceneLight(const GltfLight& light, double brightness);

// Unique names of letters, digits, _ and -, for files and keys.
std::vector<std::string> plainNames(const std::vector<GltfMaterial>& materials);

// Single-scattering albedo of a medium whose half-space has this albedo [Kulla and Conty 2017, from van de
// Hulst].
double singleScatterAlbedo(double multiscatter, double anisotropy);

}  // namespace pellucid::io
