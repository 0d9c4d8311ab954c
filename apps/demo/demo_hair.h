// Brows and lashes of the demo's head: strands on its skin, drawn over the shaded picture. In the G-buffer
// they would leave gaps in the skin across which no light scatters.
#pragma once
#include "demo/demo_head.h"
#include "sample/gbuffer.h"

namespace pellucid::demo {

// For a head that looks to +z with y up, as the project's own do; none without two eyes.
std::vector<Strand> strandsOf(const sample::Scene& head, const std::vector<sample::EyeLook>& eyes);

// The share of each pixel that strands cover, hidden parts left out: one plane.
sample::Image coverageOf(const std::vector<Strand>& strands, const sample::Camera& camera,
                         const sample::GBuffer& gbuffer);

}  // namespace pellucid::demo
