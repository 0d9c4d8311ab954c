// Curvature LUT, form arc, of a sum of Gaussians (section 2 of the mathematics).
//
// With x = s/r the arc integral is a convolution on the circle of max0(cos) with K(x) = r P(r x), |x| <= X =
// min(pi, cut/r). At the angle phi = theta - pi/2 behind the terminator (u = -sin phi) it obeys D'' + D =
// K(phi) + K(pi - phi), so that a row is one sweep from phi = pi/2 to 0 over E with E(pi/2) = E'(pi/2) = 0,
// all terms positive:
//   unlit side   D(-u) = E + back u        back  = 2 int_0^{pi/2} K(pi - t) cos t dt
//   lit side     D(+u) = E + front u       front = 2 int_0^{pi/2} K(t) cos t dt = mass - 2 int_0^{pi/2} K(t)
//   (1 - cos t) dt
// E is kept at N + 1 nodes (pi/2) (j/N)^4 with its slope, and cubic between them: the error of such an
// interpolation, about 1e-3 sigma (h/sigma)^4, is then about the same for every width sigma of K, so one mesh
// serves all rows and profiles.
//
// Variants: PEL_WIDTH; PEL_GROUP, work-items in a group; PEL_NODES, N; PEL_POINTS, Gauss points per mesh
// interval (2 or 3); PEL_COLUMNS, columns per work-item of curvatureTexels.
#include "lib/normal.clh"
#include "lib/width.clh"
#include "shared/lut_integral.h"

#define ROW_STRIDE (2 * PEL_NODES + 4)

#if PEL_POINTS == 2
__constant float gaussAt[2] = {-0.577350269f, 0.577350269f};
__constant float gaussWeight[2] = {1.0f, 1.0f};
#else
__constant float gaussAt[3] = {-0.774596669f, 0.0f, 0.774596669f};
__constant float gaussWeight[3] = {0.555555556f, 0.888888889f, 0.555555556f};
#endif

// Beyond this many sigmas a Gaussian adds less than 1e-8 of its weight.
#define REACH 5.8f

typedef struct Rgb {
    floatw r, g, b;
} Rgb;

inline Rgb rgbFma(const Rgb a, const floatw s, const Rgb b) {
    return (Rgb){fma(a.r, s, b.r), fma(a.g, s, b.g), fma(a.b, s, b.b)};
}

// Writes value of PEL_WIDTH rows to slot `slot` of each row's record.
inline void storeRows(__global float4* rows, const uint firstRow, const uint height, const uint slot,
                      const Rgb value) {
#if PEL_WIDTH == 1
    rows[(size_t)firstRow * ROW_STRIDE + slot] = (float4)(value.r, value.g, value.b, 0.0f);
#else
    float r[PEL_WIDTH], g[PEL_WIDTH], b[PEL_WIDTH];
    storew(value.r, 0, r);
    storew(value.g, 0, g);
    storew(value.b, 0, b);
    for (uint lane = 0; lane < PEL_WIDTH && firstRow + lane < height; ++lane)
        rows[(size_t)(firstRow + lane) * ROW_STRIDE + slot] = (float4)(r[lane], g[lane], b[lane], 0.0f);
#endif
}

// Adds K(t) of the Gaussians first <= g < end at arc length s; times r it is K.
inline Rgb lineSpread(__global const LutGaussian* gaussians, const uint first, const uint end,
                      const floatw s) {
    Rgb sum = {0.0f, 0.0f, 0.0f};
    for (uint g = first; g < end; ++g) {
        const LutGaussian G = gaussians[g];
        const floatw x = s * (1.0f / G.sigma);
        const floatw e = exp(-0.5f * x * x) * (0.39894228f / G.sigma);
        sum.r = fma(e, (floatw)(G.red), sum.r);
        sum.g = fma(e, (floatw)(G.green), sum.g);
        sum.b = fma(e, (floatw)(G.blue), sum.b);
    }
    return sum;
}

// One work-item: PEL_WIDTH rows, one per lane. A row's record: E, F at node 0, ... E, F at node N, back,
// front.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void curvatureRows(
    const CurvatureParams params, __global const LutGaussian* gaussians, __constant LutNode* nodes,
    __global float4* rows) {
    const uint firstRow = get_global_id(0) * PEL_WIDTH;
    if (firstRow >= params.height) return;
    const floatw row = convert_floatw((intw)((int)firstRow) + lanesw());
    const floatw curvature = fma(row + 0.5f, (floatw)(params.curvatureStep), (floatw)(params.curvatureMin));
    const floatw radius = 1.0f / curvature;
    const floatw end = fmin(params.cut * curvature, (floatw)(M_PI_F));
    const floatw frontEnd = fmin(end, (floatw)(M_PI_2_F));
    const int hasBack = anyw(end > M_PI_2_F);

    Rgb E = {0.0f, 0.0f, 0.0f}, F = E, missing = E, back = E;
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES, E);
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 1, F);
    uint front = params.gaussians, behind = 0;
    for (int j = PEL_NODES - 1; j >= 0; --j) {
        const LutNode node = nodes[j];
        const float step = nodes[j + 1].angle - node.angle;
        // Narrow Gaussians come first in the list: in front those join as phi falls, behind those leave.
        while (front > 0 && anyw(REACH * gaussians[front - 1].sigma * curvature > node.angle)) --front;
        while (behind < params.gaussians &&
               !anyw(REACH * gaussians[behind].sigma * curvature > M_PI_F - nodes[j + 1].angle))
            ++behind;

        // Over the step the turn by its angle, then what the kernel adds.
        const float step2 = step * step;
        const float s = step * (1.0f - step2 * (1.0f / 6.0f) * (1.0f - step2 * (1.0f / 20.0f)));
        const float c = 1.0f - step2 * 0.5f * (1.0f - step2 * (1.0f / 12.0f));
        const Rgb turned = {fma(F.r, (floatw)(s), E.r * c), fma(F.g, (floatw)(s), E.g * c),
                            fma(F.b, (floatw)(s), E.b * c)};
        F = (Rgb){fma(E.r, (floatw)(-s), F.r * c), fma(E.g, (floatw)(-s), F.g * c),
                  fma(E.b, (floatw)(-s), F.b * c)};
        E = turned;

        const floatw frontHalf = 0.5f * fmax(fmin((floatw)(step), frontEnd - node.angle), 0.0f);
        const floatw backStart = fmax(M_PI_F - end - node.angle, 0.0f);
        const floatw backHalf = 0.5f * fmax(step - backStart, 0.0f);
        for (int q = 0; q < PEL_POINTS; ++q) {
            if (front < params.gaussians) {
                const floatw d = fma(frontHalf, (floatw)(gaussAt[q]), frontHalf);
                const floatw d2 = d * d;
                const floatw sd = d * (1.0f - d2 * (1.0f / 6.0f) * (1.0f - d2 * (1.0f / 20.0f)));
                const floatw vd = d2 * 0.5f * (1.0f - d2 * (1.0f / 12.0f));
                const floatw weight = frontHalf * gaussWeight[q] * radius;
                const Rgb k = lineSpread(gaussians, front, params.gaussians, (node.angle + d) * radius);
                E = rgbFma(k, weight * sd, E);
                F = rgbFma(k, weight * (1.0f - vd), F);
                // versine of the sum of two angles
                missing = rgbFma(k, weight * (node.versine + node.cosine * vd + node.sine * sd), missing);
            }
            if (hasBack && behind < params.gaussians) {
                const floatw d = backStart + fma(backHalf, (floatw)(gaussAt[q]), backHalf);
                const floatw d2 = d * d;
                const floatw sd = d * (1.0f - d2 * (1.0f / 6.0f) * (1.0f - d2 * (1.0f / 20.0f)));
                const floatw cd = 1.0f - d2 * 0.5f * (1.0f - d2 * (1.0f / 12.0f));
                const floatw weight = backHalf * gaussWeight[q] * radius;
                const Rgb k =
                    lineSpread(gaussians, behind, params.gaussians, (M_PI_F - node.angle - d) * radius);
                E = rgbFma(k, weight * sd, E);
                F = rgbFma(k, weight * cd, F);
                back = rgbFma(k, weight * (node.cosine * cd - node.sine * sd), back);
            }
        }
        storeRows(rows, firstRow, params.height, 2 * j, E);
        storeRows(rows, firstRow, params.height, 2 * j + 1, F);
    }

    Rgb mass = {0.0f, 0.0f, 0.0f};
    for (uint g = 0; g < params.gaussians; ++g) {
        const LutGaussian G = gaussians[g];
        const floatw inside =
            1.0f - 2.0f * normalTailOnly(fmin((floatw)(params.cut), M_PI_2_F * radius) / G.sigma);
        mass.r = fma(inside, (floatw)(G.red), mass.r);
        mass.g = fma(inside, (floatw)(G.green), mass.g);
        mass.b = fma(inside, (floatw)(G.blue), mass.b);
    }
    const Rgb none = {0.0f, 0.0f, 0.0f};
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 2, rgbFma(back, 2.0f, none));
    storeRows(rows, firstRow, params.height, 2 * PEL_NODES + 3, rgbFma(missing, -2.0f, mass));
}

// One work-item: PEL_COLUMNS columns of the unlit half of one row, and their mirror images in the lit half.
// The row behind the last is a copy of it, and the column behind the last likewise (shared/lut.h).
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void curvatureTexels(
    const CurvatureParams params, __global const float4* rows, __global const LutColumn* columns,
    __global float4* texels) {
    const uint unlit = (params.width + 1) / 2;
    const uint first = get_global_id(0) * PEL_COLUMNS;
    const uint y = get_global_id(1);
    if (first >= unlit) return;
    __global const float4* record = rows + (size_t)min(y, params.height - 1) * ROW_STRIDE;
    __global float4* line = texels + (size_t)y * (params.width + 1);
    const float4 back = record[2 * PEL_NODES + 2];
    const float4 front = record[2 * PEL_NODES + 3];
    const uint last = min(first + PEL_COLUMNS, unlit);
    for (uint x = first; x < last; ++x) {
        const LutColumn column = columns[x];
        __global const float4* node = record + 2 * column.node;
        float4 E = column.value0 * node[0];
        E = fma((float4)(column.slope0), node[1], E);
        E = fma((float4)(column.value1), node[2], E);
        E = fma((float4)(column.slope1), node[3], E);
        // A cubic may dip below 0 by rounding where E has all but vanished.
        E = fmax(E, 0.0f);
        line[x] = fma((float4)(column.elevation), back, E);
        line[params.width - 1 - x] = fma((float4)(column.elevation), front, E);
    }
    if (first == 0) line[params.width] = line[params.width - 1];
}
