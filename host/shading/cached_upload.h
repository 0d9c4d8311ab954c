// Constants on the device, sent only when they change.
#pragma once
#include "core/device.h"

namespace pel {

// A buffer that is written again only if its bytes differ.
class CachedUpload {
  public:
    // Returns the bytes sent.
    size_t update(Device& device, const void* bytes, size_t count);
    const cl::Memory& memory() const { return memory_; }
    size_t bytes() const { return bytes_.size(); }

  private:
    std::vector<unsigned char> bytes_;
    cl::Memory memory_;
};

}  // namespace pel
