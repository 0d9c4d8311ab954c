#include "shading/cached_upload.h"

#include <algorithm>

namespace pel {

size_t CachedUpload::update(Device& device, const void* bytes, size_t count) {
    const auto* from = static_cast<const unsigned char*>(bytes);
    if (memory_ && bytes_.size() == count && std::equal(from, from + count, bytes_.begin())) return 0;
    // A new buffer, because an execution that is still queued keeps reading the old one.
    std::vector<unsigned char> padded(from, from + count);
    padded.resize(std::max<size_t>(count, 16));
    memory_ = device.allocate(padded.size(), padded.data());
    bytes_.assign(from, from + count);
    return count;
}

}  // namespace pel
