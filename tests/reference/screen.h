// Curvature from a G-buffer in double precision (section 5 of the mathematics): |fwidth N| / |fwidth P|,
// where fwidth never crosses an edge.
#pragma once

#include <cstdint>
#include <vector>

#include "reference/vec.h"

namespace reference {

struct ScreenImage {
    int width = 0, height = 0;
    std::vector<Vec3> normals, positions;  // row by row
    std::vector<uint32_t> ids;             // or none
};

// 1/length per pixel; 0 for what has id 0, a normal or position that is not finite, or no neighbour to
// compare with. A neighbour lies beyond an edge if its id differs or the step to it leans by more than
// asin(edge) out of the surface at either end.
std::vector<double> screenCurvature(const ScreenImage& image, double edge);

}  // namespace reference
