// Albedo and radius of skin from maps of its pigments (docs/mathematics.md, section 15).
//
// Inputs: images of melanin, blood and perhaps oxygenation, of ids, of the albedo and the factor of the
// radius that other materials have (0: none). Tables: PEL_SKIN_SIDE x PEL_SKIN_SIDE nodes of the root of the
// albedo and the radius over that of the profile, melanin fastest, for PEL_OXYGENATIONS values of
// oxygenation. Outputs: albedo and radius of every pixel of a material. One work-item is one pixel. Variants:
// PEL_FORMAT_... of the images, PEL_RADIUS_COMPONENT.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/radius.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"
#include "shared/skin_maps.h"

// A component of the image, or of the profile where that is NaN.
static inline float pigmentOf(Span span, int component, float own, float most) {
    const float v = pixelComponent(PEL_FORMAT_SKIN, span.first, span.plane, component);
    return clamp(isnan(v) ? own : v, 0.0f, most) / most;
}

// Interpolates linearly between four nodes.
static inline float4 mixedNodes(__global const float* node, float x, float y) {
    const float4 low = mix(vload4(0, node), vload4(1, node), x),
                 high = mix(vload4(PEL_SKIN_SIDE, node), vload4(PEL_SKIN_SIDE + 1, node), x);
    return mix(low, high, y);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void skin_maps(
    __global const PelSkinMaps* restrict frame, __global const float* restrict tables, __global uchar* skin,
    __global uchar* ids, __global uchar* albedo, __global uchar* radii, __global uchar* restrict outAlbedo,
    __global uchar* restrict outRadii) {
    const uint x = itemOfFolded() % frame->width, y = itemOfFolded() / frame->width;
    if (y >= frame->height) return;
    uint id = 1;
#if PEL_FORMAT_MATERIAL
    id = loadId(PEL_FORMAT_MATERIAL, imageSpan(ids, &frame->ids, x, y));
#endif
    __global const PelSkinMapsMaterial* material = &frame->materials[min(id, (uint)(PEL_SKIN_IDS - 1))];
    if (!material->set) return;
    float radius = 1.0f;
#if PEL_FORMAT_RADIUS
    radius = loadRadius(imageSpan(radii, &frame->radii, x, y));
#endif
    Vec3w color = vec3(material->albedo[0], material->albedo[1], material->albedo[2]);
    if (material->table) {
        const Span span = imageSpan(skin, &frame->skin, x, y);
        const float u = sqrt(pigmentOf(span, 0, material->own[0], frame->most[0])) * (PEL_SKIN_SIDE - 1),
                    v = sqrt(pigmentOf(span, 1, material->own[1], frame->most[1])) * (PEL_SKIN_SIDE - 1);
        const int i = min((int)u, PEL_SKIN_SIDE - 2), j = min((int)v, PEL_SKIN_SIDE - 2);
        const size_t layer = 4 * PEL_SKIN_SIDE * PEL_SKIN_SIDE;
        __global const float* node =
            tables + (material->table - 1) * PEL_OXYGENATIONS * layer + 4 * (j * PEL_SKIN_SIDE + i);
#if PEL_OXYGENATIONS > 1
        const float w = pigmentOf(span, 2, material->own[2], 1.0f) * (PEL_OXYGENATIONS - 1);
        const int k = min((int)w, PEL_OXYGENATIONS - 2);
        node += k * layer;
        const float4 found = mix(mixedNodes(node, u - (float)i, v - (float)j),
                                 mixedNodes(node + layer, u - (float)i, v - (float)j), w - (float)k);
#else
        const float4 found = mixedNodes(node, u - (float)i, v - (float)j);
#endif
        color = vec3(found.x * found.x, found.y * found.y, found.z * found.z);
        radius *= found.w;
    } else {
#if PEL_FORMAT_ALBEDO
        color = loadColor(PEL_FORMAT_ALBEDO, imageSpan(albedo, &frame->albedo, x, y));
#endif
    }
    storeColor(PEL_FMT_PLANAR_RGB32F, imageSpan(outAlbedo, &frame->outAlbedo, x, y), color, 1);
    storeScalar(PEL_FMT_R32F, imageSpan(outRadii, &frame->outRadii, x, y), radius, 1);
}
