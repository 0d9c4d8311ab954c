// The hierarchy over a lit mesh: where a set of triangles may count as one point.
#pragma once
#include <functional>
#include <vector>

#include "diffusion/surface_profile.h"

namespace pel {

struct SurfaceTree {
    std::vector<SurfaceNode> nodes;  // empty: nothing is lit
    std::vector<SurfaceTriangle> triangles;
};

// `lit`: triangles with some irradiance and an area. `error`: what a sum may be off, in irradiance.
// `progress` is told a fraction.
SurfaceTree buildSurfaceTree(std::vector<SurfaceTriangle> lit, const SurfaceProfile& profile, double error,
                             const std::function<void(double)>& progress);

}  // namespace pel
