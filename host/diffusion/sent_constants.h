// A structure on the device that kernels read, sent only when it has changed.
#pragma once
#include "shading/scratch_image.h"

namespace pel {

template <class T>
class SentConstants {
  public:
    void send(Device& device, const T& value) {
        upload_.update(device, &value, sizeof value);
        sent_ = value;
    }
    const cl::Memory& memory() const { return upload_.memory(); }
    const T& sent() const { return sent_; }

  private:
    CachedUpload upload_;
    T sent_{};
};

}  // namespace pel
