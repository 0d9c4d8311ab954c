// What the demo adds to a G-buffer of its head where surfaces meet.
#pragma once
#include "demo/demo_head.h"
#include "sample/gbuffer.h"

namespace pellucid::demo {

// Where an eye meets its lids the film of tears is thicker. The lids' edges are pink and moist, above also
// dark, where the lashes are rooted. Returns the wetness of PEL_SLOT_WETNESS, and on lids how near the eye
// is: 1 at its edge, 0 beyond the lids' edges.
std::vector<float> dressEyes(sample::GBuffer& gbuffer, sample::Vec3 up);

// Little of the light that gets between lips and hairs or into a nostril comes out again; from the wet edges
// of lids more does. `occlusion`: as of ambientOcclusion. `wetness`: by dressEyes.
void darkenFolds(sample::GBuffer& gbuffer, const sample::Image& occlusion, const std::vector<float>& wetness);

}  // namespace pellucid::demo
