// The one program of wide shadows and of their maps' bounds, because a driver's cost per program is what a
// first frame waits for.
#pragma once
#include "shading/shader_plan.h"

namespace pel {

cl::ProgramKey wideShadowKey(const Device& device, const ShaderPlan& plan);

}  // namespace pel
