// PELLUCID_CAPTURE: the input of an object's first frame as a scene that `pellucid shade` repeats
// (docs/guide/hosts.md, "Sending a bug report").
#pragma once
#include "shading/shader_state.h"

namespace pel {

// Inputs of a PelScatter besides images and materials.
struct ScatterInput {
    PelScatterParams params;
    std::map<uint32_t, float> scales;  // by material
};

// The folder that the environment names, at an object's first frame; nullptr: no capture is wanted.
// `asked`: whether this is not the first.
const char* captureFolder(bool& asked);

// Writes the frame into a new folder below `folder`, named after the object. Waits for the device. Errors,
// and settings that a scene cannot represent, are reported to the log callback or to standard error, and the
// frame continues. `scatter`: of a PelScatter; nullptr: the state is a shader's.
void captureFrame(Device& device, const ShaderState& state, const std::string& folder,
                  const ScatterInput* scatter = nullptr);

}  // namespace pel
