// Specular LUT (section 4 of the mathematics): Beckmann's distribution P(n.h, m) = exp(-tan^2 a / m^2) / (m^2
// cos^4 a) as P^0.1 / 2, over n.h and m from 0 to 1 at texel centres.
//
// Output: texels, followed by a copy of the last row and column. One work-item: one texel. Variants:
// PEL_GROUP, work-items in a group.
#include "shared/lut.h"

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void specular_texels(
    const LutLayout lut, __global float4* restrict texels) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x > lut.width) return;
    const float cosine = ((float)min(x, lut.width - 1) + 0.5f) / (float)lut.width;
    // 1 - cosine is computed directly: subtracting from 1 would lose the digits that a narrow lobe divides by
    // m^2.
    const float beside = ((float)(lut.width - 1 - min(x, lut.width - 1)) + 0.5f) / (float)lut.width;
    const float m = ((float)min(y, lut.height - 1) + 0.5f) / (float)lut.height;
    // In logarithms: near grazing angles and for small m both factors leave the range of float.
    const float slope2 = beside * (1.0f + cosine) / (cosine * cosine * m * m);
    const float value = 0.5f * exp(-0.1f * slope2 - 0.2f * log(m) - 0.4f * log(cosine));
    texels[(size_t)y * lut.rowTexels + x] = (float4)(value, value, value, 0.0f);
}
