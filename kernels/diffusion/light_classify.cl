// Finds the parts of the screen that light from shadow-map texels changes (docs/mathematics.md, section 10,
// "Light space").
//
// With PEL_HIDDEN: tiles that occluded texels can reach with more than a share of the tolerance get
// PEL_TILE_HIDDEN and all levels, since their weight has to be known. Output: the packed flags, and the
// largest light per tile. Without PEL_HIDDEN: a tile has 4 x 4 parts of 4 x 4 pixels, which are blocks of
// level 2 of the screen's pyramid. A part counts where the sum over the texels differs from the irradiance,
// or where classify_scatter has flagged the tile. Output: a bit per part. One work-item is one tile; with one
// lane, one work-group is one tile, and its work-items share the blocks of each ring. Variants: PEL_HIDDEN,
// PEL_SUM_GROUP (work-items in a group).
#include "lib/diffusion/item.clh"
#include "lib/diffusion/windowed.clh"

#define LEFT_ALONE 0.5f  // of the tolerance

#if PEL_WIDTH == 1
#define LANE get_local_id(0)
#define LANES PEL_SUM_GROUP

// The sum over the work-items of a group, which all call it.
static inline float3 sumOfGroup(float3 v, __local float3* partial) {
    partial[LANE] = v;
    for (uint half_ = LANES / 2; half_ > 0; half_ /= 2) {
        barrier(CLK_LOCAL_MEM_FENCE);
        if (LANE < half_) partial[LANE] += partial[LANE + half_];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    const float3 sum = partial[0];
    barrier(CLK_LOCAL_MEM_FENCE);
    return sum;
}
static inline uint bitsOfGroup(uint bits, __local uint* all) {
    if (LANE == 0) *all = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (bits) atomic_or(all, bits);
    barrier(CLK_LOCAL_MEM_FENCE);
    return *all;
}
#else
#define LANE 0
#define LANES 1
static inline float3 sumOfGroup(float3 v, __local float3* partial) {
    return v;
}
static inline uint bitsOfGroup(uint bits, __local uint* all) {
    return bits;
}
#endif

static inline float3 farLight(__global const PelLightMap* maps, uint mapCount, __global const float* lights,
                              __global const float* nodes, const PelProfileTable table, Receiver* receiver,
                              uint* texels, __local float3* partial) {
    float3 light = (float3)(0.0f);
    for (uint k = 0; k < mapCount; ++k) {
        Windowed sums;
        clearWindowed(&sums);
        *texels += addMap(&sums, maps + k, lights, nodes, table, receiver, LANE, LANES);
        light += sumOfLanes3(sums.farLight) * vload3(0, maps[k].color);
    }
    return sumOfGroup(light, partial);
}

// Fills in the position and the id of a block. Returns the profile table of the block, -1 if it does not
// scatter.
static inline int receiverOf(__global const PelDiffusionFrame* frame, __global const float* block,
                             uint stride, Receiver* receiver) {
    if (!(block[PEL_PLANE_AREA * stride] > 0.0f)) return -1;
    receiver->id = as_uint(block[PEL_PLANE_ID * stride]);
    receiver->p =
        (float3)(block[PEL_PLANE_X * stride], block[PEL_PLANE_Y * stride], block[PEL_PLANE_Z * stride]);
    return receiver->id < PEL_DIFFUSION_IDS ? (int)frame->tableOf[receiver->id] - 1 : -1;
}

// The longer of the two steps to the next pixel.
static inline float maxStep(__global const float* block, uint stride, uint level) {
    const float step = sqrt(fmax(block[PEL_PLANE_SIZE * stride], FLT_MIN));
    return fmax(block[PEL_PLANE_AREA * stride] / ((float)(1u << 2 * level) * step), step);
}

#if PEL_HIDDEN
// A block as a receiver with all of its surface within the margin. Returns its profile table, -1 if it does
// not scatter.
static inline int wholeBlock(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                             uint level, uint x, uint y, Receiver* receiver) {
    __global const PelPyramidLevel* at = &frame->level[level];
    if (x >= at->width || y >= at->height) return -1;
    __global const float* block = pyramid + pyramidRow(at, (int)y) + x;
    const int table = receiverOf(frame, block, at->stride, receiver);
    if (table >= 0) receiver->margin = 0.71f * (float)(1 << level) * maxStep(block, at->stride, level);
    return table;
}

// The most light that occluded texels can add to a tile. The block of a tile stands for one surface. Parts
// of the tile that lie further away, such as an ear in front of a neck, are tested by themselves.
static PEL_OUT_OF_LINE float changeByLight(__global const PelDiffusionFrame* frame,
                                           __global const float* pyramid, uint tileX, uint tileY,
                                           __global const PelProfileTable* tables,
                                           __global const float* nodes, __global const PelLightMap* maps,
                                           uint mapCount, __global const float* lights, uint* texels,
                                           __local float3* partial, __local uint* partsOfGroup) {
    const uint side = PEL_DIFFUSION_TILE >> PEL_PART_LEVEL;
    Receiver receiver;
    receiver.rho = 0.0f;
    receiver.normal = (float3)(0.0f);
    receiver.curvature = 0.0f;
    int table = wholeBlock(frame, pyramid, PEL_TILE_LEVEL, tileX, tileY, &receiver);
    if (table < 0) return 0.0f;
    // Each work-item tests its own parts, so that their loads overlap.
    uint apart = 0;
    for (uint k = LANE; k < side * side; k += LANES) {
        Receiver part;
        const int own = wholeBlock(frame, pyramid, PEL_PART_LEVEL, tileX * side + k % side,
                                   tileY * side + k / side, &part);
        if (own >= 0 && !(own == table && distance(part.p, receiver.p) < receiver.margin)) apart |= 1u << k;
    }
    apart = bitsOfGroup(apart, partsOfGroup);
    const float widest = maxRadius(frame, pyramid, tileX, tileY);
    float change = 0.0f;
    for (;;) {
        receiver.directed = tables[table].directed;
        const float3 light = farLight(maps, mapCount, lights, nodes, atRadius(tables[table], widest),
                                      &receiver, texels, partial);
        change = fmax(change, fmax(light.x, fmax(light.y, light.z)));
        if (!apart) return change;
        const uint k = 31 - clz(apart);
        apart ^= 1u << k;
        table = wholeBlock(frame, pyramid, PEL_PART_LEVEL, tileX * side + k % side, tileY * side + k / side,
                           &receiver);
    }
}
#else
// The curvature of one pixel of a block.
static inline float curvatureOfBlock(__global const PelDiffusionFrame* frame, __global const float* pyramid,
                                     uint x, uint y) {
    __global const PelPyramidLevel* pixels = &frame->level[0];
    const uint middle = 1u << (PEL_PART_LEVEL - 1);
    return pyramid[pyramidRow(pixels, (int)min((y << PEL_PART_LEVEL) + middle, frame->height - 1)) +
                   min((x << PEL_PART_LEVEL) + middle, frame->width - 1) +
                   PEL_PLANE_CURVATURE * pixels->stride];
}

static PEL_OUT_OF_LINE bool lightMatters(__global const PelDiffusionFrame* frame, __global const float* block,
                                         uint stride, __global const PelProfileTable* tables,
                                         __global const float* nodes, __global const PelLightMap* maps,
                                         uint mapCount, __global const float* lights, bool tapped,
                                         float curvature, uint* texels, __local float3* partial) {
    Receiver receiver;
    const int number = receiverOf(frame, block, stride, &receiver);
    if (number < 0) return false;
    if (tapped) return true;
    const PelProfileTable table = tableAt(tables + number, block, stride);
    receiver.rho = 2.0f * maxStep(block, stride, PEL_PART_LEVEL);
    receiver.margin = 0.0f;
    receiver.directed = table.directed;
    receiver.normal = outwardNormal(frame, block, stride);
    const float3 e = (float3)(block[PEL_PLANE_RED * stride], block[PEL_PLANE_GREEN * stride],
                              block[PEL_PLANE_BLUE * stride]);
    const float3 window = shareOfWindow(nodes, table, receiver.rho), gain = directedGainAt(table, curvature),
                 light =
                     fabs(farLight(maps, mapCount, lights, nodes, table, &receiver, texels, partial) / gain -
                          e * (1.0f - window * directedGainWithin(gain, window) / gain));
    return fmax(light.x, fmax(light.y, light.z)) > (frame->everyTile ? 0.0f : LEFT_ALONE * frame->tolerance);
}
#endif

__kernel __attribute__((reqd_work_group_size(PEL_SUM_GROUP, 1, 1))) void light_classify(
    __global const PelDiffusionFrame* restrict frame, __global const float* restrict pyramid,
    __global const PelProfileTable* restrict tables, __global const float* restrict nodes,
    __global uint* tiles, __global const PelLightMap* restrict maps, uint mapCount,
    __global const float* restrict lights, __global uint* parts, __global uint* restrict counters) {
#if PEL_WIDTH == 1
    __local float3 partial[LANES];
    const uint tile = get_group_id(0);
#else
    __local float3* const partial = 0;
    const uint tile = itemOfFolded();
    if (tile >= frame->tilesX * frame->tilesY) return;
#endif
    __local uint partsOfGroup;
    const uint tileX = tile % frame->tilesX, tileY = tile / frame->tilesX;
    uint texels = 0;
#if PEL_HIDDEN
    const uint word = tiles[tile];
    const float change = changeByLight(frame, pyramid, tileX, tileY, tables, nodes, maps, mapCount, lights,
                                       &texels, partial, &partsOfGroup),
                least = frame->everyTile ? 0.0f : LEFT_ALONE * frame->tolerance;
    const bool reached = change > least;
    if (reached && LANE == 0)
        tiles[tile] = (word & PEL_TILE_NEAR) | frame->levels << 8 | PEL_TILE_HIDDEN |
                      max(word >> 24 << 24, packedWeight(weightOfTile(change, least)));
    if (LANE == 0) parts[tile] = as_uint(change);
#else
    const uint side = PEL_DIFFUSION_TILE >> PEL_PART_LEVEL;
    uint reached = 0;
    __global const PelPyramidLevel* level = &frame->level[PEL_PART_LEVEL];
    for (uint j = 0; j < side; ++j)
        for (uint i = 0; i < side; ++i) {
            const uint x = tileX * side + i, y = tileY * side + j;
            if (x >= level->width || y >= level->height) continue;
            if (lightMatters(frame, pyramid + pyramidRow(level, (int)y) + x, level->stride, tables, nodes,
                             maps, mapCount, lights, tiles[tile] != 0, curvatureOfBlock(frame, pyramid, x, y),
                             &texels, partial))
                reached |= 1u << (j * side + i);
        }
    if (LANE == 0) parts[tile] = reached;
#endif
    if (LANE == 0) {  // not by &&: Clang warns where LANE is a constant
        if (reached) atomic_inc(&counters[PEL_COUNT_LIGHT_TILES]);
    }
    PEL_ADD_COUNT(&counters[PEL_COUNT_LIGHT_TEXELS], texels);
}
