// What `pellucid import` needs of the sample renderer: a G-buffer and shadow maps of the imported scene.
#pragma once
#include <string>
#include <vector>

#include "command.h"
#include "io/gltf/gltf_file.h"
#include "io/gltf/gltf_scene.h"
#include "io/image/image_file.h"

namespace pellucid::cli {

struct ImportView {
    const io::MeshData& mesh;             // mm
    std::vector<uint32_t> ids;            // per triangle, from 1
    const std::vector<float>& curvature;  // per vertex, 1/mm
    const std::vector<io::GltfMaterial>& materials;
    const std::vector<io::GltfLook>& looks;
    const std::vector<io::GltfImage>& images;
    const std::vector<io::GltfCamera>& cameras;
    double scale;  // mm per unit of the cameras
    uint32_t width, height;
    int camera;  // index, or -1: frames everything
};

// Whether this build has the renderer.
bool canDraw();
// Renders into `folder`: gbuffer.exr, and shadow maps of directional and spot lights; completes the scene's channels, camera and lights.
void drawImport(Run& run, const std::string& folder, const ImportView& view, io::SceneFile& scene);

}  // namespace pellucid::cli
