// PELLUCID_CAPTURE: the input of a shader's first frame as a scene that `pellucid shade` repeats
// (docs/guide/hosts.md, "Sending a bug report").
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Writes the frame into a new folder below `folder`, named after the shader. Waits for the device. What went
// wrong, and what a scene cannot hold, goes to the log callback, or to standard error: the frame goes on.
void captureFrame(Device& device, const ShaderState& state, const std::string& folder);

}  // namespace pel
