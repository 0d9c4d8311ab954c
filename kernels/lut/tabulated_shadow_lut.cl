// Shadow LUT of a tabulated profile (section 3 of the mathematics), lengths in diffusion radii. As in
// shadow_lut.cl the far side U = mass - T is integrated: with the ramp of half width b about -zeta and the
// mass M1(x) of P beyond x,
//   U = int_{-1}^{1} 3/4 (1 - y^2) M1(zeta + b y) dy
//     = 3/(2 b^2) (M2(e1) + M2(e2)) - 3/(2 b^3) (M3(e1) - M3(e2)),   e1 = zeta - b, e2 = zeta + b
// with the further tails of shared/lut_integral.h. The second form is used where b is at least a quarter of a
// radius; its rounding error is 2e-6. The first form is used, cell by cell of the list of tails, where the
// second would cancel.
//
// Inputs: the list of tails. Output: texels, followed by a copy of the last row and column (shared/lut.h).
// One work-item: PEL_COLUMNS columns of the lit half of one row, and their mirror images. Variants:
// PEL_GROUP, work-items in a group; PEL_COLUMNS.
#include "lib/lut/profile_tails.clh"
#include "shared/lut.h"

// Tails from any x. P is even, so a tail from x < 0 is the whole minus its mirror image.
inline float4 secondFrom(__global const float4* tails, const float x, const float4 mass, const float end) {
    const float4 beyond = tailAt(tails, PEL_TAIL_SECOND, fabs(x), end);
    return x < 0.0f ? 0.5f * x * x * mass + 2.0f * tails[PEL_TAIL_SECOND] - beyond : beyond;
}
inline float4 thirdFrom(__global const float4* tails, const float x, const float4 mass, const float end) {
    const float4 beyond = tailAt(tails, PEL_TAIL_THIRD, fabs(x), end);
    return x < 0.0f ? -x * (x * x * (1.0f / 6.0f) * mass + 2.0f * tails[PEL_TAIL_SECOND]) + beyond : beyond;
}

// Share of the ramp from -1 to y.
inline float rampBefore(const float y) {
    return 0.5f + y * (0.75f - 0.25f * y * y);
}

// int 3/4 (1 - y^2) M1(|zeta + b y|) dy over the part of the ramp where sign (zeta + b y) > 0.
inline float4 rampOnSide(__global const float4* tails, const float zeta, const float b, const float sign,
                         const float end) {
    // On this side x = sign (zeta + b y) runs from `from` to `to`.
    const float from = fmax(sign * zeta - b, 0.0f), to = fmin(sign * zeta + b, end);
    if (!(from < to) && !(from < end && sign * zeta + b > 0.0f)) return (float4)(0.0f);
    const int first = tailCell(fmin(from, end), end), last = tailCell(fmax(to, 0.0f), end);
    // Cells in y, so that they cover the ramp without gaps even if it is narrow.
    float y = clamp(-sign * zeta / b, -1.0f, 1.0f);
    const float yEnd = clamp((end - sign * zeta) / b, -1.0f, 1.0f);
    float4 sum = 0.0f;
    for (int i = first; i <= last; ++i) {
        const float next = i == last ? yEnd : clamp((tailDistance(i + 1, end) - sign * zeta) / b, -1.0f, 1.0f);
        const float half_ = 0.5f * (next - y), middle = 0.5f * (next + y);
        for (int q = 0; q < 2; ++q) {
            const float at = middle + half_ * (q ? 0.577350269f : -0.577350269f);
            const float4 mass = tailInCell(tails, PEL_TAIL_MASS, sign * zeta + b * at, i, end);
            sum += (0.75f * (1.0f - at * at) * half_) * mass;
        }
        y = next;
    }
    return sum;
}

inline float4 farSide(__global const float4* tails, const float zeta, const float b, const float4 mass,
                      const float end) {
    if (zeta - b >= end) return (float4)(0.0f);
    if (b < 0.25f) {
        const float before = rampBefore(clamp(-zeta / b, -1.0f, 1.0f));  // the part at x < 0
        return mass * before + rampOnSide(tails, zeta, b, 1.0f, end) - rampOnSide(tails, zeta, b, -1.0f, end);
    }
    const float r = 1.0f / b, e1 = zeta - b, e2 = zeta + b;
    return 1.5f * r * r *
           (secondFrom(tails, e1, mass, end) + secondFrom(tails, e2, mass, end) -
            r * (thirdFrom(tails, e1, mass, end) - thirdFrom(tails, e2, mass, end)));
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void table_shadow_texels(
    const TabulatedShadowLutParams params, __global const float4* tails, __global float4* texels) {
    const uint begin = params.width / 2 + get_global_id(0) * PEL_COLUMNS;
    const uint y = get_global_id(1);
    const float row = (float)min(y, params.height - 1);
    const float rowValue = fma(row + 0.5f, params.reciprocalStep, params.reciprocalMin);
    const float q = params.axis == PEL_LUT_AXIS_ROOT ? rowValue * rowValue : rowValue;
    const float b = 0.5f / (params.sharpening * q);
    const float4 mass = 2.0f * tails[PEL_TAIL_MASS];
    // The light that is left where the filter ends.
    float4 end = 0.0f;
    if (params.closedEnds && begin < params.width)
        end = clamp(farSide(tails, 0.5f / q, b, mass, params.end), 0.0f, 0.5f * mass);
    const float4 between = mass - 2.0f * end;
    __global float4* line = texels + (size_t)y * (params.width + 1);
    for (uint x = begin; x < min(begin + PEL_COLUMNS, params.width); ++x) {
        const float column = (float)x + 0.5f, w = fmin(column / (float)params.width, 1.0f);
        // p - 1/2 = (sqrt w - sqrt(1 - w)) / 2 without its cancellation
        float z = (column - 0.5f * (float)params.width) / (float)params.width / (sqrt(w) + sqrt(1.0f - w));
        if (params.axis == PEL_LUT_AXIS_ROOT)
            z = (column - 0.5f * (float)params.width) / (float)(max(params.width, 2u) - 1);
        z = fmin(z, 0.5f);
        float4 U = clamp(farSide(tails, z / q, b, mass, params.end), 0.0f, mass);
        float4 lit = mass - U;
        if (params.closedEnds) {
            U = clamp(select((float4)(0.5f - z), (U - end) / between, between > 1e-3f * mass), 0.0f, 1.0f);
            lit = 1.0f - U;
        }
        U.w = 0.0f;
        lit.w = 0.0f;
        line[x] = lit;
        line[params.width - 1 - x] = U;
        if (x == params.width - 1) line[params.width] = lit;
    }
}
