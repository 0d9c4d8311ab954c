// One level of the screen's pyramid (shared/diffusion.h) from the next finer one: blocks of 2 x 2.
//
// A block belongs to one object, that of the child with the largest area, and takes in the other children
// that have its id and lie near it. So no light bleeds from one object to another, or to a surface behind.
// Inputs: the finer level. Output: the coarser one. One work-item: PEL_WIDTH blocks of a row. One lane: a
// work-group is a block of the last of `count` levels. surface_differences runs afterwards, because second
// differences need neighbours from other groups; its work-items are the blocks of all levels.
#include "lib/diffusion/item.clh"
#include "lib/diffusion/pyramid.clh"

// Children further apart than this many times the width of the largest belong to another surface.
#define MAX_DISTANCE 5.0f

typedef struct Child {
    floatw area;
    uintw id;
    Vec3w p, e;
    floatw size, radius;
} Child;

typedef struct Pair {
    Child left, right;
} Pair;

static inline __attribute__((always_inline)) Pair loadPair(__global const float* at, uint stride) {
    Pair pair;
    floatw left, right;
    loadEvenOdd(at + PEL_PLANE_ID * stride, &left, &right);
    pair.left.id = as_uintw(left), pair.right.id = as_uintw(right);
    loadEvenOdd(at + PEL_PLANE_AREA * stride, &pair.left.area, &pair.right.area);
    loadEvenOdd(at + PEL_PLANE_SIZE * stride, &pair.left.size, &pair.right.size);
#if PEL_RADII
    loadEvenOdd(at + PEL_PLANE_RADIUS * stride, &pair.left.radius, &pair.right.radius);
#endif
    loadEvenOdd(at + PEL_PLANE_X * stride, &pair.left.p.x, &pair.right.p.x);
    loadEvenOdd(at + PEL_PLANE_Y * stride, &pair.left.p.y, &pair.right.p.y);
    loadEvenOdd(at + PEL_PLANE_Z * stride, &pair.left.p.z, &pair.right.p.z);
    loadEvenOdd(at + PEL_PLANE_RED * stride, &pair.left.e.x, &pair.right.e.x);
    loadEvenOdd(at + PEL_PLANE_GREEN * stride, &pair.left.e.y, &pair.right.e.y);
    loadEvenOdd(at + PEL_PLANE_BLUE * stride, &pair.left.e.z, &pair.right.e.z);
    return pair;
}

// Children of one row, from the one before the block's on: four columns.
typedef struct Row {
    floatw area[4], e[3][4];
    uintw id[4];
} Row;

static inline Row loadRow(__global const float* at, uint stride) {
    Row row;
    for (int pair = 0; pair < 2; ++pair) {
        __global const float* from = at + 2 * pair - 1;
        const int k = 2 * pair;
        floatw left, right;
        loadEvenOdd(from + PEL_PLANE_ID * stride, &left, &right);
        row.id[k] = as_uintw(left), row.id[k + 1] = as_uintw(right);
        loadEvenOdd(from + PEL_PLANE_AREA * stride, &row.area[k], &row.area[k + 1]);
        for (int c = 0; c < 3; ++c)
            loadEvenOdd(from + (PEL_PLANE_RED + c) * stride, &row.e[c][k], &row.e[c][k + 1]);
    }
    return row;
}

// |before + after - 2 here|. At a silhouette, where one neighbour is missing, the first difference to the
// other is returned: we cannot assume that irradiance is linear there. At the border of the picture
// (`edge`) we do.
static inline floatw difference2(floatw here, floatw before, maskw hasBefore, floatw after, maskw hasAfter,
                                 maskw edge) {
    const floatw largest2 =
        fabs(selectw(here, before, hasBefore) + selectw(here, after, hasAfter) - 2.0f * here);
    return selectw(largest2, (floatw)(0.0f), edge & notw(hasBefore & hasAfter));
}

// `first`: the column of row[1] in the picture.
static inline floatw difference2OfRows(const Row* up, const Row* row, const Row* down, intw first, uint width,
                                       bool edgeRow) {
    floatw largest2 = 0.0f;
    for (int k = 1; k <= 2; ++k) {
        const maskw there = row->area[k] > 0.0f;
        const intw column = first + (k - 1);
        const maskw edge = (column == 0) | (column == (int)width - 1), edgeDown = (maskw)(edgeRow ? -1 : 0);
#define THERE(r, i) (((r)->area[i] > 0.0f) & ((r)->id[i] == row->id[k]))
        const maskw left = THERE(row, k - 1), right = THERE(row, k + 1), above = THERE(up, k),
                    below = THERE(down, k);
#undef THERE
        for (int c = 0; c < 3; ++c) {
            const floatw here = row->e[c][k];
            const floatw sum = difference2(here, row->e[c][k - 1], left, row->e[c][k + 1], right, edge) +
                               difference2(here, up->e[c][k], above, down->e[c][k], below, edgeDown);
            largest2 = fmax(largest2, selectw((floatw)(0.0f), sum, there));
        }
    }
    return largest2;
}

static inline void addChild(Child* block, const Child* child, const Child* largest) {
    const Vec3w between = sub3(child->p, largest->p);
    const maskw near = (child->id == largest->id) & (child->area > 0.0f) &
                       (dot3(between, between) <= MAX_DISTANCE * MAX_DISTANCE * largest->area);
    const floatw area = selectw((floatw)(0.0f), child->area, near);
    block->area += area;
    const Vec3w none = same3(0.0f);
    block->p = add3(block->p, scale3(select3(none, between, near), area));
    block->e = add3(block->e, scale3(select3(none, child->e, near), area));
    block->size += selectw((floatw)(0.0f), child->size, near) * area;
#if PEL_RADII
    block->radius += selectw((floatw)(0.0f), child->radius, near) * area;
#endif
}

static inline Child largerChild(Child a, Child b) {
    const maskw other = b.area > a.area;
    Child larger = a;
    larger.area = selectw(a.area, b.area, other);
    larger.id = as_uintw(selectw(as_intw(a.id), as_intw(b.id), other));
    larger.p = select3(a.p, b.p, other);
    return larger;
}

// The largest second difference of the children of PEL_WIDTH blocks of level `to`.
static inline floatw differences(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                 uint to, uint x, uint y) {
    __global const PelPyramidLevel* fine = &frame->level[to - 1];
    const uint stride = fine->stride;
    const size_t rowValues = (size_t)stride * PEL_PYRAMID_PLANES;
    __global const float* upper = pyramid + pyramidRow(fine, 2 * (int)y) + 2 * x;
    const Row before = loadRow(upper - rowValues, stride), first = loadRow(upper, stride),
              second = loadRow(upper + rowValues, stride), after = loadRow(upper + 2 * rowValues, stride);
    const intw column = (lanesw() + (int)x) * 2;
    return fmax(difference2OfRows(&before, &first, &second, column, fine->width, y == 0),
                difference2OfRows(&first, &second, &after, column, fine->width, 2 * y + 2 >= fine->height));
}

// PEL_WIDTH blocks of level `to`.
static PEL_OUT_OF_LINE void reduceBlocks(__global const PelDiffusionFrame* frame, __global float* pyramid,
                                         uint to, uint x, uint y) {
    __global const PelPyramidLevel *fine = &frame->level[to - 1], *coarse = &frame->level[to];
    const uint stride = fine->stride;
    __global const float* upper = pyramid + pyramidRow(fine, 2 * (int)y) + 2 * x;
    const size_t rowValues = (size_t)stride * PEL_PYRAMID_PLANES;
    const size_t at = pyramidRow(coarse, (int)y) + x;
    const uint out = coarse->stride;
    // Large parts of many pictures are empty.
    floatw left, right, lowerLeft, lowerRight;
    loadEvenOdd(upper + PEL_PLANE_AREA * stride, &left, &right);
    loadEvenOdd(upper + rowValues + PEL_PLANE_AREA * stride, &lowerLeft, &lowerRight);
    if (!anyw((left > 0.0f) | (right > 0.0f) | (lowerLeft > 0.0f) | (lowerRight > 0.0f))) {
        storew((floatw)(0.0f), at + PEL_PLANE_AREA * out, pyramid);
        if (PEL_WIDTH > 1) storew((floatw)(0.0f), at + PEL_PLANE_DIFFERENCE2 * out, pyramid);
        return;
    }
    const Pair a = loadPair(upper, stride), b = loadPair(upper + rowValues, stride);
    const Child largest = largerChild(largerChild(a.left, a.right), largerChild(b.left, b.right));
    Child block;
    block.area = block.size = block.radius = 0.0f;
    block.p = block.e = same3(0.0f);
    addChild(&block, &a.left, &largest);
    addChild(&block, &a.right, &largest);
    addChild(&block, &b.left, &largest);
    addChild(&block, &b.right, &largest);
    const maskw any = block.area > 0.0f;
    const floatw share = 1.0f / selectw((floatw)(1.0f), block.area, any);
    block.p = add3(largest.p, scale3(block.p, share));
    block.e = scale3(block.e, share);
    storew(block.area, at + PEL_PLANE_AREA * out, pyramid);
    storew(as_floatw(largest.id), at + PEL_PLANE_ID * out, pyramid);
    storew(block.p.x, at + PEL_PLANE_X * out, pyramid);
    storew(block.p.y, at + PEL_PLANE_Y * out, pyramid);
    storew(block.p.z, at + PEL_PLANE_Z * out, pyramid);
    storew(block.e.x, at + PEL_PLANE_RED * out, pyramid);
    storew(block.e.y, at + PEL_PLANE_GREEN * out, pyramid);
    storew(block.e.z, at + PEL_PLANE_BLUE * out, pyramid);
    if (PEL_WIDTH > 1)
        storew(differences(frame, pyramid, to, x, y), at + PEL_PLANE_DIFFERENCE2 * out, pyramid);
    storew(block.size * share, at + PEL_PLANE_SIZE * out, pyramid);
#if PEL_RADII
    storew(block.radius * share, at + PEL_PLANE_RADIUS * out, pyramid);
#endif
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void reduce_surface(
    __global const PelDiffusionFrame* restrict frame, __global float* pyramid, uint to, uint count){
#define PEL_REDUCE_(level, x, y) reduceBlocks(frame, pyramid, level, x, y)
    PEL_REDUCE_LEVELS(frame->level, frame->levels, to, count, PEL_REDUCE_)
#undef PEL_REDUCE_
}

#if PEL_WIDTH == 1
__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void surface_differences(
    __global const PelDiffusionFrame* restrict frame, __global float* pyramid) {
    uint x, y;
    const uint level = blockOfItem(frame, &x, &y);
    if (level == frame->levels) return;
    const uint stride = frame->level[level].stride;
    __global float* at = pyramid + pyramidRow(&frame->level[level], (int)y) + x;
    at[PEL_PLANE_DIFFERENCE2 * stride] =
        at[PEL_PLANE_AREA * stride] > 0.0f ? differences(frame, pyramid, level, x, y) : 0.0f;
}
#endif
