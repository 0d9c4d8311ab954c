// The look-up tables as FaceWorks' generator makes them: 200 samples of the integral per texel, in one
// thread.
#pragma once
#include <vector>

namespace baseline {

struct LutGaussian {
    float sigma;  // mm
    float weight[3];
};

// RGB per texel, row 0 the smallest curvature; radii in mm.
void sampledCurvatureLut(const std::vector<LutGaussian>& profile, int width, int height, float radiusMin,
                         float radiusMax, int samples, std::vector<float>& texels);
// RGB per texel, row 0 the widest penumbra; widths in mm.
void sampledShadowLut(const std::vector<LutGaussian>& profile, int width, int height, float widthMin,
                      float widthMax, float sharpening, int samples, std::vector<float>& texels);

}  // namespace baseline
