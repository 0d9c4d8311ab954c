// The grid from which pixels interpolate thickness (lib/shading/tap_cells.clh), made in two steps: samples of
// a shadow map at the points of a lattice; then, for each node of the grid, the samples nearest to the taps
// of its disk, side by side.
//
// Input: a map of depths, moments or exponentials, one of a light's cascades or its only map. Output:
// samples, lengths along the light, rows one after another; then PEL_NODE_TAPS of them for each node. Texels
// that are NaN become infinitely far: no thickness. One work-item: PEL_WIDTH samples; a run of a row's nodes.
// Nothing is written if there are lists of tiles and all are empty.
#include "lib/shading/tap_cells.clh"

static inline bool anyTile(__global const PelShadeFrame* frame, __global const uint* list) {
    if (!list) return frame->tiles > 0;
    uint tiles = 0;
    for (uint which = 0; which < PEL_TILE_LISTS; ++which) tiles |= list[PEL_TILE_COUNT(which)];
    return tiles > 0;
}

static inline __global const PelTapCells* cellsOf(__global const PelShadeLight* light, uint cascade,
                                                  uint disk) {
    return light->cascades ? &light->cascade[cascade].cells[disk] : &light->cells[disk];
}

// Samples from the node in column i and row j to the one nearest to its tap t. Disks of neighbouring nodes,
// in rows and in columns, are rotated by different numbers of right angles.
static inline int tapOffset(uint t, uint i, uint j, int perRow) {
    const float2 tap = poissonDisk(PEL_NODE_TAPS)[t] * (float)(PEL_CELLS_PER_RADIUS * PEL_SAMPLES_PER_CELL);
    const int x = convert_int_rte(tap.x), y = convert_int_rte(tap.y);
    const int offset = i & 1 ? x * perRow - y : y * perRow + x;
    return j & 1 ? -offset : offset;
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tap_cells(
    __global const PelShadeFrame* restrict frame, __global const PelShadeLight* restrict lights,
    __global const uint* restrict list, uint lightIndex, uint cascade, uint disk, __global float* buffer) {
    __global const PelTapCells* cells = cellsOf(&lights[lightIndex], cascade, disk);
    const uint runs = (cells->columns + PEL_CELLS_RUN - 1) / PEL_CELLS_RUN;
    const uint begin = get_global_id(0) % runs * PEL_CELLS_RUN, j = get_global_id(0) / runs;
    if (j >= cells->rows || !anyTile(frame, list)) return;
    const uint perRow = (PEL_TAP_SAMPLES(cells->columns) + PEL_WIDTH - 1) / PEL_WIDTH * PEL_WIDTH;
#if PEL_WIDTH > 1
    const uint end = min(begin + PEL_CELLS_RUN, cells->columns);
#endif
    __global const float* row =
        buffer + cells->samples +
        ((size_t)j * PEL_SAMPLES_PER_CELL + PEL_CELLS_PER_RADIUS * PEL_SAMPLES_PER_CELL) * perRow +
        PEL_CELLS_PER_RADIUS * PEL_SAMPLES_PER_CELL;
#if PEL_WIDTH == 1
    __global const float* from = row + begin * PEL_SAMPLES_PER_CELL;
    __global float* to = buffer + cells->offset + ((size_t)j * cells->columns + begin) * PEL_NODE_TAPS;
    for (uint t = 0; t < PEL_NODE_TAPS; ++t) to[t] = from[tapOffset(t, begin, j, (int)perRow)];
#else
    int offsets[2][PEL_NODE_TAPS];  // of even and of odd columns
    for (uint t = 0; t < PEL_NODE_TAPS; ++t)
        for (uint odd = 0; odd < 2; ++odd) offsets[odd][t] = tapOffset(t, odd, j, (int)perRow);
    for (uint i = begin; i < end; ++i) {
        __global const float* from = row + i * PEL_SAMPLES_PER_CELL;
        __global float* to = buffer + cells->offset + ((size_t)j * cells->columns + i) * PEL_NODE_TAPS;
        const int* at = offsets[i & 1];
        for (uint t = 0; t < PEL_NODE_TAPS; t += 8) {
#pragma unroll
            for (uint k = 0; k < 8; ++k) to[t + k] = from[at[t + k]];
        }
    }
#endif
}

__kernel __attribute__((reqd_work_group_size(PEL_GROUP, 1, 1))) void tap_samples(
    __global const PelShadeFrame* restrict frame, __global const PelShadeLight* restrict lights,
    __global const uint* restrict list, uint lightIndex, uint cascade, uint disk,
    __global uchar* restrict mapBuffer, __global float* restrict buffer) {
    __global const PelShadeLight* light = &lights[lightIndex];
    __global const PelTapCells* cells = cellsOf(light, cascade, disk);
    __global const PelShadeImage* image = light->cascades ? &light->cascade[cascade].map : &light->map;
    const float depthRange = light->cascades ? light->cascade[cascade].depthRange : light->depthRange;
    const uint columns = PEL_TAP_SAMPLES(cells->columns), vectors = (columns + PEL_WIDTH - 1) / PEL_WIDTH;
    const uint i = get_global_id(0) % vectors * PEL_WIDTH, j = get_global_id(0) / vectors;
    if (j >= PEL_TAP_SAMPLES(cells->rows) || !anyTile(frame, list)) return;
    const float perRadius = PEL_CELLS_PER_RADIUS * PEL_SAMPLES_PER_CELL;
    const float stepX = (float)image->width / (PEL_SAMPLES_PER_CELL * cells->perUv[0]),
                stepY = (float)image->height / (PEL_SAMPLES_PER_CELL * cells->perUv[1]);
    // Samples begin a radius before the nodes, which begin a radius before the map.
    const floatw x =
        fma(convert_floatw(lanesw() + (int)i) - 2.0f * perRadius, (floatw)(stepX), (floatw)(-0.5f));
    const float y = fma((float)j - 2.0f * perRadius, stepY, -0.5f);
    const floatw value =
        shadowMapDepth(PEL_FORMAT_SHADOW_MAP, firstTexel(mapBuffer, image), image, x, (floatw)(y));
    const floatw length = shadowLength(light, depthRange, contentDepth(value, light->perExponent));
    storew(selectw((floatw)(INFINITY), length, length == length), 0,
           buffer + cells->samples + (size_t)j * vectors * PEL_WIDTH + i);
}
