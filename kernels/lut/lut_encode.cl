// Packs the texels of a look-up table (float4, with a copied column and row, shared/lut.h) for the host, in
// the encodings of sections 2 and 3 of the mathematics.
//
// Inputs: the texels. Output: rows without the copies. One work-item: one texel; one row in count_clipped.
// Variants: PEL_GROUP, work-items in a group.
#include "lib/image/half.clh"
#include "lib/lut/lut_lookup.clh"

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encode_float(
    const LutLayout lut, __global const float4* restrict texels, __global float* restrict packed) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x >= lut.width) return;
    vstore3(texels[(size_t)y * lut.rowTexels + x].xyz, (size_t)y * lut.width + x, packed);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encode_half(
    const LutLayout lut, __global const float4* restrict texels, __global ushort* restrict packed) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x >= lut.width) return;
    const float4 texel = clamp(texels[(size_t)y * lut.rowTexels + x], -65504.0f, 65504.0f);
    vstore3(convert_ushort4(float4ToHalves(texel)).xyz, (size_t)y * lut.width + x, packed);
}

// sat(2 (D - max0(u)) + 1/2): the change by scattering, doubled, around middle grey. Linear.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encode_curvature_bytes(
    const LutLayout lut, __global const float4* restrict texels, __global uchar* restrict packed) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x >= lut.width) return;
    float4 residual = texels[(size_t)y * lut.rowTexels + x] - fmax(lutColumnCentre(lut, x), 0.0f);
    residual = fma(residual, (float4)(2.0f), (float4)(0.5f));
    residual.w = 1.0f;
    vstore4(convert_uchar4_sat_rte(residual * 255.0f), (size_t)y * lut.width + x, packed);
}

// One work-item: one row. Counts texels that the encoding above clips in some channel.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void count_clipped(
    const LutLayout lut, __global const float4* restrict texels, __global uint* restrict clipped) {
    const uint y = get_global_id(0);
    if (y >= lut.height) return;
    uint found = 0;
    for (uint x = 0; x < lut.width; ++x) {
        const float4 residual =
            fabs(texels[(size_t)y * lut.rowTexels + x] - fmax(lutColumnCentre(lut, x), 0.0f));
        found += fmax(fmax(residual.x, residual.y), residual.z) > 0.25f;
    }
    if (found) atomic_add(clipped, found);
}

// FaceWorks fades the first twenty-fifth of the columns to black, then stores sRGB.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encode_shadow_bytes(
    const LutLayout lut, __global const float4* restrict texels, __global uchar* restrict packed) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x >= lut.width) return;
    const float fade = 25 * x < lut.width ? (float)(25 * x) / (float)lut.width : 1.0f;
    const float4 linear = clamp(fade * texels[(size_t)y * lut.rowTexels + x], 0.0f, 1.0f);
    float4 encoded = select(fma(pow(linear, (float4)(1.0f / 2.4f)), (float4)(1.055f), (float4)(-0.055f)),
                            12.92f * linear, linear <= 0.0031308f);
    encoded.w = 1.0f;
    vstore4(convert_uchar4_sat_rte(encoded * 255.0f), (size_t)y * lut.width + x, packed);
}

// Specular tables are stored unchanged, like those of d'Eon and Luebke.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encode_bytes(
    const LutLayout lut, __global const float4* restrict texels, __global uchar* restrict packed) {
    const uint x = get_global_id(0), y = get_global_id(1);
    if (x >= lut.width) return;
    float4 value = texels[(size_t)y * lut.rowTexels + x];
    value.w = 1.0f;
    vstore4(convert_uchar4_sat_rte(value * 255.0f), (size_t)y * lut.width + x, packed);
}
