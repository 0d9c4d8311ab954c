// The passes of this room.
#pragma once
#include "shading/pass.h"

namespace pel {

extern const PassKind prepareScatterPass, diskPass, separablePass, scatterPass, lightScatterPass,
    weighScatterPass;

}  // namespace pel
