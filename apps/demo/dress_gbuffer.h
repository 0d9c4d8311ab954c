// Details that the demo adds to the G-buffer of its head where surfaces meet.
#pragma once
#include "demo/demo_head.h"
#include "sample/gbuffer.h"

namespace pellucid::demo {

// Where an eye meets its lids the film of tears is thicker. The lids' edges are pink and moist, above also
// dark, where the lashes are rooted. Returns the wetness of PEL_SLOT_WETNESS, and on lids how near the eye
// is: 1 at its edge, 0 beyond the lids' edges.
std::vector<float> dressEyes(sample::GBuffer& gbuffer, sample::Vec3 up);

// Little of the light that enters gaps between lips and hairs or a nostril leaves again; more leaves from the
// wet edges of lids. `occlusion`: as of ambientOcclusion. `wetness`: by dressEyes.
void darkenFolds(sample::GBuffer& gbuffer, const sample::Image& occlusion, const std::vector<float>& wetness);

}  // namespace pellucid::demo
