// What the demo adds to a G-buffer of its head where surfaces meet.
#pragma once
#include "demo/demo_head.h"
#include "sample/gbuffer.h"

namespace pellucid::demo {

// Where an eye meets its lids the film of tears is thicker, and stands against the lower lid in a line that
// reflects light (DEMO_TEARS). The lids' edges are pink and moist, above also dark, where the lashes are
// rooted. Returns the wetness of PEL_SLOT_WETNESS.
std::vector<float> dressEyes(sample::GBuffer& gbuffer, sample::Vec3 up);

// Skin between hairs is dark.
void shadeScalp(sample::GBuffer& gbuffer, const Scalp& scalp);

}  // namespace pellucid::demo
