// Albedo and radius of skin from maps of its pigments (docs/mathematics.md, section 15).
//
// Inputs: images of melanin, blood and perhaps oxygenation, of ids, of the albedo and the factor of the
// radius that other materials have (0: none). Tables: PEL_SKIN_SIDE x PEL_SKIN_SIDE nodes of the root of the
// albedo and the radius over that of the profile, melanin fastest, for PEL_OXYGENATIONS values of
// oxygenation. Outputs: albedo and radius where one of PEL_WIDTH pixels has a material. One work-item is
// PEL_WIDTH pixels of a row. Variants: PEL_FORMAT_... of the images, PEL_RADIUS_COMPONENT.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/profile_table.clh"
#include "lib/diffusion/radius.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"
#include "shared/skin_maps.h"

#define NODE_FLOATS 4
#define ROW_FLOATS (NODE_FLOATS * PEL_SKIN_SIDE)

typedef struct Skin {
    Vec3w root;  // of the albedo
    floatw radius;
} Skin;

// A component of the image, or of the profile where that is NaN, as a share of `most`.
static inline floatw shareOf(floatw component, float own, float most) {
    return clamp(selectw(component, (floatw)(own), isnan(component)), (floatw)(0.0f), (floatw)(most)) *
           (1.0f / most);
}

// Interpolates linearly between four nodes; `first`: offset of the first, in floats.
#if PEL_WIDTH == 1
static inline Skin nodesAround(__global const float* table, int first, float x, float y) {
    __global const float* node = table + first;
    const float4 low = mix(PEL_LOAD4(node), PEL_LOAD4(node + 4), x),
                 high = mix(PEL_LOAD4(node + ROW_FLOATS), PEL_LOAD4(node + ROW_FLOATS + 4), x),
                 v = mix(low, high, y);
    const Skin skin = {{v.x, v.y, v.z}, v.w};
    return skin;
}
#else
static inline Skin nodesAround(__global const float* table, intw first, floatw x, floatw y) {
    int at[PEL_WIDTH];
    storew(first, 0, at);
#define ROW_(a, b, c, d, to)                                                                     \
    betweenNodes(table + to + at[a], table + to + at[b], table + to + at[c], table + to + at[d], \
                 PEL_SHUFFLE16(x, x, a, a, a, a, b, b, b, b, c, c, c, c, d, d, d, d))
#define FOUR_(a, b, c, d)                                  \
    mix(ROW_(a, b, c, d, 0), ROW_(a, b, c, d, ROW_FLOATS), \
        PEL_SHUFFLE16(y, y, a, a, a, a, b, b, b, b, c, c, c, c, d, d, d, d))
    const float16 q0 = FOUR_(0, 1, 2, 3), q1 = FOUR_(4, 5, 6, 7);
    Skin skin;
#define FOURTHS_(a, b) PEL_SHUFFLE16(a, b, 3, 7, 11, 15, 19, 23, 27, 31, 3, 7, 11, 15, 19, 23, 27, 31).lo
#if PEL_WIDTH == 8
    skin.root = splitQuadruples(q0.lo, q0.hi, q1.lo, q1.hi);
    skin.radius = FOURTHS_(q0, q1);
#else
    const float16 q2 = FOUR_(8, 9, 10, 11), q3 = FOUR_(12, 13, 14, 15);
    skin.root = splitQuadruples(q0, q1, q2, q3);
    skin.radius = (float16)(FOURTHS_(q0, q1), FOURTHS_(q2, q3));
#endif
#undef FOURTHS_
#undef FOUR_
#undef ROW_
    return skin;
}
#endif

// Skin of a material whose profile is made of pigments. `pigments`: the pixels of the image.
static inline Skin skinOf(__global const PelSkinMaps* frame, __global const PelSkinMapsMaterial* material,
                          __global const float* tables, Vec3w pigments) {
    const float last = PEL_SKIN_SIDE - 1;
    const floatw u = sqrt(shareOf(pigments.x, material->own[0], frame->most[0])) * last,
                 v = sqrt(shareOf(pigments.y, material->own[1], frame->most[1])) * last;
    const intw i = min(convert_intw(u), (intw)(PEL_SKIN_SIDE - 2)),
               j = min(convert_intw(v), (intw)(PEL_SKIN_SIDE - 2));
    const floatw x = u - convert_floatw(i), y = v - convert_floatw(j);
    const int layer = ROW_FLOATS * PEL_SKIN_SIDE;
    tables += (size_t)(material->table - 1) * PEL_OXYGENATIONS * layer;
    intw first = i * NODE_FLOATS + j * ROW_FLOATS;
#if PEL_OXYGENATIONS > 1
    const floatw w = shareOf(pigments.z, material->own[2], 1.0f) * (float)(PEL_OXYGENATIONS - 1);
    const intw k = min(convert_intw(w), (intw)(PEL_OXYGENATIONS - 2));
    const floatw z = w - convert_floatw(k);
    first += k * layer;
    const Skin a = nodesAround(tables, first, x, y), b = nodesAround(tables + layer, first, x, y);
    const Skin skin = {add3(a.root, scale3(sub3(b.root, a.root), z)), a.radius + (b.radius - a.radius) * z};
    return skin;
#else
    return nodesAround(tables, first, x, y);
#endif
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void skin_maps(
    __global const PelSkinMaps* restrict frame, __global const float* restrict tables, __global uchar* skin,
    __global uchar* ids, __global uchar* albedo, __global uchar* radii, __global uchar* outAlbedo,
    __global uchar* outRadii) {
    const uint across = (frame->width + PEL_WIDTH - 1) / PEL_WIDTH, y = itemOfFolded() / across;
    if (y >= frame->height) return;
    const uint from = itemOfFolded() % across * PEL_WIDTH, x = vectorStart(from, frame->width);
    const intw column = lanesw() + (int)x;
    const maskw mine = (column >= (int)from) & (column < (int)frame->width);
    uintw id = (uintw)(1);
#if PEL_FORMAT_MATERIAL
    id = loadId(PEL_FORMAT_MATERIAL, imageSpan(ids, &frame->ids, x, y));
#endif
    maskw left = mine & (id != (uintw)(0));
    if (!anyw(left)) return;
    const Span span = imageSpan(skin, &frame->skin, x, y);
#if PEL_OXYGENATIONS > 1
    const Vec3w pigments = loadColor(PEL_FORMAT_SKIN, span);
#else
    Vec3w pigments;
    loadTwo(PEL_FORMAT_SKIN, span, &pigments.x, &pigments.y);
#endif
    Vec3w color = same3(0.0f);
    floatw radius = 1.0f;
#if PEL_FORMAT_RADIUS
    radius = loadRadius(imageSpan(radii, &frame->radii, x, y));
#endif
    while (anyw(left)) {  // nearly always all pixels have one material
        const uint one = greatestId(id, left);
        const maskw those = left & (id == one);
        left &= notw(those);
        __global const PelSkinMapsMaterial* material = &frame->materials[one];
        if (material->table) {
            const Skin found = skinOf(frame, material, tables, pigments);
            color = select3(color, mul3(found.root, found.root), those);
            radius = selectw(radius, radius * found.radius, those);
            continue;
        }
#if PEL_FORMAT_ALBEDO
        const Vec3w other = loadColor(PEL_FORMAT_ALBEDO, imageSpan(albedo, &frame->albedo, x, y));
#else
        const Vec3w other = loadUniform3(material->albedo);
#endif
        color = select3(color, other, those);
    }
    storeColor(PEL_FORMAT_OUT_ALBEDO, imageSpan(outAlbedo, &frame->outAlbedo, x, y), color, mine);
    storeScalar(PEL_FORMAT_OUT_RADII, imageSpan(outRadii, &frame->outRadii, x, y), radius, mine);
}
