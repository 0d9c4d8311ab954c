// Checks of PelEye and PelEyeLutDesc. They throw PEL_ERROR_INVALID_ARGUMENT with the field, its value and the
// valid range.
#pragma once
#include <pellucid/pellucid.h>

namespace pel {

// Fills in all defaults except the colour of the iris, which depends on a texture. In the result `gaze` and
// `up` are perpendicular unit vectors.
PelEye resolvedEye(const PelEye& eye);

void checkEyeLutDesc(const PelEyeLutDesc& desc);

}  // namespace pel
