// The hierarchy over a lit mesh: from which distance on a set of triangles counts as one point.
#pragma once
#include <functional>

#include "diffusion/surface_profile.h"

namespace pel {

struct SurfaceTree {
    std::vector<SurfaceNode> nodes;  // empty: nothing is lit
    std::vector<SurfaceTriangle> triangles;
};

// `lit`: triangles with irradiance and area. `error`: allowed error of a sum, in irradiance. `progress` gets
// a fraction.
SurfaceTree buildSurfaceTree(std::vector<SurfaceTriangle> lit, const SurfaceProfile& profile, double error,
                             const std::function<void(double)>& progress);

}  // namespace pel
