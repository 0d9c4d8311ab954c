// Constants of eyes as kernels take them (shared/eye.h).
#pragma once
#include <array>

#include "eye/eye_shape.h"
#include "shared/eye.h"

namespace pel {

// Lengths times `scale`.
PelEyeShape describeShape(const EyeShape& shape, const PelEyeLutDesc& desc, double scale);

// Light on the iris that comes from everywhere, against that of the open air: from the axis to the rim.
using AmbientNodes = std::array<float, PEL_AMBIENT_NODES>;
AmbientNodes ambientNodes(const PelEye& eye);

// Whether light takes the same ways in both.
bool sameShape(const PelEye& a, const PelEye& b);

// An eye without what depends on tables and textures. `eye` is resolved (eye/check_eye.h).
PelShadeEye describeEye(const PelEye& eye, const AmbientNodes& ambient, double millimetresPerUnit);

}  // namespace pel
