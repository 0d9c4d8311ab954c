// The programs of a scene, built without its G-buffer.
#pragma once
#include "scene/scene_frame.h"

namespace pellucid::io {

// A frame without its G-buffer and shadow maps, which SceneFrame::show() supplies. Builds the programs and
// launches each kernel on an image of 16 x 2 pixels, so that compilers run before the first frame, and
// reports progress to the device. Reads the files of the scene except G-buffer and shadow maps; look-up
// tables are kept in `luts`. Throws as SceneFrame does.
SceneFrame prepareFrame(const Device& device, const SceneFile& scene, LutStore& luts,
                        const PelShaderOptions& options = pelShaderOptionsDefaults(),
                        const std::vector<PelImageSlot>& outputs = {});
// Fills the driver's cache of programs, and `luts`.
void buildPrograms(const Device& device, const SceneFile& scene, LutStore& luts,
                   const PelShaderOptions& options = pelShaderOptionsDefaults(),
                   const std::vector<PelImageSlot>& outputs = {});

}  // namespace pellucid::io
