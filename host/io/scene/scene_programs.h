// The programs of a scene, built without its G-buffer.
#pragma once
#include "io/scene/scene_frame.h"

namespace pellucid::io {

// A frame that lacks its G-buffer and shadow maps alone: SceneFrame::show() gives them. Builds what it will need and launches each kernel
// on an image of 16 x 2 pixels, so that compilers run before the first frame. Tells the device's progress. Files beside the scene are read,
// except its G-buffer and shadow maps; look-up tables stay in `luts`. Throws what SceneFrame would.
SceneFrame prepareFrame(const Device& device, const SceneFile& scene, LutStore& luts,
                        const PelShaderOptions& options = pelShaderOptionsDefaults(),
                        const std::vector<PelImageSlot>& outputs = {});
// The same for the driver's cache of programs, and for `luts`.
void buildPrograms(const Device& device, const SceneFile& scene, LutStore& luts,
                   const PelShaderOptions& options = pelShaderOptionsDefaults(),
                   const std::vector<PelImageSlot>& outputs = {});

}  // namespace pellucid::io
