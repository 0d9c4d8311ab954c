// The passes of this folder, each in a file beside its kernel's.
#pragma once
#include "shading/pass.h"

namespace pel {

extern const PassKind ambientCubePass, classifyTilesPass, blurNormalsPass, normalMapPass, shadowBoundsPass,
    wideShadowPass, irradiancePass, reflectionCubePass, irisesPass, tapCellsPass, shadePass;

}  // namespace pel
