// A structure that kernels read, on the device; sent only where it changed.
#pragma once
#include <cstring>

#include "core/device.h"

namespace pel {

template <class T>
class SentConstants {
  public:
    void send(Device& device, const T& value) {
        // A new buffer, because an execution that is still queued keeps reading the old one.
        if (!memory_ || std::memcmp(&value, &sent_, sizeof value))
            memory_ = device.allocate(sizeof value, &value);
        sent_ = value;
    }
    const cl::Memory& memory() const { return memory_; }
    const T& sent() const { return sent_; }

  private:
    cl::Memory memory_;
    T sent_{};
};

}  // namespace pel
