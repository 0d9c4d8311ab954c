// Light of earlier frames in light that is scattered by taps (docs/mathematics.md, section 10, "History").
//
// Only light from beyond a pixel is kept, since it changes little between neighbours; light from within the
// pixel comes from each frame's own irradiance. Inputs: the surface (gather_surface.cl), tables of profiles,
// light that this frame scatters from beyond each pixel (four floats a pixel, the last one unused), motion
// since the last frame, and the history up to it. Outputs: an image like the irradiance; the history up to
// this frame. One work-group takes tiles, one work-item columns of their pixels. Variants: PEL_FORMAT_OUT;
// PEL_FORMAT_MOTION (0: nothing moves), PEL_MOTION_COMPONENTS; PEL_HALF.
#include "lib/diffusion/gather.clh"
#include "lib/diffusion/item.clh"

// The history of a pixel, four floats: red, with an id (0: nothing) in its lowest byte; green, with the
// number of frames in it; blue; distance from the camera.
#define MAX_FRAMES 31u

// Standard errors that a change of the mean light round a pixel must exceed to count. Measured on clips of a
// head: with 1 the noise of taps counts as change, with 3 moving light lags behind.
#define CHANGE_ERRORS 2.0f

static inline bool outside(__global const PelGatherFrame* frame, int x, int y) {
    return x < 0 || y < 0 || x >= (int)frame->width || y >= (int)frame->height;
}

static inline uint byteOf(float value) {
    return as_uint(value) & 0xffu;
}

static inline float withoutByte(float value) {
    return as_float(as_uint(value) & ~0xffu);
}

// Rounded, so that light does not fade from frame to frame.
static inline float withByte(float value, uint byte) {
    return as_float(((as_uint(value) + 0x80u) & ~0xffu) | byte);
}

// `place`: a point from PelGatherFrame.origin. `last`: that origin, or the direction, in the last frame.
static inline float distanceTo(__global const PelGatherFrame* frame, float3 place, float3 last) {
    if (frame->view == PEL_VIEW_DIRECTION) return dot(place, last);
    const float3 moved = (float3)(frame->origin[0], frame->origin[1], frame->origin[2]) - last;
    return length(place + moved);
}

static inline float3 viewOf(__global const PelGatherFrame* frame) {
    if (frame->view == PEL_VIEW_DIRECTION)
        return (float3)(frame->direction[0], frame->direction[1], frame->direction[2]);
    return (float3)(frame->origin[0], frame->origin[1], frame->origin[2]);
}

// Columns and rows to where a pixel was, and how much farther away it was.
static inline float3 motionOf(__global const PelGatherFrame* frame, __global uchar* motion, uint x, uint y) {
#if PEL_MOTION_COMPONENTS == 3
    const Vec3w moved = loadColor(PEL_FORMAT_MOTION, imageSpan(motion, &frame->motion, x, y));
    return (float3)(moved.x, moved.y, moved.z);
#elif PEL_FORMAT_MOTION
    float right, down;
    loadTwo(PEL_FORMAT_MOTION, imageSpan(motion, &frame->motion, x, y), &right, &down);
    return (float3)(right, down, 0.0f);
#else
    return (float3)(0.0f);
#endif
}

static inline float4 lightOf(float4 history) {
    return (float4)(withoutByte(history.x), withoutByte(history.y), history.z, 0.0f);
}

// Light interpolated at the previous position of a pixel, and the number of frames in it; 0 if another
// surface was there.
static inline float4 earlierLight(__global const PelGatherFrame* frame, __global const float* history,
                                  const GatherPixel* p, float4 point, uint id, float3 motion, float3 last,
                                  uint* frames) {
    const float column = (float)p->x + motion.x, row = (float)p->y + motion.y;
    float4 light = (float4)(0.0f);
    float sum = 0.0f;
    *frames = 0;
    // False for NaN.
    if (!(column > -1.0f && row > -1.0f && column < (float)frame->width && row < (float)frame->height))
        return light;
    const float distance = distanceTo(frame, point.xyz, last) + motion.z;
    const int left = (int)floor(column), top = (int)floor(row);
    for (int k = 0; k < 4; ++k) {
        const int x = left + (k & 1), y = top + (k >> 1);
        const float weight = (1.0f - fabs(column - (float)x)) * (1.0f - fabs(row - (float)y));
        if (!(weight > 0.0f) || outside(frame, x, y)) continue;
        const float4 there = PEL_LOAD4(history + 4 * ((size_t)y * frame->width + (size_t)x));
        const float apart = there.w - distance;
        if (byteOf(there.x) != id || !(apart * apart <= PEL_ALIKE * point.w)) continue;
        const uint count = byteOf(there.y);
        *frames = sum > 0.0f ? min(*frames, count) : count;
        light += weight * lightOf(there);
        sum += weight;
    }
    return sum > 0.0f ? light / sum : light;
}

// Statistics of the pixels around one that are on its surface. At half rate, interpolated pixels add nothing.
typedef struct Around {
    float4 low, high;  // of this frame's light
    float4 change;     // of light from the history to this frame, less the part that noise explains
} Around;

// `earlier`: earlierLight(). The history of the neighbours is read at the pixels nearest to their previous
// positions, all with the same offset as this pixel's.
static inline Around lightAround(__global const PelGatherFrame* frame, __global const float* points,
                                 __global const float* fresh, __global const float* history,
                                 const GatherPixel* p, float4 point, uint id, float3 motion, float4 earlier) {
    const int step = 1 << PEL_HALF, right = (int)floor(motion.x + 0.5f), down = (int)floor(motion.y + 0.5f);
    Around around = {(float4)(FLT_MAX), (float4)(-FLT_MAX), (float4)(0.0f)};
    float4 sum = (float4)(0.0f), squares = (float4)(0.0f), beside = (float4)(0.0f);
    float count = 0.0f;
    bool known = false;
    for (int dy = -step; dy <= step; dy += step)
        for (int dx = -step; dx <= step; dx += step) {
            const int x = (int)p->x + dx, y = (int)p->y + dy;
            if (outside(frame, x, y)) continue;
            const size_t there = (size_t)y * frame->width + (size_t)x;
            if (!sameSurface(points, there, id, point)) continue;
            const float4 light = PEL_LOAD4(fresh + 4 * there);
            around.low = fmin(around.low, light), around.high = fmax(around.high, light);
            if (outside(frame, x + right, y + down)) continue;
            const float4 before =
                PEL_LOAD4(history + 4 * ((size_t)(y + down) * frame->width + (size_t)(x + right)));
            if (byteOf(before.x) != id) continue;
            const float4 difference = light - lightOf(before);
            sum += difference, squares += difference * difference, count += 1.0f;
            if (!dx && !dy) beside = lightOf(before) - earlier, known = true;
        }
    if (!known) return around;
    const float4 mean = sum / count, error2 = fmax(squares / count - mean * mean, (float4)(0.0f)) / count,
                 change = mean + beside, change2 = fmax(change * change, (float4)(FLT_MIN));
    around.change = change * fmax(1.0f - CHANGE_ERRORS * CHANGE_ERRORS * error2 / change2, (float4)(0.0f));
    return around;
}

// `last`: distanceTo(); its fourth component is 0 if there is no history.
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void blend_history(
    __global const PelGatherFrame* restrict frame, __global const float* restrict points,
    __global const PelGatherMaterial* restrict materials, __global const float* restrict nodes,
    __global const float* restrict fresh, __global uchar* motion, __global const float* restrict before,
    const float4 last, __global float* restrict after, __global uchar* out,
    __global uint* restrict counters) {
    uint taken = 0;
    for (uint tile = get_group_id(0); tile < frame->tilesX * frame->tilesY; tile += get_num_groups(0))
        for (uint item = get_local_id(0); item < PEL_TILE_ITEMS; item += PEL_GROUP) {
            GatherPixel p;
            if (!loadPixel(frame, points, materials, columnOf(frame, tile, item), rowOf(frame, tile, item),
                           &p))
                continue;
            float4 light = PEL_LOAD4(fresh + 4 * p.at), kept = (float4)(0.0f);
            if (p.material) {
                const float4 point = gathered(points, p.at, PEL_GATHER_POINT);
                const uint id = as_uint(gathered(points, p.at, PEL_GATHER_LIGHT).w);
                const float3 moved = motionOf(frame, motion, p.x, p.y);
                uint frames = 0;
                float4 earlier;
                if (last.w > 0.0f)
                    earlier = earlierLight(frame, before, &p, point, id, moved, last.xyz, &frames);
                if (frames) {
                    const Around around =
                        lightAround(frame, points, fresh, before, &p, point, id, moved, earlier);
                    const float weight = fmin(frame->historyWeight, (float)frames / (float)(frames + 1));
                    light += weight * (clamp(earlier + around.change, around.low, around.high) - light);
                    ++taken;
                }
                kept = (float4)(withByte(light.x, id), withByte(light.y, min(frames + 1, MAX_FRAMES)),
                                light.z, distanceTo(frame, point.xyz, viewOf(frame)));
                const float4 e = gathered(points, p.at, PEL_GATHER_LIGHT);
                light += e + gathered(points, p.at, PEL_GATHER_PIXEL).w * (ownLight(points, nodes, &p) - e);
            }
            PEL_STORE4(kept, after + 4 * p.at);
            storeColor(PEL_FORMAT_OUT, imageSpan(out, &frame->blended, p.x, p.y),
                       vec3(light.x, light.y, light.z), 1);
        }
    PEL_ADD_COUNT(&counters[PEL_COUNT_PIXELS_HISTORY], taken);
}
