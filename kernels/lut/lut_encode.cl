// Packs the texels of a look-up table (float4, with a copied column and row, shared/lut.h) for the host, in
// the encodings of sections 2 and 3 of the mathematics.
//
// Inputs: the texels of one table or of a stack. Output: rows without the copies. One work-item: one texel;
// one row in count_clipped.
// Variants: PEL_GROUP, work-items in a group.
#include "lib/image/half.clh"
#include "lib/lut/lut_lookup.clh"

// Index of this work-item's texel; the global ids are column, row and table.
static inline size_t texelIndex(const LutLayout lut) {
    return (get_global_id(2) * (lut.height + 1) + get_global_id(1)) * lut.rowTexels + get_global_id(0);
}
static inline size_t packedIndex(const LutLayout lut) {
    return (get_global_id(2) * lut.height + get_global_id(1)) * lut.width + get_global_id(0);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encode_float(
    const LutLayout lut, __global const float4* restrict texels, __global float* restrict packed) {
    const uint x = get_global_id(0);
    if (x >= lut.width) return;
    vstore3(texels[texelIndex(lut)].xyz, packedIndex(lut), packed);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encode_half(
    const LutLayout lut, __global const float4* restrict texels, __global ushort* restrict packed) {
    const uint x = get_global_id(0);
    if (x >= lut.width) return;
    const float4 texel = clamp(texels[texelIndex(lut)], -65504.0f, 65504.0f);
    vstore3(convert_ushort4(float4ToHalves(texel)).xyz, packedIndex(lut), packed);
}

// sat(2 (D - max0(u)) + 1/2): the change by scattering, doubled, around middle grey. Linear.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encode_curvature_bytes(
    const LutLayout lut, __global const float4* restrict texels, __global uchar* restrict packed) {
    const uint x = get_global_id(0);
    if (x >= lut.width) return;
    float4 residual = texels[texelIndex(lut)] - fmax(lutColumnCentre(lut, x), 0.0f);
    residual = fma(residual, (float4)(2.0f), (float4)(0.5f));
    residual.w = 1.0f;
    vstore4(convert_uchar4_sat_rte(residual * 255.0f), packedIndex(lut), packed);
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
    const uint x = get_global_id(0);
    if (x >= lut.width) return;
    const float fade = 25 * x < lut.width ? (float)(25 * x) / (float)lut.width : 1.0f;
    const float4 linear = clamp(fade * texels[texelIndex(lut)], 0.0f, 1.0f);
    float4 encoded = select(fma(pow(linear, (float4)(1.0f / 2.4f)), (float4)(1.055f), (float4)(-0.055f)),
                            12.92f * linear, linear <= 0.0031308f);
    encoded.w = 1.0f;
    vstore4(convert_uchar4_sat_rte(encoded * 255.0f), packedIndex(lut), packed);
}

// Specular tables are stored unchanged, like those of d'Eon and Luebke.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void encode_bytes(
    const LutLayout lut, __global const float4* restrict texels, __global uchar* restrict packed) {
    const uint x = get_global_id(0);
    if (x >= lut.width) return;
    float4 value = texels[texelIndex(lut)];
    value.w = 1.0f;
    vstore4(convert_uchar4_sat_rte(value * 255.0f), packedIndex(lut), packed);
}
