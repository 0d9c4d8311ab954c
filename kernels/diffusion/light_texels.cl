// The finest level of a light's pyramid (shared/light_space.h): the position of the surface that each
// shadow-map texel shows, and the light that falls on it (docs/mathematics.md, section 10, "Light space").
//
// Input: the map, the marks and the region of light_seen, and which cells of texels (PEL_LIGHT_CELL) had
// flux before. Output: level 0, and which cells have flux now. Only texels of the region have flux: with
// PEL_HIDDEN the occluded ones, without it all but those of objects that do not scatter, and their ids are
// stored beside. One work-item: PEL_WIDTH texels of a row. Variants: PEL_HIDDEN,
// PEL_FORMAT_SHADOW_MAP, PEL_SHADOW_CONTENT.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/light_space.clh"
#include "lib/image/planes.clh"

#define MAX_SLOPE \
    10.0f  // largest area of a texel over its area across the light; steeper depths are not reliable
#define MIN_DISTANCE 4.0f  // from an occluded texel to a camera-visible one, in lengths of a texel
#define ALIKE 2.0f         // largest ratio of the steps to both sides

// The step to the next texel: the mean of the steps to both sides where they are alike, since the shorter
// one alone is too short on curved surface; otherwise the shorter, since the longer may lead off the
// surface.
static inline Vec3w stepOf(Vec3w p, Vec3w before, Vec3w after) {
    const Vec3w back = sub3(p, before), on = sub3(after, p);
    const floatw backLength = dot3(back, back), onLength = dot3(on, on);
    const maskw isBack = finitew(backLength) & ((backLength < onLength) | notw(finitew(onLength)));
    const Vec3w shorter = select3(on, back, isBack), mean = scale3(add3(back, on), (floatw)(0.5f));
    const maskw alike = fmax(backLength, onLength) < ALIKE * ALIKE * fmin(backLength, onLength);
    return select3(shorter, mean, alike);
}

// The marks of light_seen.cl. The buffer has margins before the first and after the last map.
static inline uintw idsOfTexels(__global const uchar* seen) {
#if PEL_WIDTH == 1
    return *seen;
#elif PEL_WIDTH == 8
    return convert_uint8(vload8(0, seen));
#else
    return convert_uint16(vload16(0, seen));
#endif
}

#if PEL_HIDDEN
// Whether a texel shows camera-visible surface.
static inline maskw isSeen(__global const uchar* seen, __global const PelPyramidLevel* level, int column,
                           int row) {
    if (row < 0 || row >= (int)level->height) return (maskw)(0);
    const intw columns = lanesw() + column;
    return (idsOfTexels(seen + (size_t)row * level->width + column) != (uintw)(0)) & (columns >= 0) &
           (columns < (int)level->width);
}

// Whether the neighbour `q` is camera-visible, and so near that `p` is a part of the same surface.
static inline maskw isBeside(Vec3w p, Vec3w q, floatw most, maskw seen) {
    const Vec3w d = sub3(q, p);
    return seen & (dot3(d, d) < most * most);
}
#endif

// The step from texel (x, y) to the next one along a row or a column. With PEL_HIDDEN, lanes of `there`
// beside a camera-visible texel are cleared: between two patches, and where light grazes, texels of
// camera-visible surface remain unmarked. They come and go while the light moves.
static inline Vec3w stepAlong(__global const PelLightMap* map, __global const uchar* first,
                              __global const uchar* seen, Vec3w p, floatw columns, floatw rows, int x, int y,
                              int dx, int dy, maskw* there) {
    const float sx = (float)dx, sy = (float)dy;
    const Vec3w before = pointOfTexel(map, columns - sx, rows - sy, texelDepths(map, first, x - dx, y - dy)),
                after = pointOfTexel(map, columns + sx, rows + sy, texelDepths(map, first, x + dx, y + dy));
#if PEL_HIDDEN
    const floatw near = MIN_DISTANCE * map->texel * matrixRow(map->toMap, 3, p);
    __global const uchar* all = seen + map->seen;
    *there &= notw(isBeside(p, before, near, isSeen(all, &map->level[0], x - dx, y - dy)) |
                   isBeside(p, after, near, isSeen(all, &map->level[0], x + dx, y + dy)));
#endif
    return stepOf(p, before, after);
}

// The share of a cascade's texel, with these sides, that a finer cascade does not hold: surface inside that
// one belongs to it. Cascades are parallel maps.
static inline floatw shareBeyond(__global const PelLightMap* finer, Vec3w p, Vec3w right, Vec3w down) {
    floatw w, within = 1.0f;
    const Vec3w at = texelOf(finer, p, &w);
    PEL_UNROLL
    for (int axis = 0; axis < 2; ++axis) {
        const Vec3w row = loadUniform3(finer->toMap + 4 * axis);
        const float count = finer->size[axis],
                    end = (float)(axis ? finer->level[0].height : finer->level[0].width);
        const floatw length = (fabs(dot3(row, right)) + fabs(dot3(row, down))) * (count / finer->toMap[15]),
                     middle = (axis ? at.y : at.x) + 0.5f;
        within *= satw(fma(fmin(middle, end - middle), 1.0f / fmax(length, (floatw)(1e-6f)), (floatw)(0.5f)));
    }
    return selectw((floatw)(1.0f), 1.0f - within, (at.z >= 0.0f) & (at.z <= 1.0f));
}

// `region`: the texels within reach; `first`: the map's first texel.
static PEL_OUT_OF_LINE void makeTexels(__global const PelLightMap* map, __global const uchar* first,
                                       __global const uchar* seen, __global const uint* region,
                                       __global const uchar* before, __global uchar* now, uint frameNumber,
                                       __global float* pyramid, uint x, uint y) {
    __global const PelPyramidLevel* level = &map->level[0];
    const uint cell = map->cells + y / PEL_LIGHT_CELL * cellsAcross(map) + x / PEL_LIGHT_CELL;
    const bool had = cellOfFrame(before[cell], frameNumber - 1);
    const bool reached = x + PEL_WIDTH > level->width - region[0] && x < region[1] &&
                         y + region[2] >= level->height && y < region[3];
    if (!reached && !had) return;
    const size_t at = lightRow(level, 1, (int)y) + x;
    const uint stride = level->stride;
    const intw column = lanesw() + (int)x;
    const uintw id = idsOfTexels(seen + map->seen + (size_t)y * level->width + x);
    maskw there = (maskw)(reached ? -1 : 0) & (column < (int)level->width) &
                  (PEL_HIDDEN ? id == (uintw)(0) : id != (uintw)(PEL_SEEN_OTHER));
    floatw depth = 0.0f;
    if (anyw(there)) {
        depth = texelDepths(map, first, (int)x, (int)y);
        there &= surfaceAt(map, depth);
    }
    floatw flux = 0.0f;
    if (anyw(there)) {
        const floatw columns = convert_floatw(column), rows = (float)y;
        const Vec3w p = pointOfTexel(map, columns, rows, depth);
        // The derivatives at constant depth. Texels of radial maps lie on a sphere, where one-sided steps
        // would be biased.
        Vec3w left = p, above = p;
        float back = 0.0f;
        if (map->radialRange > 0.0f) {
            back = 0.5f;
            left = pointOfTexel(map, columns - back, rows, depth);
            above = pointOfTexel(map, columns, rows - back, depth);
        }
        const Vec3w right = sub3(pointOfTexel(map, columns + (1.0f - back), rows, depth), left),
                    down = sub3(pointOfTexel(map, columns, rows + (1.0f - back), depth), above);
        Vec3w toLight;
        const floatw strength = lightAt(map, p, &toLight);
        const floatw across = fabs(dot3(cross3(right, down), toLight));
        floatw share = 1.0f;
        for (uint k = 1; k <= map->finer; ++k) share *= shareBeyond(map - k, p, right, down);
        there &= (share > 0.0f) & finite3(p) & finitew(across) & finitew(strength);
        Vec3w along = p, below = p;
        PEL_ROLL for (int axis = 0; axis < 2; ++axis) {
            const Vec3w step =
                stepAlong(map, first, seen, p, columns, rows, (int)x, (int)y, 1 - axis, axis, &there);
            if (axis == 0) along = step;
            below = step;
        }
        flux = selectw((floatw)(0.0f), strength * across * share, there);
        const Vec3w area = cross3(along, below);
        floatw extent = sqrt(dot3(area, area));
        extent = share * fmin(selectw(across, extent, finitew(extent)), MAX_SLOPE * across);
        const Vec3w none = same3(0.0f);
        const Vec3w q = select3(none, p, there);
        storew(selectw((floatw)(0.0f), extent, there), at + PEL_LIGHT_EXTENT * stride, pyramid);
        if (!PEL_HIDDEN) storew(as_floatw(id), at + PEL_LIGHT_ID * stride, pyramid);
        storew(q.x, at + PEL_LIGHT_X * stride, pyramid);
        storew(q.y, at + PEL_LIGHT_Y * stride, pyramid);
        storew(q.z, at + PEL_LIGHT_Z * stride, pyramid);
    }
    if (anyw(flux > 0.0f))
        now[cell] = (uchar)frameNumber;
    else if (!had)
        return;
    storew(flux, at + PEL_LIGHT_FLUX * stride, pyramid);
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void light_texels(
    __global const PelLightMap* restrict maps, __global const uchar* restrict seen,
    __global const uint* restrict counters, __global const uchar* restrict before, __global uchar* now,
    uint frameNumber, __global float* pyramid PEL_LIGHT_BUFFER_ARGUMENTS) {
    __global const PelLightMap* map = maps + get_global_id(2);
    __global const PelPyramidLevel* level = &map->level[0];
    const uint across = (level->width + PEL_WIDTH - 1) / PEL_WIDTH, y = itemOfFolded() / across;
    if (y < level->height)
        makeTexels(map, firstTexel(PEL_LIGHT_BUFFER_OF(map->buffer), &map->map), seen,
                   counters + PEL_LIGHT_REGION(get_global_id(2)), before, now, frameNumber, pyramid,
                   itemOfFolded() % across * PEL_WIDTH, y);
}
