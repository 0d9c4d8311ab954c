// Small images of zeros that replace a caller's, for kernels that a warm-up launches. The caller's memory may
// be gone by the time of the launches, and no kernel's code depends on a size.
#pragma once
#include "core/image_view.h"

namespace pel {

class ImageSubstitutes {
  public:
    // `view` is changed by place(); nothing is done for an empty one.
    void add(ImageView& view);
    // Allocates. Views that shared a buffer share one again, one image after another.
    void place(const Ref<Device>& device);

  private:
    std::vector<ImageView*> views_;
};

}  // namespace pel
