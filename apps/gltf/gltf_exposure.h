// How bright the lights of an imported scene make its surface, before anything is drawn.
#pragma once
#include "gltf/gltf_import.h"

namespace pellucid::io {

// A factor of the lights' brightness: 1 if the bright parts of the scene are between 2 % and 100 % of
// white, and otherwise one that makes them 80 %. Cameras have an exposure; glTF files do not say which.
double chosenLightFactor(const ImportedGltf& imported);

// The share of the lit surface that is brighter than white under the lights of imported.scene. Shadows and
// scattering are left out.
double clippedShare(const ImportedGltf& imported);

}  // namespace pellucid::io
