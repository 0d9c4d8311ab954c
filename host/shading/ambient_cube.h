// The ambient cube map as the shading kernel reads it (kernels/lib/shading/ambient_cube.clh): beside kernels/shading/ambient_cube.cl.
#pragma once
#include <vector>

#include "core/device.h"

namespace pel {

struct ImageView;

class AmbientCube {
  public:
    // Program and memory for `faces`, or neither for none.
    void prepare(Device& device, const ImageView& faces);
    // Makes the nodes of what the faces hold now; nothing without faces.
    void enqueue(Device& device, const ImageView& faces, std::vector<cl::Event>& events) const;
    const cl::Memory& nodes() const { return nodes_; }
    size_t scratchBytes() const { return bytes_; }

  private:
    cl::Program program_;
    cl::Memory nodes_;
    size_t bytes_ = 0;
};

}  // namespace pel
