// The passes of this folder.
#pragma once
#include "shading/pass.h"

namespace pel {

extern const PassKind prepareScatterPass, diskPass, separablePass, texturePass, scatterPass, lightScatterPass,
    weighScatterPass, curvaturePass, skinMapsPass;

}  // namespace pel
