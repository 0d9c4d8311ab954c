// Shadow LUT of a sum of Gaussians (section 3 of the mathematics).
//
// Lengths are in diffusion radii. At distance z = zeta q from the middle of the edge (z = p - 1/2) the
// sharpened shadow is a smoothstep of half width b = 1/(2 k q) about -zeta. The table is odd about the
// middle, T(z) + T(-z) = total. So only the far side z >= 0 is integrated: U = total - T, a sum of positive
// terms. For
// one Gaussian, with beta = b/sigma, e1 = (zeta - b)/sigma, e2 = (zeta + b)/sigma and the repeated integrals
// i_n of the normal tail,
//   U = 3/(2 beta^2) (i2(e1) + i2(e2)) - 3/(2 beta^3) (i3(e1) - i3(e2))            beta >= 1
//   U = sum over n of beta^2n / (2n)! Q^(2n)(zeta/sigma) 3/((2n + 1)(2n + 3))             beta < 1, where
//   that cancels.
// Between and beyond the kinks the tails are 0 or 1 and cost nothing. The part of the profile beyond the cut
// is subtracted where its weight matters.
//
// Columns are linear in w; on the square-root axis they are linear in p, and rows in the root of q. With
// closed ends T is rescaled to (T - T(0)) / (T(1) - T(0)) per row.
//
// Variants: PEL_WIDTH; PEL_GROUP, work-items in a group; PEL_COLUMNS, columns per work-item, a multiple of
// PEL_WIDTH.
#include "lib/lut/normal.clh"
#include "lib/lut/stack.clh"
#include "shared/lut.h"
#include "shared/lut_integral.h"

// Beyond this many sigmas a normal tail is below 4e-9.
#define REACH 5.8f

// Gauss rule of 6 points on [-1, 1].
__constant float gaussAt[6] = {-0.9324695142f, -0.6612093865f, -0.2386191861f,
                               0.2386191861f,  0.6612093865f,  0.9324695142f};
__constant float gaussWeight[6] = {0.1713244924f, 0.3607615730f, 0.4679139346f,
                                   0.4679139346f, 0.3607615730f, 0.1713244924f};

// i2 and i3: integrals of (t - x)^n / n! times the normal density over t > x.
static inline floatw secondTail(const floatw x, const floatw Q, const floatw density) {
    return 0.5f * fma(fma(x, x, (floatw)(1.0f)), Q, -x * density);
}
static inline floatw thirdTail(const floatw x, const floatw Q, const floatw density) {
    return (1.0f / 6.0f) * (fma(x, x, (floatw)(2.0f)) * density - x * fma(x, x, (floatw)(3.0f)) * Q);
}

// Integral of smoothstep((x + beta - xi) / 2 beta) over the normal density beyond x = cut: the part that a
// cut profile lacks.
static inline floatw beyondCut(const floatw xi, const float beta, const float cut, const floatw e1,
                               const floatw e2, const floatw i2e1, const floatw i3e1, const floatw i2e2,
                               const floatw i3e2) {
    floatw density;
    const floatw Q = normalTail((floatw)(cut), &density);
    const floatw i1 = density - cut * Q;
    const floatw i2 = secondTail((floatw)(cut), Q, density);
    const floatw i3 = thirdTail((floatw)(cut), Q, density);
    const float r = 1.0f / beta;
    const floatw y = clamp((cut - xi) * r, -1.0f, 1.0f);
    // The cubic 1/2 + 3/4 y - 1/4 y^3 expanded about the cut, and where it ends at e2.
    const floatw inside = (0.5f + y * (0.75f - 0.25f * y * y)) * Q + 0.75f * (1.0f - y * y) * r * i1 -
                          1.5f * y * r * r * i2 - 1.5f * r * r * r * i3 + 1.5f * r * r * (i2e2 + r * i3e2);
    const floatw all = 1.5f * r * r * (i2e1 + i2e2 - r * (i3e1 - i3e2));
    return selectw(selectw(inside, Q, e2 <= cut), all, e1 >= cut);
}

// normalTail, without its exponential where all lanes are far out on one side.
static inline floatw tailBeyond(const floatw x, floatw* density) {
    if (anyw(fabs(x) < REACH)) return normalTail(x, density);
    *density = 0.0f;
    return selectw((floatw)(0.0f), (floatw)(1.0f), x < 0.0f);
}

// beta < 1, the cut outside of the ramp: the Taylor series of Q about xi against the moments of 3/4 (1 -
// y^2).
static inline floatw bluntSide(const floatw xi, const float beta) {
    floatw density;
    const floatw Q = tailBeyond(xi, &density);
    // Q^(2n) = He_{2n-1}(xi) density, by the recurrence of the Hermite polynomials.
    const float b2 = beta * beta;
    floatw before = 1.0f, hermite = xi, sum = 0.0f;
    float factor = 1.0f;
#pragma unroll
    for (int n = 1; n <= 6; ++n) {
        factor *= b2 / (float)((2 * n - 1) * (2 * n));
        sum = fma((floatw)(factor * (3.0f / (float)((2 * n + 1) * (2 * n + 3)))), hermite, sum);
        before = xi * hermite - (float)(2 * n - 1) * before;
        hermite = xi * before - (float)(2 * n) * hermite;
    }
    return fma(sum, density, Q);
}

// beta < 1 with the cut within the ramp for some lane: quadrature of the cut profile's tail, which is 0
// beyond the cut at one end and the whole integral at the other.
static inline floatw bluntCutSide(const floatw xi, const float beta, const float cut, const floatw cutTail) {
    const floatw low = clamp((-cut - xi) / beta, -1.0f, 1.0f), high = clamp((cut - xi) / beta, -1.0f, 1.0f);
    const floatw centre = 0.5f * (low + high), halfLength = 0.5f * (high - low);
    floatw sum = (0.5f + low * (0.75f - 0.25f * low * low)) * (1.0f - 2.0f * cutTail);
    for (int i = 0; i < 6; ++i) {
        const floatw y = fma(halfLength, (floatw)(gaussAt[i]), centre);
        const floatw tail = normalTailOnly(fma(y, (floatw)(beta), xi)) - cutTail;
        sum = fma(0.75f * gaussWeight[i] * halfLength * (1.0f - y * y), tail, sum);
    }
    return sum;
}

static inline floatw farSide(const floatw zeta, const float b, const LutGaussian G, const float cutLength) {
    const float sigma = fmax(G.sigma, 1e-6f * b);  // narrower ones are points to the smoothstep
    const float beta = b / sigma;
    const float cut = cutLength / sigma;
    const floatw xi = zeta * (1.0f / sigma);
    floatw cutTail = 0.0f;
    if (cut < REACH) cutTail = normalTailOnly((floatw)(cut));
    if (beta < 1.0f) {
        if (cut < REACH && anyw(xi + beta > cut)) return bluntCutSide(xi, beta, cut, cutTail);
        return bluntSide(xi, beta) - cutTail;
    }
    const floatw e1 = xi - beta, e2 = xi + beta;
    floatw density1, density2;
    const floatw Q1 = tailBeyond(e1, &density1), Q2 = tailBeyond(e2, &density2);
    const floatw i2e1 = secondTail(e1, Q1, density1), i2e2 = secondTail(e2, Q2, density2);
    const floatw i3e1 = thirdTail(e1, Q1, density1), i3e2 = thirdTail(e2, Q2, density2);
    const float r = 1.0f / beta;
    const floatw U = 1.5f * r * r * (i2e1 + i2e2 - r * (i3e1 - i3e2));
    if (!(cut < REACH)) return U;
    floatw lost = cutTail;
    if (anyw(e2 > cut)) lost = beyondCut(xi, beta, cut, e1, e2, i2e1, i3e1, i2e2, i3e2);
    if (anyw(e1 < -cut)) {
        // Mirrored: 1 - smoothstep turns the other end into the same problem, with a loss of Q minus this.
        lost += cutTail - beyondCut(-xi, beta, cut, -e2, -e1, secondTail(-e2, 1.0f - Q2, density2),
                                    thirdTail(-e2, 1.0f - Q2, density2), secondTail(-e1, 1.0f - Q1, density1),
                                    thirdTail(-e1, 1.0f - Q1, density1));
    }
    return U - lost;
}

typedef struct Far {
    floatw r, g, b;
} Far;

// U of the whole profile at the distance zeta behind the middle of the edge.
static inline Far farSideOfAll(__global const LutGaussian* gaussians, const uint count, const floatw zeta,
                               const float b, const float cut) {
    Far U = {0.0f, 0.0f, 0.0f};
    for (uint g = 0; g < count; ++g) {
        const LutGaussian G = gaussians[g];
        if (!anyw(zeta - b < REACH * G.sigma)) continue;
        const floatw u = farSide(zeta, b, G, cut);
        U.r = fma(u, (floatw)(G.red), U.r);
        U.g = fma(u, (floatw)(G.green), U.g);
        U.b = fma(u, (floatw)(G.blue), U.b);
    }
    return U;
}

// `end`: U where the filter ends. It is subtracted from every texel (closed ends); 0: nothing is subtracted.
// A profile so wide that almost nothing is left between the ends is straight there: 1/2 - z.
static inline void storeTexels(__global float4* line, const uint width, const uint x, const floatw r,
                               const floatw g, const floatw b, const floatw z, const float3 total,
                               const float3 end, const int closed) {
    float across[PEL_WIDTH];
    storew(z, 0, across);
    const float3 between = total - 2.0f * end;
    float red[PEL_WIDTH], green[PEL_WIDTH], blue[PEL_WIDTH];
    storew(r, 0, red);
    storew(g, 0, green);
    storew(b, 0, blue);
    for (uint lane = 0; lane < PEL_WIDTH && x + lane < width; ++lane) {
        // A tail that is nearly 0 may come out negative by rounding. No texel may be negative, on either
        // side.
        float3 U = clamp((float3)(red[lane], green[lane], blue[lane]), (float3)(0.0f), total);
        float3 lit = total - U;
        if (closed) {
            U = select((float3)(0.5f - across[lane]), (U - end) / between, between > 1e-3f * total);
            U = clamp(U, (float3)(0.0f), (float3)(1.0f));
            lit = 1.0f - U;
        }
        line[x + lane] = (float4)(lit, 0.0f);
        line[width - 1 - x - lane] = (float4)(U, 0.0f);
        if (x + lane == width - 1) line[width] = (float4)(lit, 0.0f);
    }
}

// One work-item: PEL_COLUMNS columns of the lit half of one row, and their mirror images, of one table of the
// stack. A copy of the last row and of the last column follows (shared/lut.h).
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void shadow_texels(
    const StackParams params, __global const StackedLut* restrict stack, __global float4* restrict texels) {
    const StackedLut table = stack[get_global_id(2)];
    __global const LutGaussian* gaussians = gaussiansOf(stack, table);
    const uint begin = params.width / 2 + get_global_id(0) * PEL_COLUMNS;
    const uint y = get_global_id(1);
    const float row = (float)min(y, params.height - 1);
    const float rowValue = fma(row + 0.5f, table.rowStep, table.rowMin);
    const float q = params.axis == PEL_LUT_AXIS_ROOT ? rowValue * rowValue : rowValue;
    const float b = 0.5f / (table.sharpening * q);
    const uint end = min(begin + PEL_COLUMNS, params.width);
    const float3 total = (float3)(table.total[0], table.total[1], table.total[2]);
    float3 endU = 0.0f;
    if (params.closedEnds && begin < end) {
        const Far U = farSideOfAll(gaussians, table.gaussians, (floatw)(0.5f / q), b, params.cut);
        float r[PEL_WIDTH], g[PEL_WIDTH], b_[PEL_WIDTH];
        storew(U.r, 0, r);
        storew(U.g, 0, g);
        storew(U.b, 0, b_);
        endU = clamp((float3)(r[0], g[0], b_[0]), (float3)(0.0f), 0.5f * total);
    }
    for (uint x = begin; x < end; x += PEL_WIDTH) {
        const floatw column = convert_floatw((intw)((int)x) + lanesw()) + 0.5f;
        const floatw w = fmin(column / (float)params.width, 1.0f);
        // p - 1/2 = (sqrt w - sqrt(1 - w)) / 2 without its cancellation
        floatw z = (column - 0.5f * (float)params.width) / (float)params.width / (sqrt(w) + sqrt(1.0f - w));
        if (params.axis == PEL_LUT_AXIS_ROOT)
            z = (column - 0.5f * (float)params.width) / (float)(max(params.width, 2u) - 1);
        z = fmin(z, 0.5f);
        const Far U = farSideOfAll(gaussians, table.gaussians, z / q, b, params.cut);
        const size_t line = get_global_id(2) * (params.height + 1) + y;
        storeTexels(texels + line * (params.width + 1), params.width, x, U.r, U.g, U.b, z, total, endU,
                    params.closedEnds);
    }
}
