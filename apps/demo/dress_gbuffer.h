// What the demo adds to a G-buffer of its head where surfaces meet.
#pragma once
#include "demo/demo_head.h"
#include "sample/gbuffer.h"

namespace pellucid::demo {

// Where an eye meets its lids the film of tears is thicker. The lids' edges are pink and moist, above also
// dark, where the lashes are rooted. Returns the wetness of PEL_SLOT_WETNESS.
std::vector<float> dressEyes(sample::GBuffer& gbuffer, sample::Vec3 up);

// Little of the light that gets between lips and hairs or into a nostril comes out again. `occlusion`: as of
// ambientOcclusion.
void darkenFolds(sample::GBuffer& gbuffer, const sample::Image& occlusion);

}  // namespace pellucid::demo
