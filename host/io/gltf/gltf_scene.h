// A glTF's materials and lights as those of a scene file. Lengths become millimetres.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "io/gltf/gltf_file.h"
#include "io/scene/scene_file.h"

namespace pellucid::io {

struct GltfLook {
    SceneMaterial material;   // its profile: one of the library, or "NAME.toml" of profileText
    Triple albedo{};          // without the texture
    std::string profileName;  // of a profile made for it; "" if there is none
    std::string profileText;  // the profile file
    std::string how;  // what it was taken for, for the report: "plain", "metal", "clear", "volume", "thin sheet", "profile"
};

// Material `id`. `profile`: of the library or a .toml, in place of what the file says; "": what the file says.
GltfLook lookOf(const GltfMaterial& material, const std::string& name, uint32_t id, const std::string& profile);

// Of a light whose position and range are in millimetres. `brightness` multiplies its colour.
SceneLight sceneLight(const GltfLight& light, double brightness);

// Names that are fit for files and keys: letters, digits, _ and -; each another one.
std::vector<std::string> plainNames(const std::vector<GltfMaterial>& materials);

// What a half-space reflects, to the albedo of one scattering [Kulla and Conty 2017, from van de Hulst].
double singleScatterAlbedo(double multiscatter, double anisotropy);

}  // namespace pellucid::io
