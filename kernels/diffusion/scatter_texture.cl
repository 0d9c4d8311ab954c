// Scattering in texture space by a chain of Gaussians (docs/mathematics.md, section 7) [d'Eon, Luebke
// 2007].
//
// texture_light: irradiance * albedo^before, with a coverage of 1. texture_blur: one filter along u or v,
// with Gaussian weights of lengths on the surface, over covered texels of the same island. texture_result:
// times albedo^after; texels within two of a covered one take the value of the nearest covered texel. One
// work-group takes tiles with covered texels, or texels. Variants: PEL_FORMAT_....
#include "lib/diffusion/item.clh"
#include "lib/diffusion/texels.clh"
#include "lib/diffusion/usable_light.clh"
#include "lib/image/image.clh"

#define MIN_SIGMA 0.8f  // texels; narrower Gaussians are three samples with their variance
#define FARTHEST 3.0f   // sigmas
#define LARGEST_STRIDE 16384.0f
#define PAD 2  // texels

static inline Vec3w power3(Vec3w a, float power) {
    if (power == 1.0f) return a;
    return vec3(pow(max0w(a.x), power), pow(max0w(a.y), power), pow(max0w(a.z), power));
}

static inline Vec3w albedoAt(__global const PelTextureFrame* frame, __global uchar* albedo, uint x, uint y,
                             float power) {
#if PEL_FORMAT_ALBEDO
    if (power != 0.0f)
        return power3(loadColor(PEL_FORMAT_ALBEDO, imageSpan(albedo, &frame->albedo, x, y)), power);
#endif
    return vec3(1.0f, 1.0f, 1.0f);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void texture_light(
    __global const PelTextureFrame* restrict frame, __global const float4* restrict stretch,
    __global uchar* irradiance, __global uchar* albedo, __global float4* light,
    __global uint* restrict counters) {
    const uint x = itemOfFolded() % frame->width, y = itemOfFolded() / frame->width;
    if (y >= frame->height) return;
    const size_t at = (size_t)y * frame->width + x;
    float4 result = (float4)(0.0f);
    if (as_uint(stretch[at].w)) {
        const Vec3w e = loadColor(PEL_FORMAT_IRRADIANCE, imageSpan(irradiance, &frame->irradiance, x, y));
        const Vec3w l = mul3(e, albedoAt(frame, albedo, x, y, frame->before));
        if (usableLight(l) && finite3(albedoAt(frame, albedo, x, y, frame->after)))
            result = (float4)(l.x, l.y, l.z, 1.0f);
        else
            atomic_inc(&counters[PEL_COUNT_TEXELS_INVALID]);
    }
    light[at] = result;
}

static inline float lengthOf(float4 stretch, bool down) {
    return down ? stretch.y : stretch.x;
}

// The light on one side of a texel, `available` texels of the same island: the sum of light times a Gaussian
// of the distance on the surface, over lengths of texels. `step`: from one texel to the next.
static inline float4 lightOfSide(__global const float4* stretch, __global const float4* light, size_t at,
                                 long step, int available, bool down, float variance, float spacing) {
    const float perVariance = 0.5f / variance, farthest = FARTHEST * sqrt(variance) - 0.5f * spacing;
    float4 sum = (float4)(0.0f), weighted = light[at];  // of the last sample
    float distance = 0.0f, length = lengthOf(stretch[at], down), strideLength = 0.0f;
    int before = 0, stride = 0;  // texels: of the last step; of one for texels of strideLength
    while (available > 0 && distance < farthest) {
        if (length != strideLength)
            strideLength = length,
            stride = length > 0.0f ? (int)clamp(spacing / length, 1.0f, LARGEST_STRIDE) : 1;
        int texels = min(stride, available);
        float there = lengthOf(stretch[(size_t)((long)at + texels * step)], down);
        if (texels > 1 && there * (float)texels > 2.0f * spacing) {  // coarser from somewhere between
            texels = (int)fmax(spacing / there, 1.0f);
            there = lengthOf(stretch[(size_t)((long)at + texels * step)], down);
        }
        at = (size_t)((long)at + texels * step), available -= texels;
        // Each sample stands for half of the texels to its neighbours.
        sum += 0.5f * (float)(before + texels) * length * weighted;
        distance += 0.5f * (length + there) * (float)texels;
        weighted = exp(-distance * distance * perVariance) * light[at];
        length = there, before = texels;
    }
    return sum + 0.5f * (float)(available > 0 ? before : before + 1) * length * weighted;
}

// One texel after a blur by `variance`, on top of one of width `before`.
static inline float4 blurTexel(__global const float4* stretch, __global const float4* light, size_t at,
                               long step, bool down, float variance, float before) {
    const float4 own = stretch[at], here = light[at];
    const float size = lengthOf(own, down);
    if (!(here.w > 0.0f) || !(size > 0.0f)) return here;
    const uint run = as_uint(down ? own.w : own.z) & ~PEL_TEXEL_COVERED;
    const int preceding = (int)(run & 0xffff), following = (int)(run >> 16);
    const size_t last = preceding ? (size_t)((long)at - step) : at,
                 next = following ? (size_t)((long)at + step) : at;
    const float toLast = 0.5f * (size + lengthOf(stretch[last], down)),
                toNext = 0.5f * (size + lengthOf(stretch[next], down));
    float4 sum;
    if (variance < MIN_SIGMA * MIN_SIGMA * toLast * toNext) {
        const float4 change = (light[last] - here) / toLast + (light[next] - here) / toNext;
        sum = here + variance / (toLast + toNext) * change;
    } else {
        // Samples lie at most half a sigma apart, and no further than the previous blur smooths.
        const float spacing = fmin(0.5f * sqrt(variance), before);
        sum = lightOfSide(stretch, light, at, -step, preceding, down, variance, spacing) +
              lightOfSide(stretch, light, at, step, following, down, variance, spacing);
    }
    return sum.w > 0.0f ? (float4)(sum.xyz / sum.w, 1.0f) : (float4)(0.0f);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void texture_blur(
    __global const PelTextureFrame* restrict frame, __global const PelTextureBlur* restrict blurs, uint which,
    __global const float4* restrict stretch, __global const uint* restrict tiles,
    __global const float4* light, __global float4* blurred, __global float4* result) {
    __global const PelTextureBlur* blur = &blurs[which];
    const uint count = frame->tilesX * ((frame->height + PEL_TEXTURE_TILE - 1) / PEL_TEXTURE_TILE);
    const bool down = blur->down != 0;
    const float4 weight = (float4)(blur->weight[0], blur->weight[1], blur->weight[2], 1.0f);
    for (uint tile = get_group_id(0); tile < count; tile += get_num_groups(0)) {
        if (!tiles[tile]) continue;
        const uint left = tile % frame->tilesX * PEL_TEXTURE_TILE,
                   top = tile / frame->tilesX * PEL_TEXTURE_TILE;
        for (uint item = get_local_id(0); item < PEL_TEXTURE_TILE * PEL_TEXTURE_TILE; item += PEL_GROUP) {
            const uint x = left + item % PEL_TEXTURE_TILE, y = top + item / PEL_TEXTURE_TILE;
            if (x >= frame->width || y >= frame->height) continue;
            const size_t at = (size_t)y * frame->width + x;
            const float4 b = blurTexel(stretch, light, at, down ? (long)frame->width : 1, down,
                                       blur->variance, sqrt(blur->before));
            blurred[at] = b;
            if (down)
                result[at] = blur->first ? weight * b : (float4)(result[at].xyz + weight.xyz * b.xyz, b.w);
        }
    }
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void texture_result(
    __global const PelTextureFrame* restrict frame, __global const float4* light,
    __global const float4* result, __global uchar* albedo, __global uchar* out) {
    const uint x = itemOfFolded() % frame->width, y = itemOfFolded() / frame->width;
    if (y >= frame->height) return;
    const size_t at = (size_t)y * frame->width + x;
    float4 best = (float4)(0.0f);
    uint bestX = x, bestY = y;
    if (light[at].w > 0.0f) {
        best = result[at];
    } else {
        int nearest = PAD * PAD * 2 + 1;
        for (int j = -PAD; j <= PAD; ++j)
            for (int i = -PAD; i <= PAD; ++i) {
                const int u = (int)x + i, v = (int)y + j, distance = i * i + j * j;
                if (u < 0 || v < 0 || u >= (int)frame->width || v >= (int)frame->height ||
                    distance >= nearest)
                    continue;
                const size_t there = (size_t)v * frame->width + u;
                if (!(light[there].w > 0.0f)) continue;
                nearest = distance, best = result[there], bestX = (uint)u, bestY = (uint)v;
            }
    }
    const Vec3w s = mul3(vec3(best.x, best.y, best.z), albedoAt(frame, albedo, bestX, bestY, frame->after));
    const bool there = best.w > 0.0f;
    storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->out, x, y),
               vec3(there ? s.x : 0.0f, there ? s.y : 0.0f, there ? s.z : 0.0f), 1);
}
