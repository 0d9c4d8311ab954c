// The passes of every shader, in the order in which they run.
#pragma once
#include <span>

#include "shading/pass.h"

namespace pel {

std::span<const PassKind> shadingPasses();

}  // namespace pel
