// Materials, cameras and lights of a glTF.
#pragma once
#include "gltf/gltf_document.h"

namespace pellucid::io {

// Features that are not imported are added to `warnings`.
GltfMaterial readGltfMaterial(const GltfDocument& document, const GltfValue& material,
                              std::vector<std::string>& warnings);
// A light of KHR_lights_punctual, at the origin.
GltfLight readGltfLight(const GltfValue& light);

}  // namespace pellucid::io
