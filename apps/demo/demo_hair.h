// Hair of the demo's head: brows, lashes and short hair on the scalp, as strands whose light is added to the
// light of the skin. As surfaces of the G-buffer, strands would leave gaps across which no light scatters.
#pragma once
#include "demo/demo_head.h"
#include "sample/gbuffer.h"
#include "sample/sky.h"

namespace pellucid::demo {

// For a head that faces +z with y up, like the heads of the project; no strands without two eyes.
std::vector<Strand> strandsOf(const sample::Scene& skin, const DemoHead& head);

// The same for shadow rays.
sample::Curves curvesOf(const std::vector<Strand>& strands);

// What lights strands.
struct StrandLight {
    struct Lamp {
        sample::Vec3 toLight;       // unit
        sample::LinearColor color;  // irradiance / pi, as PelLight
    };
    std::vector<Lamp> lamps;
    sample::Sky sky;  // without panels
    const sample::Scene* occluders = nullptr;
};

// Strands on black, without hidden parts: red, green and blue of their light, and the covered share of each
// pixel.
sample::Image drawStrands(const std::vector<Strand>& strands, const StrandLight& light,
                          const sample::Camera& camera, const sample::GBuffer& gbuffer);

}  // namespace pellucid::demo
