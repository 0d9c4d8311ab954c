// Constants on the device, sent when they changed.
#pragma once
#include "core/device.h"

namespace pel {

// A buffer that is written anew only when its bytes differ from those it holds.
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
