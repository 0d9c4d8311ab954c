// The finest level of the screen's pyramid (shared/diffusion.h): position, irradiance and area of the
// surface under each pixel (docs/mathematics.md, sections 9 and 10).
//
// Inputs: images of irradiance, of positions (length) or depth, of ids (0 is background), of mean curvature,
// of factors of the radius. Output: level 0 of the pyramid. surface_points copies the images, surface_areas
// measures pixels against their neighbours; one work-item is PEL_WIDTH pixels of a row. Variants:
// PEL_FORMAT_IRRADIANCE, PEL_FORMAT_POSITION or PEL_FORMAT_DEPTH, PEL_FORMAT_MATERIAL (0: everything is
// id 1), PEL_FORMAT_MEAN_CURVATURE and PEL_FORMAT_RADIUS (0: none).
#include "lib/diffusion/item.clh"
#include "lib/diffusion/pyramid.clh"
#include "lib/diffusion/radius.clh"
#include "lib/diffusion/usable_light.clh"
#include "lib/image/image.clh"
#include "lib/shading/material_id.clh"
#include "lib/shading/position.clh"

// A surface seen at a steeper angle than this cosine counts with the area at this angle: the normal of a
// pixel is wrong for its whole area if the surface turns away inside the pixel.
#define MIN_FACING 0.25f

// PEL_WIDTH pixels from (`from`, y) on.
static PEL_OUT_OF_LINE void copyPoints(__global const PelDiffusionFrame* frame, __global uchar* irradiance,
                                       __global uchar* position, __global uchar* ids,
                                       __global uchar* curvature, __global uchar* radii,
                                       __global float* pyramid, uint from, uint y, uint* covered,
                                       uint* invalid) {
    const uint x = vectorStart(from, frame->width);
    const intw column = lanesw() + (int)x;
    const maskw mine = (column >= (int)from) & (column < (int)frame->width);
    __global const PelPyramidLevel* level = &frame->level[0];
    const size_t row = pyramidRow(level, (int)y) + x;
    const uint stride = level->stride;
    uintw id = (uintw)(1);
#if PEL_FORMAT_MATERIAL
    id = loadId(PEL_FORMAT_MATERIAL, imageSpan(ids, &frame->ids, x, y));
#endif
#define SCATTERS(i, s) (id s < PEL_DIFFUSION_IDS && frame->tableOf[id s] ? id s : 0)
    id = PEL_UINT_LANES(SCATTERS);
#undef SCATTERS
    if (anyw(mine & (id != (uintw)(0)))) {
        const Span span = imageSpan(position, &frame->position, x, y);
#if PEL_FORMAT_POSITION
        Vec3w p = loadColor(PEL_FORMAT_POSITION, span);
#else
        Vec3w p = positionFromDepth(frame->inverseViewProjection, frame->width, frame->height, x, y,
                                    loadScalar(PEL_FORMAT_DEPTH, span));
#endif
        p = sub3(p, loadUniform3(frame->origin));
        Vec3w e = loadColor(PEL_FORMAT_IRRADIANCE, imageSpan(irradiance, &frame->irradiance, x, y));
        const maskw there = id != (uintw)(0), sound = usableLight(e) & finite3(p);
        *covered += countw(mine & there);
        *invalid += countw(mine & there & notw(sound));
        id = as_uintw(selectw((intw)(0), as_intw(id), there & sound));
        // Values with NaN or Inf, or far too large, are left out of all sums: zeros take their place.
        const Vec3w none = same3(0.0f);
        p = select3(none, p, sound), e = select3(none, e, sound);
        storePlane(pyramid, row + PEL_PLANE_X * stride, p.x, mine);
        storePlane(pyramid, row + PEL_PLANE_Y * stride, p.y, mine);
        storePlane(pyramid, row + PEL_PLANE_Z * stride, p.z, mine);
        storePlane(pyramid, row + PEL_PLANE_RED * stride, e.x, mine);
        storePlane(pyramid, row + PEL_PLANE_GREEN * stride, e.y, mine);
        storePlane(pyramid, row + PEL_PLANE_BLUE * stride, e.z, mine);
#if PEL_FORMAT_MEAN_CURVATURE
        const floatw mean =
            loadScalar(PEL_FORMAT_MEAN_CURVATURE, imageSpan(curvature, &frame->curvature, x, y));
        storePlane(pyramid, row + PEL_PLANE_CURVATURE * stride,
                   selectw((floatw)(0.0f), mean, sound & (fabs(mean) < (floatw)(1e9f))), mine);
#endif
#if PEL_FORMAT_RADIUS
        storePlane(pyramid, row + PEL_PLANE_RADIUS * stride,
                   loadRadius(imageSpan(radii, &frame->radii, x, y)), mine);
#endif
    }
    storePlane(pyramid, row + PEL_PLANE_ID * stride, as_floatw(id), mine);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void surface_points(
    __global const PelDiffusionFrame* restrict frame, __global uchar* irradiance, __global uchar* position,
    __global uchar* ids, __global uchar* curvature, __global uchar* radii, __global float* pyramid,
    __global uint* restrict counters) {
    const uint across = (frame->width + PEL_WIDTH - 1) / PEL_WIDTH, y = itemOfFolded() / across;
    uint covered = 0, invalid = 0;
    if (y < frame->height)
        copyPoints(frame, irradiance, position, ids, curvature, radii, pyramid,
                   itemOfFolded() % across * PEL_WIDTH, y, &covered, &invalid);
    PEL_ADD_OF_GROUP(&counters[PEL_COUNT_PIXELS_COVERED], covered);
    PEL_ADD_OF_GROUP(&counters[PEL_COUNT_IRRADIANCE_INVALID], invalid);
}

typedef struct Step {
    Vec3w v;
    floatw length2;  // FLT_MAX: there is none
} Step;

// The shorter of the steps to the neighbours of the same object: the longer one may lead off the surface.
static inline Step shorterStep(__global const float* pyramid, size_t here, long to, uint stride, Vec3w p,
                               uintw id) {
    Step step;
    step.v = same3(0.0f);
    step.length2 = FLT_MAX;
    for (int side = -1; side <= 1; side += 2) {
        const size_t at = here + (size_t)(to * side);
        const maskw same = as_uintw(loadw(at + PEL_PLANE_ID * stride, pyramid)) == id;
        const Vec3w q =
            vec3(loadw(at + PEL_PLANE_X * stride, pyramid), loadw(at + PEL_PLANE_Y * stride, pyramid),
                 loadw(at + PEL_PLANE_Z * stride, pyramid));
        const Vec3w v = scale3(sub3(q, p), (floatw)((float)side));
        const floatw length2 = dot3(v, v);
        const maskw better = same & (length2 < step.length2);
        step.v = select3(step.v, v, better);
        step.length2 = selectw(step.length2, length2, better);
    }
    return step;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void surface_areas(
    __global const PelDiffusionFrame* restrict frame, __global float* pyramid) {
    const uint across = (frame->width + PEL_WIDTH - 1) / PEL_WIDTH, y = itemOfFolded() / across;
    if (y >= frame->height) return;
    const uint x = itemOfFolded() % across * PEL_WIDTH;  // beyond the last column lies the guard
    __global const PelPyramidLevel* level = &frame->level[0];
    const size_t row = pyramidRow(level, (int)y) + x;
    const uint stride = level->stride;
    const uintw id = as_uintw(loadw(row + PEL_PLANE_ID * stride, pyramid));
    const maskw there = id != (uintw)(0);
    floatw area = 0.0f, size = 0.0f;
    if (anyw(there)) {
        const Vec3w p =
            vec3(loadw(row + PEL_PLANE_X * stride, pyramid), loadw(row + PEL_PLANE_Y * stride, pyramid),
                 loadw(row + PEL_PLANE_Z * stride, pyramid));
        const Step right = shorterStep(pyramid, row, 1, stride, p, id);
        const Step down = shorterStep(pyramid, row, (long)stride * PEL_PYRAMID_PLANES, stride, p, id);
        const Vec3w cross = cross3(right.v, down.v);
        const maskw noRight = right.length2 == FLT_MAX, noDown = down.length2 == FLT_MAX;
        area = sqrt(dot3(cross, cross));
        if (frame->view != PEL_VIEW_UNKNOWN) {
            const Vec3w sight = sightTo(frame, p);
            const floatw cosine =
                fabs(dot3(cross, sight)) * inverseRootw(dot3(cross, cross) * dot3(sight, sight));
            area *= fmin(cosine * (1.0f / MIN_FACING), (floatw)(1.0f));
        }
        // A line of pixels counts as facing the camera. A single pixel has no size.
        area = selectw(area, right.length2, noDown);
        area = selectw(area, down.length2, noRight);
        area = selectw(area, (floatw)(0.0f), noRight & noDown);
        size = selectw(fmin(right.length2, down.length2), (floatw)(0.0f), noRight & noDown);
        const maskw sound = there & finitew(area) & finitew(size);
        area = selectw((floatw)(0.0f), area, sound);
        size = selectw((floatw)(0.0f), size, sound);
    }
    storew(area, row + PEL_PLANE_AREA * stride, pyramid);
    storew(size, row + PEL_PLANE_SIZE * stride, pyramid);
}
