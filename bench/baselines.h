// Plain C++ loops that speed claims are measured against, as a user would first write them. No checks of
// their input.
#pragma once
#include <cstdint>
#include <vector>

#include "measure/frames.h"

namespace baseline {

// Edge curvature as a loop over triangles on one thread, the way FaceWorks defines and orders it. positions,
// normals: 3 floats per vertex. `scratch` is reused between calls, so that memory is not part of the time.
struct CurvatureScratch {
    std::vector<float> low, high, weight;
};
void edgeCurvature(const std::vector<float>& positions, const std::vector<float>& normals,
                   const std::vector<uint32_t>& indices, uint32_t passes, CurvatureScratch& scratch,
                   std::vector<float>& curvature);

// The shading pass as a scalar loop with OpenMP: one material of FaceWorks, one directional light with a
// parallel shadow map, tables of 512 x 512 RGB texels. `disk`: x and y of the taps; without taps there is no
// deep scatter.
struct ShadeInput {
    const pellucid::bench::FrameImages& frame;
    PelMaterial material;
    const std::vector<float>&curvatureTable, &shadowTable;
    std::vector<float> disk;
};
// What the loop does about terms that come out as 0.
enum class Effort {
    Straight,  // every term of every pixel of a material
    Skipping,  // no taps where sat(0.3 - Nb.L) is 0, no specular where N.L <= 0, as the library
};
void shadeOpenMp(const ShadeInput& input, Effort effort, std::vector<float>& radiance);

}  // namespace baseline
