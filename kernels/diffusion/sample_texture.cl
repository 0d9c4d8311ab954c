// Replaces the irradiance of one material by light that was scattered in texture space: bilinear, repeated
// beyond [0, 1]. Where the texture is black, irradiance stays.
//
// Inputs: texture, texture coordinates, ids, irradiance. Output: an image like the irradiance. One
// work-group takes a tile. Variants: PEL_FORMAT_....
#include "lib/diffusion/item.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"
#include "shared/diffusion.h"
#include "shared/texture_scatter.h"

// A texel's column or row, repeated.
static inline uint repeated(float place, uint size) {
    const float wrapped = place - (float)size * floor(place / (float)size);
    return min((uint)wrapped, size - 1);
}

static inline Vec3w texelAt(__global const PelTextureSample* s, __global uchar* texture, uint x, uint y) {
    return loadColor(PEL_FORMAT_TEXTURE, imageSpan(texture, &s->texture, x, y));
}

static inline Vec3w mixed(Vec3w a, Vec3w b, float t) {
    return add3(a, scale3(sub3(b, a), t));
}

static inline Vec3w sampleAt(__global const PelTextureSample* s, __global uchar* texture, float u, float v) {
    if (!isfinite(u) || !isfinite(v)) return vec3(NAN, NAN, NAN);
    const uint width = s->texture.width, height = s->texture.height;
    const float x = (u - floor(u)) * (float)width - 0.5f, y = (v - floor(v)) * (float)height - 0.5f;
    const float left = floor(x), top = floor(y);
    const uint x0 = repeated(left, width), x1 = repeated(left + 1.0f, width), y0 = repeated(top, height),
               y1 = repeated(top + 1.0f, height);
    return mixed(mixed(texelAt(s, texture, x0, y0), texelAt(s, texture, x1, y0), x - left),
                 mixed(texelAt(s, texture, x0, y1), texelAt(s, texture, x1, y1), x - left), y - top);
}

// Returns 1 if the pixel takes its light from the texture.
static inline uint samplePixel(__global const PelTextureSample* s, __global uchar* texture,
                               __global uchar* uv, __global uchar* ids, __global uchar* irradiance,
                               __global uchar* out, uint x, uint y) {
    uint id = 1;
#if PEL_FORMAT_MATERIAL
    id = loadId(PEL_FORMAT_MATERIAL, imageSpan(ids, &s->ids, x, y));
#endif
    bool takes = id == s->id;
    Vec3w color;
    if (takes) {
        const Span at = imageSpan(uv, &s->uv, x, y);
        color = sampleAt(s, texture, gatherComponent(PEL_FORMAT_UV, at, 0),
                         gatherComponent(PEL_FORMAT_UV, at, 1));
        // Texels without the mesh are black: an island that is narrower than a texel may have no others.
        takes = color.x != 0.0f || color.y != 0.0f || color.z != 0.0f;
    }
    if (!takes) {
        if (!s->copies) return 0;
        color = loadColor(PEL_FORMAT_IRRADIANCE, imageSpan(irradiance, &s->irradiance, x, y));
    }
    storeColor(PEL_FORMAT_OUT, imageSpan(out, &s->out, x, y), color, 1);
    return takes;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void sample_texture(
    __global const PelTextureSample* restrict s, __global uchar* texture, __global uchar* uv,
    __global uchar* ids, __global uchar* irradiance, __global uchar* out, __global uint* restrict counters) {
    __local uint sum;
    const uint left = get_group_id(0) % s->tilesX * PEL_TEXTURE_TILE,
               top = get_group_id(0) / s->tilesX * PEL_TEXTURE_TILE;
    uint taken = 0;
    for (uint i = get_local_id(0); i < PEL_TEXTURE_TILE * PEL_TEXTURE_TILE; i += PEL_GROUP) {
        const uint x = left + i % PEL_TEXTURE_TILE, y = top + i / PEL_TEXTURE_TILE;
        if (x < s->width && y < s->height) taken += samplePixel(s, texture, uv, ids, irradiance, out, x, y);
    }
    addOfGroup(&counters[PEL_COUNT_PIXELS_COVERED], taken, &sum);
    if (get_local_id(0) != 0 || !sum) return;
    atomic_inc(&counters[PEL_COUNT_TILES_TAPPED]);
    atomic_add(&counters[PEL_COUNT_PIXELS_TAPPED], sum);
    atomic_add(&counters[PEL_COUNT_TAPS], 4 * sum);
}
