// Blurred normals from shading normals, on screen (docs/guide/shading.md, "Blurred normals"): a separable
// mean over the surface within the material's diffusion radius, which stops at depth edges and at other
// materials.
//
// Along one axis, first x, then y, the taps k = 1..PEL_BLUR_TAPS to each side are `step` pixels apart, so
// that the last one is about one radius away on the surface: step = ceil(radius / (PEL_BLUR_TAPS s)), s being
// the distance to the nearer of the two neighbours. A tap's weight is (1 - d^2 / radius^2)^2, d its distance
// in space. The walk ends at the border, at another material, beyond the radius, and at a depth edge: a step
// more than PEL_BLUR_GAP times as long as the longest before it. Taps with NaN or Inf are skipped.
//
// Inputs: shading normals, positions or depth, material ids. Output: Nb of each pixel of a material without
// normal map; NaN where the pixel's own normal or position is. One work-group: a run of tiles; one work-item:
// PEL_WIDTH pixels of a row at a time, whose taps are PEL_WIDTH neighbours as long as they share a step,
// which is nearly always. Launches: prepare_normals, blur_normals along x, blur_normals along y.
#include "lib/image/planes.clh"
#include "lib/shading/tiles.clh"

// Ids of PEL_WIDTH pixels from `first` on. Ids are 0 for pixels before x, which belong to another work-item,
// and for pixels without a material.
static inline uintw ownIds(__global const PelShadeFrame* frame, __global uchar* material, uint x, uint y,
                           uint first) {
    const intw column = lanesw() + (int)first;
    const uintw id = loadIds(frame, material, first, y);
    return selectw((uintw)(0), id,
                   (column >= (int)x) & (column < (int)frame->width) & hasMaterial(frame, id));
}

// tags: the id if normal and position are finite, its negative if not, 0 without a material. For every pixel,
// since taps reach beyond the tiles of the list.
__kernel __attribute__((reqd_work_group_size(PEL_PASS_GROUP, 1, 1))) void prepare_normals(
    __global const PelShadeFrame* restrict frame, __global const uint* restrict list,
    __global uchar* restrict material, __global uchar* restrict normal, __global uchar* restrict position,
    __global uchar* restrict depth, __global float* restrict normals, __global float* restrict positions,
    __global float* restrict tags, uint plane) {
    if (PEL_FORMAT_MATERIAL && list[PEL_TILE_COUNT(0)] == 0) return;
    const uint groups = get_num_groups(0), group = get_group_id(0);
    const uint end = (uint)((ulong)frame->tiles * (group + 1) / groups);
    for (uint i = (uint)((ulong)frame->tiles * group / groups); i < end; ++i) {
        const uint tile = frame->firstTile + i;
        const uint2 origin =
            (uint2)(tile % frame->tilesX * PEL_TILE_WIDTH, tile / frame->tilesX * PEL_TILE_HEIGHT);
        for (uint pixel = get_local_id(0) * PEL_WIDTH; pixel < PEL_TILE_PIXELS;
             pixel += PEL_PASS_GROUP * PEL_WIDTH) {
            const uint x = origin.x + pixel % PEL_TILE_WIDTH, y = origin.y + pixel / PEL_TILE_WIDTH;
            if (x >= frame->width || y >= frame->height) continue;
            const uint first = vectorStart(x, frame->width);
            const intw column = lanesw() + (int)first;
            const uintw id = ownIds(frame, material, x, y, first);
            const maskw own = (column >= (int)x) & (column < (int)frame->width), held = id != 0;
            const size_t at = scratchIndex(frame, first, y);
            floatw tag = 0.0f;
            if (anyw(held)) {
                const Vec3w n =
                    loadNormal(PEL_FORMAT_NORMAL_SHADING,
                               imageSpan(normal, &frame->images[PEL_IMAGE_NORMAL_SHADING], first, y));
                const Vec3w p = loadPosition(frame, position, depth, first, y);
                tag = convert_floatw(id);
                tag = selectw(-tag, tag, finite3(n) & finite3(p));
                storePlanes(normals, plane, at, n, held);
                storePlanes(positions, plane, at, p, held);
            }
            storePlane(tags, at, tag, own);
        }
    }
}

typedef struct Field {
    __global const PelShadeFrame* frame;
    __global const float *normals, *positions, *tags;
    uint plane;
    bool alongY;
} Field;

// The lanes of `mask` that have a pixel `offset` away along the axis. x, y: of the first lane.
static inline maskw withinImage(const Field* f, int x, int y, int offset, maskw mask) {
    if (f->alongY) return y + offset < 0 || y + offset >= (int)f->frame->height ? mask & 0 : mask;
    if (x + offset >= 0 && x + offset + PEL_WIDTH <= (int)f->frame->width) return mask;
    const intw column = lanesw() + (x + offset);
    return mask & (column >= 0) & (column < (int)f->frame->width);
}

static inline floatw distance2(Vec3w a, Vec3w b) {
    const Vec3w between = sub3(a, b);
    return dot3(between, between);
}

// Squared distance to a direct neighbour; Inf if there is no comparable one.
static inline floatw neighbourDistance2(const Field* f, int x, int y, int offset, size_t at, Vec3w p,
                                        floatw id, maskw mask) {
    mask = withinImage(f, x, y, offset, mask);
    if (anyw(mask)) mask &= loadw(at, f->tags) == id;  // beyond the first and last row lies no guard
    if (!anyw(mask)) return (floatw)(INFINITY);
    return selectw((floatw)(INFINITY), distance2(loadPlanes(f->positions, f->plane, at), p), mask);
}

// The greatest value of the lanes of `mask`, all of them positive; 0 for none.
static inline int greatest(intw value, maskw mask) {
    return (int)greatestId(as_uintw(value), mask);
}

// The smallest whole number that is not below v > 0. Not ceil, which is a function call on some CPUs.
static inline intw roundedUp(floatw v) {
    const intw whole = convert_intw(v);
    return selectw(whole, whole + 1, convert_floatw(whole) < v);
}

// The sum of a pixel's normal and of those along the axis, for the lanes of `mask`.
static inline Vec3w blurAlong(const Field* f, int x, int y, floatw id, floatw radius, maskw mask) {
    const size_t centre = scratchIndex(f->frame, (uint)x, (uint)y);
    const long pixel = f->alongY ? (long)f->frame->width : 1;  // from one pixel to the next along the axis
    const Vec3w p = loadPlanes(f->positions, f->plane, centre);
    Vec3w sum = loadPlanes(f->normals, f->plane, centre);
    floatw total = 1.0f;
    const floatw s2 = fmin(neighbourDistance2(f, x, y, -1, centre - pixel, p, id, mask),
                           neighbourDistance2(f, x, y, 1, centre + pixel, p, id, mask));
    const floatw s = sqrt(s2);
    const floatw taps = radius / (s * (float)PEL_BLUR_TAPS);  // Inf or NaN where two pixels lie in one place
    const intw steps = roundedUp(fmin(fmax(taps, (floatw)(1.0f)), (floatw)((float)PEL_BLUR_STEP_MAX)));
    const floatw perRadius2 = 1.0f / (radius * radius);
    maskw left = mask & (s2 < INFINITY);
    while (anyw(left)) {
        const int step = greatest(steps, left);
        const maskw these = left & (steps == step);
        left &= notw(these);
        for (int side = -1; side <= 1; side += 2) {
            Vec3w before = p;
            floatw longest2 = s2 * (float)(step * step);
            maskw on = these;
            for (int k = 1; k <= PEL_BLUR_TAPS; ++k) {
                const int offset = side * k * step;
                const size_t at = centre + (size_t)(offset * pixel);
                on = withinImage(f, x, y, offset, on);
                if (!anyw(on)) break;
                const floatw tag = loadw(at, f->tags);
                on &= fabs(tag) == id;
                if (!anyw(on)) break;
                const Vec3w q = loadPlanes(f->positions, f->plane, at),
                            n = loadPlanes(f->normals, f->plane, at);
                const floatw gap2 = distance2(q, before), d2 = distance2(q, p) * perRadius2;
                const maskw near = (gap2 <= (float)(PEL_BLUR_GAP * PEL_BLUR_GAP) * longest2) & (d2 < 1.0f);
                const maskw valid = on & (tag > 0.0f), take = valid & near;
                const floatw rest = 1.0f - d2, weight = rest * rest;
                sum = select3(sum,
                              vec3(fma(n.x, weight, sum.x), fma(n.y, weight, sum.y), fma(n.z, weight, sum.z)),
                              take);
                total = selectw(total, total + weight, take);
                // Lanes whose walk has ended need no values; those that skip a tap keep theirs.
                const maskw skipped = on & notw(valid);
                if (anyw(skipped)) {
                    before = select3(before, q, take);
                    longest2 = selectw(longest2, gap2, take & (gap2 > longest2));
                } else {
                    before = q;
                    longest2 = selectw(longest2, gap2, gap2 > longest2);
                }
                on = take | skipped;
            }
        }
    }
    return scale3(sum, 1.0f / total);
}

// The blur's radius of each lane; 0 for materials with a normal map and for pixels without a material.
static inline floatw blurRadius(__global const PelShadeMaterial* materials, uintw id) {
#define PEL_RADIUS_(id) ((id) && !materials[id].hasNormalMap ? materials[id].diffusionRadius : 0.0f)
    const uint one = greatestId(id, id != 0);
    const maskw same = id == one;
    if (!anyw(notw(same) & (id != 0))) return selectw((floatw)(0.0f), (floatw)(PEL_RADIUS_(one)), same);
#define PEL_LANE_RADIUS_(k, s) PEL_RADIUS_(id s)
    return PEL_LANES(PEL_LANE_RADIUS_);
#undef PEL_LANE_RADIUS_
#undef PEL_RADIUS_
}

// `from` and `to` differ. Along y, `to` holds the unblurred normals, which are kept where the mean vanishes.
__kernel __attribute__((reqd_work_group_size(PEL_PASS_GROUP, 1, 1))) void blur_normals(
    __global const PelShadeFrame* restrict frame, __global const PelShadeMaterial* restrict materials,
    __global const uint* restrict list, __global uchar* restrict material,
    __global const float* restrict from, __global const float* restrict positions,
    __global const float* restrict tags, __global float* restrict to, uint plane, uint alongY) {
    const TileRun run = tileRun(frame, list);
    const Field field = {frame, from, positions, tags, plane, alongY != 0};
    for (uint i = run.begin; i < run.end; ++i) {
        const uint2 origin = tileOrigin(frame, list, i);
        for (uint pixel = get_local_id(0) * PEL_WIDTH; pixel < PEL_TILE_PIXELS;
             pixel += PEL_PASS_GROUP * PEL_WIDTH) {
            const uint x = origin.x + pixel % PEL_TILE_WIDTH, y = origin.y + pixel / PEL_TILE_WIDTH;
            if (x >= frame->width || y >= frame->height) continue;
            const uint first = vectorStart(x, frame->width);
            const uintw id = ownIds(frame, material, x, y, first);
            const floatw radius = blurRadius(materials, id);
            const maskw wanted = radius > 0.0f;
            if (!anyw(wanted)) continue;
            const size_t at = scratchIndex(frame, first, y);
            const maskw valid = wanted & (loadw(at, tags) > 0.0f);
            Vec3w n = blurAlong(&field, (int)first, (int)y, convert_floatw(id), radius, valid);
            if (alongY) {
                const floatw length2 = dot3(n, n);
                const maskw vanished = valid & notw(length2 > 1e-12f);
                n = scale3(n, 1.0f / sqrt(length2));
                if (anyw(vanished)) n = select3(n, loadPlanesOf(to, plane, at, vanished), vanished);
                const floatw none = NAN;  // the shading pass makes it an invalid pixel
                n = select3(vec3(none, none, none), n, valid);
            }
            storePlanes(to, plane, at, n, wanted);
        }
    }
}
