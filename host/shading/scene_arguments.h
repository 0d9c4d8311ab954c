// The first arguments of kernels with a Scene: SCENE_ARGUMENTS of shading/scene.clh.
#pragma once
#include "shading/pass.h"

namespace pel {

void sceneArguments(cl::Launch& launch, const PassWork& work);

}  // namespace pel
