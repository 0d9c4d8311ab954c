// Edge curvature as a plain loop over triangles on one thread, the way FaceWorks defines and orders it: what
// the device code is measured against. No checks of its input.
#pragma once
#include <cstdint>
#include <vector>

namespace baseline {

// positions, normals: 3 floats per vertex. `scratch` is reused between calls, so that memory is not part of
// the time.
struct CurvatureScratch {
    std::vector<float> low, high, weight;
};
void edgeCurvature(const std::vector<float>& positions, const std::vector<float>& normals,
                   const std::vector<uint32_t>& indices, uint32_t passes, CurvatureScratch& scratch,
                   std::vector<float>& curvature);

}  // namespace baseline
