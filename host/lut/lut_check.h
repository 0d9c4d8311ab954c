// Checks a LUT description. Throws PEL_ERROR_INVALID_ARGUMENT with the field, its value and what would be
// right.
#pragma once
#include "lut/lut.h"

namespace pel {

void checkCurvatureDesc(const PelCurvatureLutDesc& desc);
void checkShadowDesc(const PelShadowLutDesc& desc);
void checkSpecularDesc(const PelSpecularLutDesc& desc);
// That the ends of its range are in order, once lengths that were left out are known.
void checkOrder(const PelLutInfo& info);

}  // namespace pel
