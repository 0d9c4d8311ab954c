// The surface under each pixel, for methods that gather by taps (shared/gather.h; docs/mathematics.md,
// section 10).
//
// Inputs: images of irradiance, of positions (length) or depth, of ids (0 is background), of weights and
// radii. Output: PEL_GATHER_FLOATS floats a pixel. gather_points copies the images; one work-item is a
// pixel. gather_areas measures pixels against their neighbours and flags tiles that have something to
// gather; one work-group is one tile. Variants: PEL_FORMAT_IRRADIANCE, PEL_FORMAT_POSITION or
// PEL_FORMAT_DEPTH, PEL_FORMAT_MATERIAL (0: everything is id 1), PEL_FORMAT_SCATTER_WEIGHT and
// PEL_FORMAT_RADIUS (0: all 1).
#include "lib/diffusion/gather.clh"
#include "lib/diffusion/item.clh"
#include "lib/diffusion/radius.clh"
#include "lib/diffusion/usable_light.clh"
#include "lib/image/image.clh"
#include "lib/shading/position.clh"

// A surface seen at a smaller cosine counts with the area it would have at this one: where the surface
// turns away inside a pixel, its normal does not hold for the whole area.
#define MIN_COSINE 0.25f

#define COVERED (1u << 31)  // of the flags of a tile: a pixel of it may gather

static inline float clampedShare(float v) {
    return v >= 0.0f ? fmin(v, 1.0f) : 0.0f;  // NaN: 0
}

// Copies one pixel.
static inline void copyPoint(__global const PelGatherFrame* frame, __global uchar* irradiance,
                             __global uchar* position, __global uchar* ids, __global uchar* weight,
                             __global uchar* radii, __global float* points, uint x, uint y, uint* covered,
                             uint* invalid) {
    uint id = 1;
#if PEL_FORMAT_MATERIAL
    id = loadId(PEL_FORMAT_MATERIAL, imageSpan(ids, &frame->ids, x, y));
#endif
    if (id >= PEL_DIFFUSION_IDS || !(frame->sources[id >> 5] >> (id & 31) & 1u)) id = 0;
    float4 p = (float4)(0.0f), e = (float4)(0.0f), pixel = (float4)(0.0f, 0.0f, 1.0f, 1.0f);
    if (id) {
        const Span span = imageSpan(position, &frame->position, x, y);
#if PEL_FORMAT_POSITION
        const Vec3w at = loadColor(PEL_FORMAT_POSITION, span);
#else
        const Vec3w at = positionFromDepth(frame->inverseViewProjection, frame->width, frame->height, x, y,
                                           loadScalar(PEL_FORMAT_DEPTH, span));
#endif
        const Vec3w light = loadColor(PEL_FORMAT_IRRADIANCE, imageSpan(irradiance, &frame->irradiance, x, y));
        const bool gathers = frame->materialOf[id] != 0, sound = finite3(at) && usableLight(light);
        *covered = gathers, *invalid = gathers && !sound;
        if (sound) {
            p = (float4)(at.x - frame->origin[0], at.y - frame->origin[1], at.z - frame->origin[2], 0.0f);
            e = (float4)(light.x, light.y, light.z, 0.0f);
#if PEL_FORMAT_SCATTER_WEIGHT
            pixel.w =
                clampedShare(loadScalar(PEL_FORMAT_SCATTER_WEIGHT, imageSpan(weight, &frame->weight, x, y)));
#endif
#if PEL_FORMAT_RADIUS
            pixel.z = loadRadius(imageSpan(radii, &frame->radii, x, y));
#endif
        } else {
            id = 0;
        }
    }
    e.w = as_float(id);
    __global float* to = points + PEL_GATHER_FLOATS * ((size_t)y * frame->width + x);
    PEL_STORE4(p, to + PEL_GATHER_POINT);
    PEL_STORE4(e, to + PEL_GATHER_LIGHT);
    PEL_STORE4(pixel, to + PEL_GATHER_PIXEL);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void gather_points(
    __global const PelGatherFrame* restrict frame, __global uchar* irradiance, __global uchar* position,
    __global uchar* ids, __global uchar* weight, __global uchar* radii, __global float* points,
    __global uint* restrict counters) {
    const uint x = itemOfFolded() % frame->width, y = itemOfFolded() / frame->width;
    uint covered = 0, invalid = 0;
    if (y < frame->height)
        copyPoint(frame, irradiance, position, ids, weight, radii, points, x, y, &covered, &invalid);
    PEL_ADD_OF_GROUP(&counters[PEL_COUNT_PIXELS_COVERED], covered);
    PEL_ADD_OF_GROUP(&counters[PEL_COUNT_IRRADIANCE_INVALID], invalid);
}

typedef struct Step {
    float3 v;
    float length2;  // FLT_MAX: there is none
} Step;

// The position of a pixel, without the area behind it, which another work-item may be writing.
static inline float3 pointOf(__global const float* points, size_t pixel) {
    return vload3(0, points + PEL_GATHER_FLOATS * pixel + PEL_GATHER_POINT);
}

// The shorter of the steps to the neighbours that are of the same object: the longer one may lead off the
// surface.
static inline Step shorterStep(__global const float* points, size_t here, long to, bool before, bool after,
                               float3 p, uint id) {
    Step step = {(float3)(0.0f), FLT_MAX};
    for (int side = -1; side <= 1; side += 2) {
        if (!(side < 0 ? before : after)) continue;
        const size_t at = (size_t)((long)here + side * to);
        if (as_uint(gathered(points, at, PEL_GATHER_LIGHT).w) != id) continue;
        const float3 v = (pointOf(points, at) - p) * (float)side;
        const float length2 = dot(v, v);
        if (length2 < step.length2) step.v = v, step.length2 = length2;
    }
    return step;
}

// The part of a step that is across the view.
static inline float across(__global const PelGatherFrame* frame, float3 p, float3 step) {
    float3 view = (float3)(frame->direction[0], frame->direction[1], frame->direction[2]);
    if (frame->view == PEL_VIEW_POINT) view = p * rsqrt(fmax(dot(p, p), FLT_MIN));
    if (frame->view != PEL_VIEW_UNKNOWN) step -= view * dot(step, view);
    return sqrt(dot(step, step));
}

static inline void measurePixel(__global const PelGatherFrame* frame, __global float* points, uint x,
                                uint y) {
    const size_t here = (size_t)y * frame->width + x;
    const float3 p = pointOf(points, here);
    const uint id = as_uint(gathered(points, here, PEL_GATHER_LIGHT).w);
    const Step right = shorterStep(points, here, 1, x > 0, x + 1 < frame->width, p, id);
    const Step down = shorterStep(points, here, (long)frame->width, y > 0, y + 1 < frame->height, p, id);
    const bool noRight = right.length2 == FLT_MAX, noDown = down.length2 == FLT_MAX;
    if (noRight && noDown) return;  // a lone pixel has no size
    const float3 normal = cross(right.v, down.v);
    float area = sqrt(dot(normal, normal));
    float wide = across(frame, p, right.v), high = across(frame, p, down.v);
    if (noRight) wide = high, area = down.length2;  // a line of pixels counts as facing the camera
    if (noDown) high = wide, area = right.length2;
    if (frame->view == PEL_VIEW_UNKNOWN) wide = high = fmin(wide, high);
    area = fmin(area, wide * high * (1.0f / MIN_COSINE));
    if (!isfinite(area) || !isfinite(wide) || !isfinite(high) || !(area > 0.0f)) return;
    __global float* to = points + PEL_GATHER_FLOATS * here;
    to[PEL_GATHER_POINT + 3] = area;
    to[PEL_GATHER_PIXEL] = wide, to[PEL_GATHER_PIXEL + 1] = high;
}

// Measures a pixel. Returns its flags for the tile.
static inline uint measured(__global const PelGatherFrame* frame, __global float* points,
                            __global const PelGatherMaterial* materials, uint x, uint y) {
    const size_t at = PEL_GATHER_FLOATS * ((size_t)y * frame->width + x);
    const uint id = as_uint(points[at + PEL_GATHER_LIGHT + 3]);
    if (!id) return 0;
    measurePixel(frame, points, x, y);
    const uint material = frame->materialOf[id];
    if (!material) return PEL_TILE_LIT;
    const float4 pixel = PEL_LOAD4(points + at + PEL_GATHER_PIXEL);
    // If all taps fall into the pixel itself, its irradiance is already the result.
    const float radius = materials[material - 1].farthest * pixel.z;
    const bool wide = radius > fmin(pixel.x, pixel.y) || frame->everywhere;
    if (pixel.w > 0.0f && pixel.x > 0.0f && wide) return PEL_TILE_LIT | COVERED | PEL_TILE_GATHERS;
    points[at + PEL_GATHER_PIXEL + 2] = -pixel.z;  // read only by other work-items
    return PEL_TILE_LIT | COVERED;
}

// A tile: PEL_TILE_GATHERS, PEL_TILE_LIT.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void gather_areas(
    __global const PelGatherFrame* restrict frame, __global float* points,
    __global const PelGatherMaterial* restrict materials, __global uint* tiles,
    __global uint* restrict counters) {
    __local uint flags;
    const uint tile = get_group_id(0), item = get_local_id(0);
    if (item == 0) flags = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint mine = 0;
    for (uint pixel = item; pixel < PEL_DIFFUSION_TILE * PEL_DIFFUSION_TILE; pixel += PEL_GROUP) {
        const uint x = tile % frame->tilesX * PEL_DIFFUSION_TILE + pixel % PEL_DIFFUSION_TILE,
                   y = tile / frame->tilesX * PEL_DIFFUSION_TILE + pixel / PEL_DIFFUSION_TILE;
        if (x < frame->width && y < frame->height) mine |= measured(frame, points, materials, x, y);
    }
    if (mine) atomic_or(&flags, mine);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item != 0) return;
    tiles[tile] = flags & (PEL_TILE_GATHERS | PEL_TILE_LIT);
    if (flags & COVERED) atomic_inc(&counters[PEL_COUNT_TILES_COVERED]);
    if (flags & PEL_TILE_GATHERS) atomic_inc(&counters[PEL_COUNT_TILES_TAPPED]);
}
