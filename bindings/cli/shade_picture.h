// What `shade` writes to be looked at.
#pragma once
#include <string>
#include <vector>

#include "command.h"
#include "io/image/tone_map.h"
#include "scene/scene_frame.h"

namespace pellucid::cli {

// What can be shown; "final", then the output slots by their keys.
std::vector<std::string> showableParts();
// The slot of a part; PEL_SLOT_RADIANCE of "final".
PelImageSlot slotOfPart(const std::string& part);

// The parts side by side, labelled where there is more than one, lengths as colours with a bar. `frame` was
// shaded with their slots as outputs.
void writeShadePicture(const std::string& path, const io::Image& gbuffer, const io::SceneFrame& frame,
                       const std::vector<std::string>& parts, const io::ToneMap& tone);

// --exposure and --tonemap.
void addToneOptions(Command& command, io::ToneMap& tone);

}  // namespace pellucid::cli
