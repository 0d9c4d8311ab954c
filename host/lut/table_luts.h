// Curvature and shadow tables of measured profiles, which are no sums of Gaussians.
#pragma once
#include "lut/lut.h"

namespace pel {

// Fill the texels of a table whose description is valid; row limits in 1/diffusion radii. Enqueued, not
// waited for.
void integrateTableCurvature(Lut& lut, double curvatureMin, double curvatureMax);
void integrateTableShadow(Lut& lut, double reciprocalMin, double reciprocalMax);

}  // namespace pel
