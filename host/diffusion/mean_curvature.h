// Mean curvature of the surface under each pixel (kernels/diffusion/mean_curvature.cl), for the gain of
// curved bodies.
#pragma once
#include "shading/scratch_image.h"
#include "shared/mean_curvature.h"

namespace pel {

class MeanCurvature {
  public:
    struct Images {
        ImageView normals, positions, depth, ids, out;  // positions or depth
    };
    void setImages(Images images) { images_ = std::move(images); }
    cl::ProgramKey program(const Device& device) const;
    // `windows`: of each id, length; 0: not measured. Returns the bytes sent.
    size_t send(Device& device, uint32_t height, const float (&inverseViewProjection)[16],
                const std::map<uint32_t, float>& windows);
    // `rows` rows from `row` on; the output begins with row `outRow` of the picture.
    void enqueue(Device& device, const cl::Program& program, std::vector<cl::Event>& events, uint32_t row,
                 uint32_t rows, uint32_t outRow) const;

  private:
    Images images_;
    CachedUpload constants_;
};

}  // namespace pel
