// LUT texels (float4, with a copied column and row, shared/lut.h) packed for the host: row-major, without the
// copies. Section 2 and 3 of the mathematics define the 8-bit encodings, which are those of FaceWorks.
//
// One work-item: one texel. Variants: PEL_GROUP, work-items in a group.
#include "shared/lut.h"

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encodeFloat(
    const uint width, __global const float4* texels, __global float* packed) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x >= width) return;
    vstore3(texels[(size_t)y * (width + 1) + x].xyz, (size_t)y * width + x, packed);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encodeHalf(const uint width,
                                                                                __global const float4* texels,
                                                                                __global half* packed) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x >= width) return;
    vstore_half3_rte(texels[(size_t)y * (width + 1) + x].xyz, (size_t)y * width + x, packed);
}

// sat(2 (D - max0(u)) + 1/2): what scattering changes, doubled, about the middle grey. Linear.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encodeCurvatureBytes(
    const uint width, __global const float4* texels, __global uchar* packed) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x >= width) return;
    const float u = ((float)(2 * x + 1) - (float)width) / (float)width;
    float4 residual = texels[(size_t)y * (width + 1) + x] - fmax(u, 0.0f);
    residual = fma(residual, (float4)(2.0f), (float4)(0.5f));
    residual.w = 1.0f;
    vstore4(convert_uchar4_sat_rte(residual * 255.0f), (size_t)y * width + x, packed);
}

// The peer fades the first twenty-fifth of the columns to black, then stores sRGB.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encodeShadowBytes(
    const uint width, __global const float4* texels, __global uchar* packed) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x >= width) return;
    const float fade = 25 * x < width ? (float)(25 * x) / (float)width : 1.0f;
    const float4 linear = clamp(fade * texels[(size_t)y * (width + 1) + x], 0.0f, 1.0f);
    float4 encoded = select(fma(pow(linear, (float4)(1.0f / 2.4f)), (float4)(1.055f), (float4)(-0.055f)),
                            12.92f * linear, linear <= 0.0031308f);
    encoded.w = 1.0f;
    vstore4(convert_uchar4_sat_rte(encoded * 255.0f), (size_t)y * width + x, packed);
}
