#include "scene/scene_programs.h"

#include <set>

namespace pellucid::io {
namespace {

// A black image with these channels, of the smallest size that the kernels treat like a frame.
Image blank(const std::set<std::string>& channels, int height = 2) {
    Image image;
    image.width = 16;
    image.height = height;
    for (const std::string& name : channels)
        if (!name.empty()) image.addInterleaved(std::vector{name}, std::vector<float>(image.pixelCount()));
    return image;
}

Image blankGBuffer(const SceneFile& scene) {
    std::set<std::string> channels;
    for (size_t slot = 0; slot < scene.channels.size(); ++slot)
        if (slot != PEL_SLOT_CURVATURE || scene.channels[slot] != std::vector<std::string>{"screen"})
            channels.insert(scene.channels[slot].begin(), scene.channels[slot].end());
    for (const SceneLight& light : scene.lights) channels.insert(light.wideShadow);
    return blank(channels);
}

ShadowMaps blankMaps(const SceneFile& scene) {
    ShadowMaps maps;
    for (const auto& [file, map] : shadowMapsOf(scene)) {
        std::set<std::string> names = namesOf(map.groups);
        if (names.erase("")) names.insert("Z");
        maps[file] = blank(names, map.cube ? 6 * 16 : 2);
    }
    return maps;
}

}  // namespace

SceneFrame prepareFrame(const Device& device, const SceneFile& scene, LutStore& luts,
                        const PelShaderOptions& options, const std::vector<PelImageSlot>& outputs) {
    return {device, blankGBuffer(scene), scene, luts, blankMaps(scene), options, outputs, true};
}

void buildPrograms(const Device& device, const SceneFile& scene, LutStore& luts,
                   const PelShaderOptions& options, const std::vector<PelImageSlot>& outputs) {
    prepareFrame(device, scene, luts, options, outputs);
}

}  // namespace pellucid::io
