// A structure that kernels read, on the device; sent only where it changed.
#pragma once
#include <cstring>

#include "core/device.h"

namespace pel {

template <class T>
class SentConstants {
  public:
    void send(Device& device, const T& value) {
        if (!memory_)
            memory_ = device.allocate(sizeof value, &value);
        else if (std::memcmp(&value, &sent_, sizeof value))
            device.write(memory_.get(), 0, sizeof value, &value, true);
        sent_ = value;
    }
    const cl::Memory& memory() const { return memory_; }
    const T& sent() const { return sent_; }

  private:
    cl::Memory memory_;
    T sent_{};
};

}  // namespace pel
