// Random frames on devices of other widths.
#pragma once
#include "../device_lanes.h"
#include "shade_scene.h"

namespace shade_test {
using lanes::deviceOf;
}
