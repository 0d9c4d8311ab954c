// What `pellucid import` needs of the sample renderer: a G-buffer and shadow maps of the imported scene.
#pragma once
#include "cli/command.h"
#include "gltf/gltf_import.h"

namespace pellucid::cli {

struct ImportView {
    const std::vector<float>& curvature;  // per vertex, 1/mm
    uint32_t width, height;
    int camera;  // index, or -1: frames everything
};

// Renders gbuffer.exr and shadow maps into `folder`; sets the scene's channels, camera and lights.
void drawImport(Run& run, const std::string& folder, io::ImportedGltf& imported, const ImportView& view);

}  // namespace pellucid::cli
