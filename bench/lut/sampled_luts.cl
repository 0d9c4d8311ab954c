// The curvature table of form arc by plain sampling, as generators of such tables do it: what curvature_lut.cl is measured
// against on the same device. For benchmarks only.
//   sampledTexels    every texel by itself: cosine and the Gaussians of the profile at each sample
//   sampledSpread    P of the samples of each row, once a row
//   sampledFromRow   every texel from those: a cosine and a product per sample
//
// One work-item: PEL_WIDTH texels of a row; of sampledSpread a sample of a row. Variants: PEL_WIDTH.
#include "lib/width.clh"
#include "shared/lut_integral.h"

inline float sampleReach(const CurvatureLutParams params, const uint y, float* curvature) {
    *curvature = fma((float)y + 0.5f, params.rowStep, params.rowMin);
    return fmin(params.cut, M_PI_F / *curvature);
}

inline floatw columnAngle(const CurvatureLutParams params, const uint x) {
    const floatw column = convert_floatw((intw)((int)x) + lanesw()) + 0.5f;
    return acos(clamp(fma(column, 2.0f / (float)params.width, (floatw)(-1.0f)), -1.0f, 1.0f));
}

inline void storeRow(__global float* texels, const CurvatureLutParams params, const uint x, const uint y,
                     const floatw r, const floatw g, const floatw b) {
    float red[PEL_WIDTH], green[PEL_WIDTH], blue[PEL_WIDTH];
    storew(r, 0, red);
    storew(g, 0, green);
    storew(b, 0, blue);
    for (uint lane = 0; lane < PEL_WIDTH && x + lane < params.width; ++lane)
        vstore3((float3)(red[lane], green[lane], blue[lane]), (size_t)y * params.width + x + lane, texels);
}

__kernel void sampledTexels(const CurvatureLutParams params, __global const LutGaussian* gaussians,
                            const uint samples, __global float* texels) {
    const uint x = get_global_id(0) * PEL_WIDTH, y = get_global_id(1);
    float curvature;
    const float reach = sampleReach(params, y, &curvature), step = 2.0f * reach / (float)samples;
    const floatw theta = columnAngle(params, x);
    floatw r = 0.0f, g = 0.0f, b = 0.0f;
    for (uint i = 0; i < samples; ++i) {
        const float s = fma((float)i + 0.5f, step, -reach);
        const floatw lit = fmax(cos(theta - s * curvature), 0.0f);
        for (uint k = 0; k < params.gaussians; ++k) {
            const LutGaussian G = gaussians[k];
            const floatw t = (floatw)(s / G.sigma);
            const floatw density = exp(-0.5f * t * t) * (0.39894228f / G.sigma) * lit;
            r = fma(density, (floatw)(G.red), r);
            g = fma(density, (floatw)(G.green), g);
            b = fma(density, (floatw)(G.blue), b);
        }
    }
    storeRow(texels, params, x, y, r * step, g * step, b * step);
}

__kernel void sampledSpread(const CurvatureLutParams params, __global const LutGaussian* gaussians,
                            const uint samples, __global float4* spread) {
    const uint i = get_global_id(0), y = get_global_id(1);
    float curvature;
    const float reach = sampleReach(params, y, &curvature), step = 2.0f * reach / (float)samples;
    const float s = fma((float)i + 0.5f, step, -reach);
    float4 P = 0.0f;
    for (uint k = 0; k < params.gaussians; ++k) {
        const LutGaussian G = gaussians[k];
        const float t = s / G.sigma;
        P += exp(-0.5f * t * t) * (0.39894228f / G.sigma) * (float4)(G.red, G.green, G.blue, 0.0f);
    }
    P *= step;
    P.w = s * curvature;
    spread[(size_t)y * samples + i] = P;
}

__kernel void sampledFromRow(const CurvatureLutParams params, __global const float4* spread,
                             const uint samples, __global float* texels) {
    const uint x = get_global_id(0) * PEL_WIDTH, y = get_global_id(1);
    const floatw theta = columnAngle(params, x);
    floatw r = 0.0f, g = 0.0f, b = 0.0f;
    for (uint i = 0; i < samples; ++i) {
        const float4 P = spread[(size_t)y * samples + i];
        const floatw lit = fmax(cos(theta - P.w), 0.0f);
        r = fma(lit, (floatw)(P.x), r);
        g = fma(lit, (floatw)(P.y), g);
        b = fma(lit, (floatw)(P.z), b);
    }
    storeRow(texels, params, x, y, r, g, b);
}
