// The steps before and after a scattering method: light from the other side of thin sheets, powers of
// albedo, the gain of curved bodies, and the weight of the scattered light per pixel (docs/mathematics.md,
// sections 10, "Controls", and 12).
//
// prepare_irradiance: (irradiance + through * back) * albedo^before. finish_scatter: irradiance + weight *
// (scattered * gain - irradiance), times albedo^after, written or added. One work-item is one pixel.
// Variants: PEL_FORMAT_... of the images, 0 for an image that is not set.
#include "lib/diffusion/item.clh"
#include "lib/image/image.clh"
#include "lib/shading/curvature_gain.clh"
#include "lib/shading/material_id.clh"
#include "shared/blend.h"

static inline __global const PelBlendMaterial* materialAt(__global const PelBlendFrame* frame,
                                                          __global const PelBlendMaterial* materials,
                                                          __global uchar* ids, uint x, uint y) {
    uint id = 1;
#if PEL_FORMAT_MATERIAL
    id = loadId(PEL_FORMAT_MATERIAL, imageSpan(ids, &frame->material, x, y));
#endif
    return &materials[frame->materialOf[id]];
}

static inline Vec3w albedoPower(__global const PelBlendFrame* frame,
                                __global const PelBlendMaterial* material, __global uchar* albedo, uint x,
                                uint y, float power) {
    Vec3w a = vec3(material->albedo[0], material->albedo[1], material->albedo[2]);
#if PEL_FORMAT_ALBEDO
    a = loadColor(PEL_FORMAT_ALBEDO, imageSpan(albedo, &frame->albedo, x, y));
#endif
    if (power == 1.0f) return a;
    return vec3(pow(max0w(a.x), power), pow(max0w(a.y), power), pow(max0w(a.z), power));
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void prepare_irradiance(
    __global const PelBlendFrame* restrict frame, __global const PelBlendMaterial* restrict materials,
    __global uchar* irradiance, __global uchar* ids, __global uchar* back, __global uchar* albedo,
    __global uchar* out) {
    const uint x = itemOfFolded() % frame->width, y = itemOfFolded() / frame->width;
    if (y >= frame->height) return;
    __global const PelBlendMaterial* material = materialAt(frame, materials, ids, x, y);
    Vec3w e = loadColor(PEL_FORMAT_IRRADIANCE, imageSpan(irradiance, &frame->irradiance, x, y));
#if PEL_FORMAT_BACK
    if (material->through[0] + material->through[1] + material->through[2] > 0.0f) {
        const Vec3w through = vec3(material->through[0], material->through[1], material->through[2]);
        e = add3(e, mul3(through, loadColor(PEL_FORMAT_BACK, imageSpan(back, &frame->back, x, y))));
    }
#endif
    if (material->before > 0.0f) e = mul3(e, albedoPower(frame, material, albedo, x, y, material->before));
    storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, x, y), e, 1);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void finish_scatter(
    __global const PelBlendFrame* restrict frame, __global const PelBlendMaterial* restrict materials,
    __global uchar* irradiance, __global uchar* scattered, __global uchar* ids, __global uchar* weight,
    __global uchar* albedo, __global uchar* curvature, __global uchar* out) {
    const uint x = itemOfFolded() % frame->width, y = itemOfFolded() / frame->width;
    if (y >= frame->height) return;
    __global const PelBlendMaterial* material = materialAt(frame, materials, ids, x, y);
    Vec3w s = loadColor(PEL_FORMAT_SCATTERED, imageSpan(scattered, &frame->scattered, x, y));
#if PEL_FORMAT_MEAN_CURVATURE
    if (material->gain[0] > 0.0f) {
        const float h = loadScalar(PEL_FORMAT_MEAN_CURVATURE, imageSpan(curvature, &frame->curvature, x, y));
        s = mul3(s, curvatureGain(material->gain, material->gainSlope, material->gainSaturation,
                                  isfinite(h) ? h : 0.0f));
    }
#endif
#if PEL_FORMAT_SCATTER_WEIGHT
    if (material->weighs) {
        const float given = loadScalar(PEL_FORMAT_SCATTER_WEIGHT, imageSpan(weight, &frame->weight, x, y));
        const float w = given >= 0.0f ? fmin(given, 1.0f) : 0.0f;  // NaN: 0
        if (w < 1.0f) {
            const Vec3w e = loadColor(PEL_FORMAT_IRRADIANCE, imageSpan(irradiance, &frame->irradiance, x, y));
            s = w > 0.0f ? add3(e, scale3(sub3(s, e), w)) : e;
        }
    }
#endif
    if (material->after > 0.0f) s = mul3(s, albedoPower(frame, material, albedo, x, y, material->after));
    const Span to = imageSpan(out, &frame->out, x, y);
    if (frame->accumulate) s = add3(s, loadColor(PEL_FORMAT_OUT, to));
    storeColor(PEL_FORMAT_OUT, to, s, 1);
}
