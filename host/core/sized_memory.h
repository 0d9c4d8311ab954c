// Device memory whose size changes now and then.
#pragma once
#include "core/device.h"

namespace pel {

class SizedMemory {
  public:
    const cl::Memory& memory() const { return memory_; }
    size_t bytes() const { return bytes_; }
    // Makes it this long, with anything in it or with zeros, after the old memory is gone. False, and nothing
    // is done, if it is.
    bool resize(Device& device, size_t bytes, bool zeros = false) {
        if (bytes == bytes_) return false;
        memory_ = cl::Memory();
        bytes_ = 0;
        if (bytes) memory_ = zeros ? device.allocateZeros(bytes) : device.allocate(bytes);
        bytes_ = bytes;
        return true;
    }
    // At least this long.
    const cl::Memory& grow(Device& device, size_t bytes) {
        if (bytes_ < bytes) resize(device, bytes);
        return memory_;
    }

  private:
    cl::Memory memory_;
    size_t bytes_ = 0;
};

}  // namespace pel
