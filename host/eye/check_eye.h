// Checks a PelEye, and fills in what it leaves to defaults. Throws PEL_ERROR_INVALID_ARGUMENT with the field, its value and what would
// be right.
#pragma once
#include <pellucid/pellucid.h>

namespace pel {

// Everything but the colour of the iris, which depends on a texture. gaze and up come back as unit vectors at a right angle.
PelEye resolvedEye(const PelEye& eye);

}  // namespace pel
