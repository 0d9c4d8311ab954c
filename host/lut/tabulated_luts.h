// Curvature and shadow tables of tabulated profiles, which are not sums of Gaussians.
#pragma once
#include "lut/lut.h"

namespace pel {

// Fill the texels of a table whose description is valid. Row limits are in 1/diffusion radii. Enqueued, not
// waited for.
void integrateTabulatedCurvature(Lut& lut, double curvatureMin, double curvatureMax);
void integrateTabulatedShadow(Lut& lut, double reciprocalMin, double reciprocalMax);

}  // namespace pel
