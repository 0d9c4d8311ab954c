// What light leaves a lit mesh after scattering under its surface (docs/mathematics.md, section 9), by the
// library.
#pragma once
#include <pellucid/pellucid.hpp>
#include <vector>

#include "sample/lit_mesh.h"

namespace pellucid::sample {

// RGB per point. `points`: xyz each; none give none. `desc` says how: profile, radius, unit, cut and
// tolerance; mesh, points and result are filled in here.
std::vector<float> scatteredAt(const Device& device, const LitMesh& lit, const std::vector<float>& points,
                               PelSurfaceIntegralDesc desc);

}  // namespace pellucid::sample
