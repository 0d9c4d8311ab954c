// Curvature per pixel from normals and positions (lib/shading/screen_curvature.clh has the method; section 5
// of the mathematics).
//
// Inputs: images of unit normals, of positions (length) or depth, of ids (0 is background); params. Output:
// an R32F image, 1/length, 0 for background and for pixels that cannot be measured. One work-item: PEL_WIDTH
// pixels of a row. Variants: PEL_FORMAT_NORMAL, PEL_FORMAT_POSITION or PEL_FORMAT_DEPTH, PEL_FORMAT_IDS (0:
// none), PEL_FORMAT_CURVATURE (lib/image/image.clh).

#include "lib/diffusion/item.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"
#include "lib/shading/position.clh"
#include "lib/shading/screen_curvature.clh"
#include "shared/screen.h"

// An id of any object, not only of a material: the bits of the number.
inline uintw loadObjectId(const int format, Span s) {
    switch (format & ~PEL_FMT_STRIDED) {
        case PEL_FMT_R8_UINT:
            return loadId(format, s);
        case PEL_FMT_R16_UINT: {
#define ID_AT(i, suffix) *(__global const ushort*)(s.first + min((uint)(i), s.last) * s.stride)
            return PEL_UINT_LANES(ID_AT);
#undef ID_AT
        }
        case PEL_FMT_R32_UINT:
            return loadWord(format, s);
        default:
            return as_uintw(loadScalar(format, s));
    }
}

inline void storeFloat(Span s, floatw value) {
#if PEL_WIDTH > 1
    if (!(PEL_FORMAT_CURVATURE & PEL_FMT_STRIDED)) {
        storew(value, 0, (__global float*)s.first);
        return;
    }
#endif
#define PUT(i, suffix) \
    if ((i) <= s.last) *(__global float*)(s.first + (i)*s.stride) = value suffix;
    PEL_EACH_LANE(PUT)
#undef PUT
}

typedef struct Inputs {
    __global const ScreenCurvatureFrame* frame;
    __global uchar *normal, *position, *ids;
} Inputs;

typedef struct Pixel {
    ScreenPoint point;
    uintw id;
} Pixel;

inline Pixel loadPixel(const Inputs* in, uint x, uint y) {
    Pixel pixel;
    const Vec3w normal = loadNormal(PEL_FORMAT_NORMAL, imageSpan(in->normal, &in->frame->normal, x, y));
    const Span span = imageSpan(in->position, &in->frame->position, x, y);
#if PEL_FORMAT_POSITION
    const Vec3w position = loadColor(PEL_FORMAT_POSITION, span);
#else
    const Vec3w position = positionFromDepth(in->frame->inverseViewProjection, in->frame->width,
                                             in->frame->height, x, y, loadScalar(PEL_FORMAT_DEPTH, span));
#endif
    pixel.point = screenPoint(normal, position);
    pixel.id = (uintw)(1);
#if PEL_FORMAT_IDS
    pixel.id = loadObjectId(PEL_FORMAT_IDS, imageSpan(in->ids, &in->frame->ids, x, y));
    pixel.point.usable &= pixel.id != (uintw)(0);
#endif
    return pixel;
}

// Each lane takes its neighbour's value; the last or the first lane keeps its own.
#if PEL_WIDTH == 1
#define LANES_UP(v) (v)
#define LANES_DOWN(v) (v)
#elif PEL_WIDTH == 8
#define LANES_UP(v) ((v).s00123456)
#define LANES_DOWN(v) ((v).s12345677)
#else
#define LANES_UP(v) ((v).s00123456789abcde)
#define LANES_DOWN(v) ((v).s123456789abcdeff)
#endif
#define MOVE_LANES(pixel, MOVE)                                                                         \
    pixel.point.normal =                                                                                \
        vec3(MOVE(pixel.point.normal.x), MOVE(pixel.point.normal.y), MOVE(pixel.point.normal.z)),       \
    pixel.point.position =                                                                              \
        vec3(MOVE(pixel.point.position.x), MOVE(pixel.point.position.y), MOVE(pixel.point.position.z)), \
    pixel.point.usable = MOVE(pixel.point.usable), pixel.id = MOVE(pixel.id)

inline ScreenPoint neighbour(const Pixel there, const Pixel here, maskw inside) {
    ScreenPoint point = there.point;
    point.usable &= inside & (there.id == here.id);
    return point;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void screen_curvature(
    __global const ScreenCurvatureFrame* restrict frame, __global uchar* restrict normal,
    __global uchar* restrict position, __global uchar* restrict ids, __global uchar* restrict curvature) {
    const uint across = (frame->width + PEL_WIDTH - 1) / PEL_WIDTH, y = itemOfFolded() / across;
    if (y >= frame->height) return;
    const uint x = vectorStart(itemOfFolded() % across * PEL_WIDTH, frame->width);
    const Inputs in = {frame, normal, position, ids};
    const Pixel here = loadPixel(&in, x, y);
    const Span out = imageSpan(curvature, &frame->curvature, x, y);
    floatw value = 0.0f;
    if (anyw(here.point.usable)) {
        // A vector beside the image would be outside it: the same pixels once more, moved by one lane.
        Pixel left = loadPixel(&in, max(x, 1u) - 1, y), right = here;
        if (x == 0) MOVE_LANES(left, LANES_UP);
        if (x + PEL_WIDTH < frame->width)
            right = loadPixel(&in, x + 1, y);
        else
            MOVE_LANES(right, LANES_DOWN);
        const Pixel up = loadPixel(&in, x, max(y, 1u) - 1),
                    down = loadPixel(&in, x, min(y + 1, frame->height - 1));
        const intw column = lanesw() + (int)x;
        const maskw yes = (maskw)(-1);
        value = frame->scale *
                screenCurvature(here.point, neighbour(left, here, column > 0),
                                neighbour(right, here, column < (int)frame->width - 1),
                                neighbour(up, here, y > 0 ? yes : (maskw)(0)),
                                neighbour(down, here, y + 1 < frame->height ? yes : (maskw)(0)), frame->edge);
        value = selectw((floatw)(0.0f), value, finitew(value));
    }
    storeFloat(out, value);
}
