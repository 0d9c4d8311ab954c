// Shadow LUT of a tabulated profile (section 3 of the mathematics), lengths in diffusion radii. As in
// shadow_lut.cl the far side U = total - T is integrated: with the ramp of half width b about -zeta and the
// tail M1(x), the integral of P beyond x,
//   U = int_{-1}^{1} 3/4 (1 - y^2) M1(zeta + b y) dy
//     = 3/(2 b^2) (M2(e1) + M2(e2)) - 3/(2 b^3) (M3(e1) - M3(e2)),   e1 = zeta - b, e2 = zeta + b
// with the further tails of shared/lut_integral.h. The second form is used where b is at least PEL_WIDE_RAMP
// radii; its rounding error is 2e-6. Below, where it would cancel, the first form is used: on nodes b /
// PEL_RAMP_PARTS apart, from samples of M1 at the same distances and constant weights; near zeta = 0, where P
// may be sharper than that, by quadrature over parts of the list of tails. U is cubic between nodes. Where
// ramps are so sharp that nodes would outnumber texels, all of it is by quadrature.
//
//   tabulated_shadow_rows   nodes of a row: U and b dU/dzeta at zeta = 0, b / PEL_RAMP_PARTS, ...
//   tabulated_shadow_texels texels, followed by a copy of the last row and column (shared/lut.h)
//
// One work-item: a row; PEL_COLUMNS columns of the lit half of one row, and their mirror images. Variants:
// PEL_GROUP, work-items in a group; PEL_COLUMNS.
#include "lib/lut/profile_tails.clh"
#include "shared/lut.h"

// M2(x) + k M3(x) for any x. P is even, so a tail from x < 0 is the whole minus its mirror image. Both tails
// in one: the value of one is the slope of the other, and their weights are the same.
static inline float4 tailsFrom(__global const float4* tails, const float x, const float k, const float4 total,
                               const float end) {
    const float s = fabs(x), sign = x < 0.0f ? -1.0f : 1.0f;
    float4 sum = 0.0f;
    if (s < end) {
        const int cell = tailCell(s, end);
        const TailPlace place = tailPlace(s, cell, end);
        const float t = place.t, u = 1.0f - t, before = u * u, behind = t * t;
        const float a = before * (1.0f + 2.0f * t), aSlope = -before * place.h * t,
                    b = behind * (3.0f - 2.0f * t), bSlope = behind * place.h * u;
        __global const float4 *low = tails + (size_t)cell * PEL_TAIL_VALUES, *high = low + PEL_TAIL_VALUES;
        const float4 second = a * low[PEL_TAIL_SECOND] + aSlope * low[PEL_TAIL_FIRST] +
                              b * high[PEL_TAIL_SECOND] + bSlope * high[PEL_TAIL_FIRST];
        const float4 thirds = a * low[PEL_TAIL_THIRD] + aSlope * low[PEL_TAIL_SECOND] +
                              b * high[PEL_TAIL_THIRD] + bSlope * high[PEL_TAIL_SECOND];
        sum = sign * second + k * thirds;
    }
    if (x < 0.0f) {
        const float4 whole = 2.0f * tails[PEL_TAIL_SECOND];
        sum += 0.5f * x * x * total + whole - k * x * (x * x * (1.0f / 6.0f) * total + whole);
    }
    return sum;
}

// Share of the ramp from -1 to y.
static inline float rampBefore(const float y) {
    return 0.5f + y * (0.75f - 0.25f * y * y);
}

// Gauss-Legendre on [-1, 1], 4 points.
__constant float gaussAt[4] = {-0.861136312f, -0.339981044f, 0.339981044f, 0.861136312f};
__constant float gaussWeight[4] = {0.347854845f, 0.652145155f, 0.652145155f, 0.347854845f};

typedef struct Far {
    float4 U, slope;  // slope: b dU/dzeta
} Far;

// The part of the ramp where sign (zeta + b y) > 0, from tails at |zeta + b y|, by quadrature over parts of
// PEL_RAMP_CELLS cells.
static inline Far rampOnSide(__global const float4* tails, const float zeta, const float b, const float sign,
                             const float end) {
    Far sum = {0.0f, 0.0f};
    // On this side x = sign (zeta + b y) runs from `from` to `to`.
    const float from = fmax(sign * zeta - b, 0.0f), to = fmin(sign * zeta + b, end);
    if (!(from < to) && !(from < end && sign * zeta + b > 0.0f)) return sum;
    const int first = tailCell(fmin(from, end), end), last = tailCell(fmax(to, 0.0f), end);
    // Cells in y, so that they cover the ramp without gaps even if it is narrow.
    const float perB = 1.0f / b;
    float y = clamp(-sign * zeta * perB, -1.0f, 1.0f);
    const float yEnd = clamp((end - sign * zeta) * perB, -1.0f, 1.0f);
    for (int i = first; i <= last; i += PEL_RAMP_CELLS) {
        const int behind = i + PEL_RAMP_CELLS;
        const float next =
            behind > last ? yEnd : clamp((tailDistance(behind, end) - sign * zeta) * perB, -1.0f, 1.0f);
        const float half_ = 0.5f * (next - y), middle = 0.5f * (next + y);
        for (int q = 0; q < 4; ++q) {
            const float at = fma(half_, gaussAt[q], middle),
                        weight = 0.75f * (1.0f - at * at) * half_ * gaussWeight[q];
            const float x = clamp(fma(b, at, sign * zeta), 0.0f, end);
            const int cell = tailCell(x, end);
            const TailPlace place = tailPlace(x, cell, end);
            sum.U += weight * tailInCell(tails, PEL_TAIL_TOTAL, cell, place);
            sum.slope += weight * spreadInCell(tails, cell, place);
        }
        y = next;
    }
    return sum;
}

static inline Far farByQuadrature(__global const float4* tails, const float zeta, const float b,
                                  const float4 total, const float end) {
    const float before = rampBefore(clamp(-zeta / b, -1.0f, 1.0f));  // the part at x < 0
    const Far ahead = rampOnSide(tails, zeta, b, 1.0f, end), behind = rampOnSide(tails, zeta, b, -1.0f, end);
    const Far far_ = {total * before + ahead.U - behind.U, -b * (ahead.slope + behind.slope)};
    return far_;
}

// The ramp of a row, and the spacing of its nodes.
typedef struct ShadowRow {
    float q, b;
    float spacing, perSpacing;  // of nodes, and 1 / that
    int nodes;                  // intervals between them; 0: none
} ShadowRow;

static inline ShadowRow shadowRow(const TabulatedShadowLutParams params, const uint y) {
    ShadowRow row;
    const float value = fma((float)y + 0.5f, params.reciprocalStep, params.reciprocalMin);
    row.q = params.axis == PEL_LUT_AXIS_ROOT ? value * value : value;
    row.b = 0.5f / (params.sharpening * row.q);
    row.spacing = row.b / (float)PEL_RAMP_PARTS, row.perSpacing = 1.0f / row.spacing;
    row.nodes = row.b < PEL_WIDE_RAMP ? (int)params.nodes : 0;
    return row;
}

// U at zeta >= 0. `nodes`: of the row.
static inline float4 farSide(__global const float4* tails, __global const float4* nodes, const ShadowRow row,
                             const float zeta, const float4 total, const float end) {
    if (zeta - row.b >= end) return (float4)(0.0f);
    if (row.nodes > 0) {
        const float at = zeta * row.perSpacing;
        const int i = min((int)at, row.nodes - 1);
        const float t = fmin(at - (float)i, 1.0f), u = 1.0f - t, step = 1.0f / (float)PEL_RAMP_PARTS;
        __global const float4* node = nodes + 2 * (size_t)i;
        return u * u * ((1.0f + 2.0f * t) * node[0] + step * t * node[1]) +
               t * t * ((3.0f - 2.0f * t) * node[2] - step * u * node[3]);
    }
    if (row.b < PEL_WIDE_RAMP) return farByQuadrature(tails, zeta, row.b, total, end).U;
    const float r = 1.0f / row.b, e1 = zeta - row.b, e2 = zeta + row.b;
    return 1.5f * r * r * (tailsFrom(tails, e1, -r, total, end) + tailsFrom(tails, e2, r, total, end));
}

// samples: room for nodes + 2 PEL_RAMP_PARTS + PEL_RAMP_TOGETHER values, and as many slopes, of each row.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tabulated_shadow_rows(
    const TabulatedShadowLutParams params, __global const float4* restrict tails,
    __global const RampWeight* restrict weights, __global float4* restrict samples,
    __global float4* restrict nodes) {
    const uint y = get_global_id(0);
    if (y >= params.height) return;
    const ShadowRow row = shadowRow(params, y);
    if (row.nodes == 0) return;
    const float4 total = 2.0f * tails[PEL_TAIL_TOTAL];
    const int count = PEL_RAMP_SAMPLES(row.nodes);
    __global float4 *values = samples + (size_t)y * 2 * count, *slopes = values + count;
    nodes += (size_t)y * PEL_RAMP_RECORD(row.nodes);
    // Samples at x = (k - PEL_RAMP_PARTS) spacing, and M1' times the spacing. Beyond the end they are 0.
    int held = 0;
    for (; held < count; ++held) {
        const float x = (float)(held - PEL_RAMP_PARTS) * row.spacing, s = fabs(x);
        if (x >= params.end) break;
        float4 tail = 0.0f, spread = 0.0f;
        if (s < params.end) {
            const int cell = tailCell(s, params.end);
            const TailPlace place = tailPlace(s, cell, params.end);
            tail = tailInCell(tails, PEL_TAIL_TOTAL, cell, place);
            spread = spreadInCell(tails, cell, place);
        }
        values[held] = x < 0.0f ? total - tail : tail;
        slopes[held] = -row.spacing * spread;
    }
    for (int k = held; k < count; ++k) values[k] = slopes[k] = 0.0f;
    for (int i = 0; i <= row.nodes; i += PEL_RAMP_TOGETHER) {
        if (i >= held) {
            for (int k = i; k < min(i + PEL_RAMP_TOGETHER, row.nodes + 1); ++k)
                nodes[2 * k] = nodes[2 * k + 1] = 0.0f;
            continue;
        }
        if (i < PEL_RAMP_PARTS + PEL_RAMP_SHARP) {
            for (int k = i; k < min(i + PEL_RAMP_TOGETHER, row.nodes + 1); ++k) {
                const Far far_ = farByQuadrature(tails, (float)k * row.spacing, row.b, total, params.end);
                nodes[2 * k] = far_.U, nodes[2 * k + 1] = far_.slope;
            }
            continue;
        }
        float16 U = 0.0f, slope = 0.0f;
        for (int k = 0; k <= 2 * PEL_RAMP_PARTS; ++k) {
            const RampWeight w = weights[k];
            const float16 M = vload16(0, (__global const float*)(values + i + k)),
                          step = vload16(0, (__global const float*)(slopes + i + k));
            U += w.value * M + w.slope * step;
            slope += w.valueToSlope * M + w.slopeToSlope * step;
        }
#define PUT(k, part) \
    if (i + k <= row.nodes) nodes[2 * (i + k)] = U.part, nodes[2 * (i + k) + 1] = slope.part;
        PUT(0, s0123)
        PUT(1, s4567)
        PUT(2, s89ab)
        PUT(3, scdef)
#undef PUT
    }
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tabulated_shadow_texels(
    const TabulatedShadowLutParams params, __global const float4* restrict tails,
    __global const float4* restrict nodes, __global float4* restrict texels) {
    const uint begin = params.width / 2 + get_global_id(0) * PEL_COLUMNS;
    const uint y = get_global_id(1);
    const ShadowRow row = shadowRow(params, min(y, params.height - 1));
    nodes += (size_t)min(y, params.height - 1) * PEL_RAMP_RECORD(row.nodes);
    const float perQ = 1.0f / row.q;
    const float4 total = 2.0f * tails[PEL_TAIL_TOTAL];
    // The light that is left where the filter ends.
    float4 end = 0.0f;
    if (params.closedEnds && begin < params.width)
        end = clamp(farSide(tails, nodes, row, 0.5f * perQ, total, params.end), 0.0f, 0.5f * total);
    const float4 between = total - 2.0f * end;
    __global float4* line = texels + (size_t)y * (params.width + 1);
    for (uint x = begin; x < min(begin + PEL_COLUMNS, params.width); ++x) {
        const float column = (float)x + 0.5f, w = fmin(column / (float)params.width, 1.0f);
        // p - 1/2 = (sqrt w - sqrt(1 - w)) / 2 without its cancellation
        float z = (column - 0.5f * (float)params.width) / (float)params.width / (sqrt(w) + sqrt(1.0f - w));
        if (params.axis == PEL_LUT_AXIS_ROOT)
            z = (column - 0.5f * (float)params.width) / (float)(max(params.width, 2u) - 1);
        z = fmin(z, 0.5f);
        float4 U = clamp(farSide(tails, nodes, row, z * perQ, total, params.end), 0.0f, total);
        float4 lit = total - U;
        if (params.closedEnds) {
            U = clamp(select((float4)(0.5f - z), (U - end) / between, between > 1e-3f * total), 0.0f, 1.0f);
            lit = 1.0f - U;
        }
        U.w = 0.0f;
        lit.w = 0.0f;
        line[x] = lit;
        line[params.width - 1 - x] = U;
        if (x == params.width - 1) line[params.width] = lit;
    }
}
