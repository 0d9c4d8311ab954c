// One entry of a batch, from its request to the bytes of its file.
#pragma once
#include <string>

#include "batch/batch_manifest.h"

namespace pellucid::io {

// Integrates, reads back and encodes. Waits for this entry only, so that several threads keep a device busy.
// Throws pellucid::Error.
std::string makeEntryFile(const Device& device, const BatchEntry& entry);

}  // namespace pellucid::io
